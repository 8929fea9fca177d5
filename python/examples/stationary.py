# %% [markdown]
# # A heat bath, and a Lyapunov exponent that changes its sign
# Averages over the stationary law with intervals that have the error of the step in them.

# %%
import numpy as np

import casimir

well = casimir.scene("langevin")
averages = well.equilibrium(of=["q^2", "p^2/m"], accuracy=0.01)
print(averages)

# %% [markdown]
# The same from the Gibbs measure.

# %%
kt = averages.data["kT"]
q = np.linspace(-4, 4, 40_001)
weight = np.exp(-((q**2 - 1) ** 2) / kt)
print(f"<q^2> {(q**2 * weight).sum() / weight.sum():.4f}, <p^2/m> {kt:.4f}")

# %% [markdown]
# An oscillator whose frequency fluctuates, with friction on its momentum: noise drives it away from
# rest where the largest exponent is positive. It has a closed form (Imkeller and Lederer 1999).

# %%
GAMMA = 0.1
kubo = casimir.Scene(
    {
        "system": {
            "state": ["q", "p"],
            "B": "canonical",
            "H0": "(q^2 + p^2)/2",
            "H": ["s*q^2/2"],
            "parameters": {"s": 0.5},
        },
        "damping": {"rates": {"p": GAMMA}},
        "run": {"initial": [0, 0], "until": 20, "steps": 400},
    }
)


def exact(s: float) -> float:
    x = np.linspace(0, 6, 20_001)
    w = np.exp(-2 / s**2 * ((1 - GAMMA**2 / 4) * x**2 + x**6 / 12))
    return float(0.5 * (x**2 * w).sum() / w.sum() - GAMMA / 2)


sigmas = np.array([0.4, 0.5, 0.6, 0.7, 0.8])
found = [kubo.lyapunov(accuracy=4e-3, parameters={"s": float(s)})["λ1"] for s in sigmas]
for s, exponent in zip(sigmas, found, strict=True):
    print(f"σ = {s:.1f}: {exponent.value:+.4f} ± {exponent.half_width:.4f}, exact {exact(s):+.4f}")

# %%
try:
    import matplotlib.pyplot as plt
except ImportError:
    raise SystemExit from None
fine = np.linspace(0.3, 0.9, 61)
figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
ax.plot(fine, [exact(s) for s in fine], label="Imkeller and Lederer")
values, errors = zip(*((one.value, one.half_width) for one in found), strict=True)
ax.errorbar(sigmas, values, errors, fmt="o", capsize=3, label="chains, 95 %")
ax.axhline(0, color="gray", linewidth=0.8)
ax.set(xlabel="σ", ylabel="largest Lyapunov exponent")
ax.legend(frameon=False)
figure.savefig("lyapunov.svg")
