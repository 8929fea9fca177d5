"""Langevin dynamics in a double well, beside numba, NumPy and Diffrax, on all processors.

pip install numba numpy diffrax, build `cargo build --release -p casimir-cli`, and then
`python langevin.py target/release/casimir` prints path-steps per second of 10⁴ chains, and the
seconds to ⟨q²⟩ ± 10⁻³: for BAOAB (Leimkuhler and Matthews 2013) as OpenMM takes it, with the standard
error of its chains as interval, which does not contain its bias; for the program all of it.
"""

import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

CHAINS, KT, GAMMA, TAU = 10_000, 1.0, 1.0, 0.05
SCENE = """
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + (q^2 - 1)^2"
[bath]
friction = { p = 1 }
temperature = 1
[run]
initial = [1, 0]
until = 20
steps = 400
scheme = "SCHEME"
[expect]
of = ["q^2"]
accuracy = 1e-3
"""


def exact() -> float:
    q = np.linspace(-5, 5, 200_001)
    w = np.exp(-((q * q - 1) ** 2))
    return float((q * q * w).sum() / w.sum())


def numba_baoab():
    import numba

    @numba.njit(parallel=True)
    def advance(q, p, steps, seed):
        c = math.exp(-GAMMA * TAU)
        s = math.sqrt(KT * (1 - c * c))
        sums = np.zeros(len(q))
        for k in numba.prange(len(q)):
            np.random.seed(seed * 1_000_003 + k)
            x, v, total = q[k], p[k], 0.0
            for _ in range(steps):
                v -= 0.5 * TAU * 4 * x * (x * x - 1)
                x += 0.5 * TAU * v
                v = c * v + s * np.random.standard_normal()
                x += 0.5 * TAU * v
                v -= 0.5 * TAU * 4 * x * (x * x - 1)
                total += x * x
            q[k], p[k], sums[k] = x, v, total / steps
        return sums

    return advance


def numpy_baoab():
    c = math.exp(-GAMMA * TAU)
    s = math.sqrt(KT * (1 - c * c))

    def advance(q, p, steps, seed):
        random, total = np.random.default_rng(seed), np.zeros(len(q))
        for _ in range(steps):
            p -= 0.5 * TAU * 4 * q * (q * q - 1)
            q += 0.5 * TAU * p
            p *= c
            p += s * random.standard_normal(len(q))
            q += 0.5 * TAU * p
            p -= 0.5 * TAU * 4 * q * (q * q - 1)
            total += q * q
        return total / steps

    return advance


def diffrax_heun():
    import diffrax
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)

    def one(y, key, steps):
        drift = diffrax.ODETerm(
            lambda t, y, _: jnp.stack([y[1], -4 * y[0] * (y[0] * y[0] - 1) - GAMMA * y[1]])
        )
        path = diffrax.VirtualBrownianTree(0.0, steps * TAU, TAU / 2, (), key)
        noise = diffrax.ControlTerm(
            lambda t, y, _: jnp.array([0.0, math.sqrt(2 * GAMMA * KT)]), path
        )
        end = diffrax.diffeqsolve(
            diffrax.MultiTerm(drift, noise), diffrax.Heun(), 0.0, steps * TAU, TAU, y,
            saveat=diffrax.SaveAt(ts=jnp.arange(1, steps + 1) * TAU), max_steps=steps + 8,
        )
        return end.ys[-1], jnp.mean(end.ys[:, 0] ** 2)

    many = jax.jit(jax.vmap(one, in_axes=(0, 0, None)), static_argnums=2)

    def advance(q, p, steps, seed):
        keys = jax.random.split(jax.random.key(seed), len(q))
        ends, sums = many(jnp.stack([q, p], axis=1), keys, steps)
        ends = np.asarray(ends)
        q[:], p[:] = ends[:, 0], ends[:, 1]
        return np.asarray(sums)

    return advance


def peer(name: str, advance, steps: int) -> None:
    q, p = np.ones(CHAINS), np.zeros(CHAINS)
    advance(q, p, steps, 1)  # compiles
    begin = time.perf_counter()
    advance(q, p, steps, 2)
    rate = CHAINS * steps / (time.perf_counter() - begin)
    # As many more steps until the standard error over the chains is small enough, after burn-in.
    begin, sums, done = time.perf_counter(), np.zeros(CHAINS), 0
    advance(q, p, int(10 / TAU) // steps * steps or steps, 3)
    while True:
        sums, done = sums + advance(q, p, steps, 4 + done), done + 1
        means = sums / done
        half = 1.96 * means.std() / math.sqrt(CHAINS)
        if half <= 1e-3:
            break
    seconds, mean = time.perf_counter() - begin, means.mean()
    print(f"{name:22} {rate:9.2e} path-steps/s  {seconds:6.2f} s  {mean:.5f} ± {half:.1e}", flush=True)


def ours(program: str, scheme: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "well.toml").write_text(SCENE.replace("SCHEME", scheme))
        times = []
        for accuracy in ("1e-3", "1e-1"):
            arguments = ["equilibrium", "well.toml", "--json", "--chains", str(CHAINS)]
            begin = time.perf_counter()
            text = subprocess.run(
                [program, *arguments, "--accuracy", accuracy], cwd=folder, capture_output=True
            ).stdout
            times.append(time.perf_counter() - begin)
            if accuracy == "1e-3":
                found = json.loads(text)
    [one] = found["estimates"]
    rate = found["path-steps" if "path-steps" in found else "spent"] / times[0]
    print(
        f"casimir {scheme:14} {rate:9.2e} path-steps/s  {times[0]:6.2f} s  {one['value']:.5f} ± "
        f"{one['half_width']:.1e} (step {one['bias']:.1e})",
        flush=True,
    )


if __name__ == "__main__":
    print(f"exact {exact():.5f}")
    for _ in range(2):
        peer("numba BAOAB", numba_baoab(), 100)
        peer("NumPy BAOAB", numpy_baoab(), 100)
        for scheme in ("sexp", "sexp-li", "heun"):
            ours(sys.argv[1], scheme)
    peer("Diffrax Heun", diffrax_heun(), 100)
