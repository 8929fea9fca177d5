# %% [markdown]
# # A charged particle
# The magnetic field is part of B, the electric field fluctuates. B and the Hamiltonians are written
# with SymPy and printed to the grammar of scenes.

# %%
import sympy as sp

import casimir

x, y, u, v, b, k, sigma = sp.symbols("x y u v b k sigma")
field = b + x  # grows along x
B = sp.Matrix([[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, field], [0, -1, -field, 0]])
energy = (u**2 + v**2) / 2 + k * (x**2 + y**2) / 2
particle = casimir.System(
    state=[x, y, u, v],
    B=B,
    H0=energy,
    H=[-sigma * x, -sigma * y],
    parameters={b: 4.0, k: 1.0, sigma: 0.4},
    damping=0.1,
    title="Charged particle",
)
scene = particle.scene(initial=[1, 0, 0, 0.5], until=20, steps=4000, observe={"energy": energy})

# %%
run = scene.run(paths=3)
run.plot("portrait-x-y")

# %% [markdown]
# dE/dt = σ² − 2γE in the mean, so the energy goes to σ²/2γ = 0.8.

# %%
many = scene.run(paths=2000)
law = many.statistics["energy"]
print(f"energy {law.mean[-1]:.3f} in [{law.lo[-1]:.3f}, {law.hi[-1]:.3f}]")
many.plot("energy")
