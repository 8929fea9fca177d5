# %% [markdown]
# # Predator and prey
# In the logarithms x, y of the populations the Lotka–Volterra equations are canonical. A sweep over
# the noise shares its random numbers, so that its runs can be compared.

# %%
import casimir

populations = casimir.System(
    state="x y",
    B="canonical",
    H0="exp(x) - x + exp(y) - y",
    H=["sigma*x", "sigma*y"],
    parameters={"sigma": 0.1},
    title="Predator and prey",
)
scene = populations.scene(
    initial=[0.5, 0],
    until=20,
    steps=2000,
    paths=1000,
    observe={"prey": "exp(x)", "predators": "exp(y)"},
    probabilities={"rare": "exp(x) < 0.2"},
)

# %%
sweep = casimir.sweep(scene, sigma=[0.02, 0.05, 0.1]).run()
sweep.plot("against-rare")

# %%
law = sweep.statistics["prey"]
for sigma, mean, lo, hi in zip(sweep.parameters["sigma"], law.mean[:, -1], law.lo[:, -1], law.hi[:, -1]):
    print(f"sigma = {sigma}: mean prey {mean:.3f} in [{lo:.3f}, {hi:.3f}]")
