# %% [markdown]
# # Predator and prey
# Lotka–Volterra equations du = u(a − bv)dt, dv = v(cu − d)dt with a harvest of both and noise in
# the growth rate of the prey: H₁ = σ ln v, since B swaps the species. The noise is Stratonovich's:
# an Itô rate a is a - sigma^2/2 here. A sweep shares its random numbers, so that its runs can be
# compared.

# %%
import casimir

populations = casimir.System(
    state="u v",
    B=[["u*v"]],
    H0="a*ln(v) - b*v + d*ln(u) - c*u",
    H=["sigma*ln(v)"],
    parameters={"a": 1.0, "b": 1.0, "c": 1.0, "d": 1.0, "sigma": 0.2},
    damping=0.1,  # the harvest
    title="Predator and prey",
)
scene = populations.scene(
    initial=[1.5, 0.8],
    until=20,
    steps=2000,
    paths=1000,
    events={"low": "u < 0.3"},  # before t; `probabilities` are those at t
)
print(scene.inspect().text.splitlines()[1])  # du = …: is the noise where it should be?

# %%
run = scene.run()
run.plot("u")  # median, mean and bands
law = run.statistics["low"]
print(f"u < 0.3 before t = 20: {law.mean[-1]:.3f} in [{law.lo[-1]:.3f}, {law.hi[-1]:.3f}]")

# %%
sweep = casimir.sweep(scene, sigma=[0.05, 0.1, 0.2, 0.3]).run()
sweep.plot("against-u")
law = sweep.statistics["u"]
for sigma, mean, lo, hi in zip(sweep.parameters["sigma"], law.mean[:, -1], law.lo[:, -1], law.hi[:, -1]):
    print(f"sigma = {sigma}: mean prey {mean:.3f} in [{lo:.3f}, {hi:.3f}]")
