# %% [markdown]
# # An expectation, beside Diffrax
# E[cos y3] of the rigid body to ±1e-4 with an interval; then the same mean with Diffrax, where the
# number of paths and the step are ours to choose, and no interval has the bias of the step in it.

# %%
import time

import casimir

body = casimir.scene("rigid-body").with_(until=1.0, steps=256, initial=["cos(1.1)", 0, "sin(1.1)"])
start = time.perf_counter()
found = body.expect(of=["cos(y3)"], accuracy=1e-4)
print(f"casimir: {found['cos(y3)'].value:.6f} ± {found['cos(y3)'].half_width:.1e},", end=" ")
print(f"{time.perf_counter() - start:.2f} s; exact 0.797720")


# %%
def with_diffrax(paths: int, steps: int) -> None:
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    inertia, noise = jnp.array([2, 1, 2 / 3]), jnp.array([1.0, 2.0, 3.0])

    def drift(t, y, args):
        return jnp.cross(y, y / inertia) - 0.5 * jnp.cos(2 * t) * y

    def diffusion(t, y, args):
        # B∇H_m with H_m = y_m²/2Î_m: the column y × e_m y_m/Î_m.
        return jnp.stack([jnp.cross(y, jnp.eye(3)[m] * y[m] / noise[m]) for m in range(3)], axis=1)

    def end(key):
        path = diffrax.VirtualBrownianTree(0.0, 1.0, 1 / (4 * steps), (3,), key)
        terms = diffrax.MultiTerm(diffrax.ODETerm(drift), diffrax.ControlTerm(diffusion, path))
        y0 = jnp.array([jnp.cos(1.1), 0, jnp.sin(1.1)])
        return diffrax.diffeqsolve(terms, diffrax.Heun(), 0, 1, 1 / steps, y0).ys[0, 2]

    ends = jax.jit(jax.vmap(end))
    keys = jax.random.split(jax.random.key(1), paths)
    ends(keys[:2]).block_until_ready()
    start = time.perf_counter()
    values = jnp.cos(ends(keys))
    half_width = 1.96 * float(values.std()) / paths**0.5
    seconds = time.perf_counter() - start
    print(f"Diffrax, {paths} paths: {float(values.mean()):.6f} ± {half_width:.1e}, {seconds:.2f} s")


try:
    with_diffrax(paths=100_000, steps=64)
except ImportError:
    print("Diffrax is not installed: pip install diffrax")
