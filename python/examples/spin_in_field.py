# %% [markdown]
# # A spin in a field
# A classical spin s turns about a field along z and about a fluctuating one along x. Its length is a
# Casimir of B: it stays exactly on its law, here constant, whatever the step.

# %%
import numpy as np

import casimir

spin = casimir.System(
    state=["s[xyz]"],
    B="spins",
    H0="-h*sz",
    H=["sigma*sx"],
    parameters={"h": 2.0, "sigma": 0.5},
    title="Spin in a field",
)
scene = spin.scene(initial=[0.6, 0, 0.8], until=10, steps=1000, observe={"length": "norm(s)"})
scene.inspect()

# %%
run = scene.run(paths=4)
print("the length deviates by", np.abs(run["length"] - 1).max())
run.plot("sz")

# %% [markdown]
# Many paths give laws instead: noise about x takes the mean of z to zero.

# %%
many = scene.run(paths=20_000)
many
