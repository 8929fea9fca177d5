# %% [markdown]
# # Spins on a lattice
# A built-in system: 16 × 16 spins at a temperature. Arrays are [path, time, spin, axis].

# %%
import casimir

lattice = casimir.Scene(
    {
        "title": "Ferromagnet",
        "system": {
            "name": "spin-lattice",
            "parameters": {"sizes": [16, 16], "periodic": True, "kT": 0.3},
        },
        "bath": {"temperature": "kT", "transverse": {"s": 0.5}},
        "run": {"initial": [0, 0, 1], "until": 10, "steps": 400, "times": 40, "paths": 2},
        "observe": {"m": "mz"},
    }
).with_(columns=["components", "m", "energy"])
run = lattice.run()
print("spins", run["spins"].shape, "lengths", (run["spins"] ** 2).sum(axis=3).min())
run.plot("lattice")

# %% [markdown]
# A sweep over the temperature:

# %%
sweep = casimir.sweep(lattice, kT=[0.2, 0.5, 1.0]).run(paths=100, times=20)
sweep.plot("against-m")
