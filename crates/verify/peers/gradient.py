"""Derivatives of an expectation: Diffrax beside this program, one run, one core.

The rigid body of the known answers (E[cos z] at T = 1, seven parameters). Diffrax: `jax.grad` of
the mean over a batch of paths, fixed steps, compiled, warm. Printed are the bias at n steps, as far
as it is seen, and the processor time for a half-width of sampling, without a bound of the bias.
This program: its half-widths have the bias in them.

    python3 -m venv venv && venv/bin/pip install diffrax==0.7.2
    venv/bin/python crates/verify/peers/gradient.py target/release/casimir
"""

import json
import os
import subprocess
import sys
import tempfile
import time

os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

import diffrax as dx
import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)
CASIMIR, ACCURACY, BATCH = os.path.abspath(sys.argv[1]), 2e-4, 4096
NAMES = ["I1", "I2", "I3", "J1", "J2", "J3", "g"]
START = jnp.array([2, 1, 2 / 3, 1, 2, 3, 0.5])
EXACT = np.array([7.47686e-3, -2.57822e-2, -9.2817e-3, -4.32075e-2, -1.27545e-3, 6.8085e-4, 0.156913])
SCENE = """[system]
state = ["x", "y", "z"]
B = "rigid"
H0 = "x^2/(2*I1) + y^2/(2*I2) + z^2/(2*I3)"
H = ["x^2/(2*J1)", "y^2/(2*J2)", "z^2/(2*J3)"]
parameters = { I1 = 2, I2 = 1, I3 = "2/3", J1 = 1, J2 = 2, J3 = 3, g = 0.5 }
[damping]
rate = "g*cos(2*t)"
[run]
initial = ["cos(1.1)", 0, "sin(1.1)"]
until = 1
steps = 64
[expect]
of = ["cos(z)"]
accuracy = %g
%s
"""


def turn(y, v):  # B(y)v as the program has it.
    return jnp.cross(y, v)


def value(theta, key, solver, steps):
    def drift(t, y, _):
        return turn(y, y / theta[:3]) - theta[6] * jnp.cos(2 * t) * y

    def noise(t, y, _):
        return jnp.stack([turn(y, y * e / theta[3:6]) for e in jnp.eye(3)], axis=1)

    path = dx.VirtualBrownianTree(0, 1, 0.5 / steps, (3,), key, dx.SpaceTimeLevyArea)
    terms = dx.MultiTerm(dx.ODETerm(drift), dx.ControlTerm(noise, path))
    y0 = jnp.array([jnp.cos(1.1), 0, jnp.sin(1.1)])
    found = dx.diffeqsolve(terms, solver, 0, 1, 1 / steps, y0, max_steps=steps,
                           adjoint=dx.RecursiveCheckpointAdjoint())
    return jnp.cos(found.ys[0, 2])


def diffrax(solver, steps):
    each = jax.jit(jax.vmap(jax.grad(lambda *of: value(*of, solver, steps)), in_axes=(None, 0)))
    run = lambda seed: each(START, jax.random.split(jax.random.key(seed), BATCH)).block_until_ready()
    run(0)
    best, samples = np.inf, []
    for seed in range(1, 9):
        begun = time.process_time()
        samples.append(run(seed))
        best = min(best, time.process_time() - begun)
    samples = np.concatenate(samples)
    error = 1.96 * samples.std(axis=0) / len(samples) ** 0.5
    off = samples.mean(axis=0) - EXACT
    paths = (1.96 * samples.std(axis=0).max() / ACCURACY) ** 2
    print(f"{type(solver).__name__:8} n = {steps:3}: {paths * best / BATCH:8.1f} s for {paths:.1e} paths;"
          f" largest bias {np.abs(off).max():.1e} ± {error[np.abs(off).argmax()]:.1e}")


def casimir(gradient):
    words = f"gradient = {json.dumps(NAMES)}" if gradient else ""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "body.toml")
        with open(file, "w") as scene:
            scene.write(SCENE % (ACCURACY, words))
        command = [CASIMIR, "expect", file, "--json", "--threads", "1"]
        begun = os.times()
        found = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        ended = os.times()
    spent = ended.children_user + ended.children_system - begun.children_user - begun.children_system
    all = [found["gradient"][name][0] for name in NAMES] if gradient else found["estimates"]
    worst = max(one["half_width"] for one in all)
    off = [abs(one["value"] - exact) / one["half_width"] for one, exact in zip(all, EXACT)]
    print(f"casimir {'7 derivatives' if gradient else 'the value':13}: {spent:6.2f} s, "
          f"half-widths to {worst:.1e}" + (f", off by {max(off):.2f} of them" if gradient else ""))
    return spent


times = [casimir(False), casimir(True)]
print(f"derivatives over the value: {times[1] / times[0]:.1f}")
for solver in [dx.Heun(), dx.SPaRK()]:
    for steps in [8, 16, 32]:
        diffrax(solver, steps)
