"""Work and precision for strong errors: Diffrax beside this program, one run, one core.

An error is the root mean square of |y_n - y| at T = 1, y_n with n steps on the noise of y. Printed
are orders by the last points, and the processor time of a path with its noise for wanted errors.

- Diffrax: errors on 1000 paths against 8192 steps of the last solver of a problem, on one Brownian
  path with areas that are put together exactly. Times with `UnsafeBrownianPath` and the areas that
  a solver reads: fixed steps, compiled, warm, no output but the end, the least of four runs and of
  batches of 10^3 to 10^5. A batch is a state of arrays with one draw a step, half the time of
  `vmap` over paths. Not listed, as nowhere cheaper by more than 5 %: EulerHeun, GeneralShARK,
  Midpoint, SEA, SRA1, StratonovichMilstein.
- This program: errors on 256 paths and times of `casimir compare`, and below its reference those
  of `split-h` as `casimir order` lets them fall. It compares drift and noise, whose texts Diffrax
  is given, with B and H.

    python3 -m venv venv && venv/bin/pip install diffrax==0.7.2
    venv/bin/python crates/verify/peers/strong.py target/release/casimir
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
CASIMIR = os.path.abspath(sys.argv[1])
FINEST, PATHS, SIZES = 8192, 1000, [2**k for k in range(2, 12)]
BATCHES, TIMED = {1000: 256, 10_000: 256, 100_000: 16}, SIZES[:7]
TARGETS, FLOOR = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6], 1e-8
ANY, LANGEVIN = ["Heun", "SPaRK", "SlowRK"], ["ALIGN", "ShOULD", "QUICSORT"]
PROBLEMS = {  # state, B, H0, H1, damping, initial, drift, noise, solvers
    "pendulum": ("q p", "canonical", "p^2/2 - cos(q)", "0.5*q", "rate = 0.3", [0.5, 0.3],
                 ["p - 0.3*q", "-sin(q) - 0.3*p"], ["0", "-0.5"], ["ShARK", *ANY]),
    "double well": ("q p", "canonical", "p^2/2 + (q^2 - 1)^2", "1.2*q", "rates.p = 1", [0.5, 0.3],
                    ["p", "-4*q*(q^2 - 1) - p"], ["0", "-1.2"], ["ShARK", *ANY, *LANGEVIN]),
    "spin": ("x y z", "spins", "0.8*z^2 - 0.5*x", "0.7*z", "rate = 0", [0.6, 0, 0.8],
             ["1.6*y*z", "-0.5*z - 1.6*x*z", "0.5*y"], ["0.7*y", "-0.7*x", "0"], ANY),
    "rigid body": ("x y z", "rigid", "(x^2/2 + y^2 + 1.5*z^2)/2", "0.4*y^2", "rate = 0.2",
                   [0.6, 0, 0.8], ["0.5*y*z - 0.2*x", "-x*z - 0.2*y", "0.5*x*y - 0.2*z"],
                   ["-0.8*y*z", "0", "0.8*x*y"], ANY),
}


class Given(dx.AbstractBrownianPath):  # W, H and K of the steps of a grid.
    areas: tuple
    levy_area: type = dx.SpaceTimeTimeLevyArea
    t0, t1 = 0.0, 1.0

    def evaluate(self, t0, t1=None, left=True, use_levy=False):
        w, h, k = (area[jnp.round(t0 * len(area)).astype(int)] for area in self.areas)
        return dx.SpaceTimeTimeLevyArea(dt=t1 - t0, W=w, H=h, K=k) if use_levy else w


class Product(dx.ControlTerm):  # One noise for each path of a batch.
    def prod(self, vf, control):
        return vf * control


def coarser(w, h, k, tau):
    """Two steps tau as one, by I and J, the integrals of W - W(s) and (t - s)(W - W(s))."""
    i, j = tau * (w / 2 + h), tau**2 * (w / 3 + h / 2 - k)
    j = j[::2] + j[1::2] + 1.5 * tau**2 * w[::2] + tau * i[1::2]
    i = i[::2] + i[1::2] + tau * w[::2]
    w, tau = w[::2] + w[1::2], 2 * tau
    return w, i / tau - w / 2, i / (2 * tau) - j / tau**2 + w / 12


def field(names, texts):
    """The texts as a vector field of batches."""
    codes = [compile(text.replace("^", "**"), text, "eval") for text in texts]
    values = lambda y: (eval(c, {"sin": jnp.sin, **dict(zip(names.split(), y))}) for c in codes)
    return lambda t, y, args: jnp.stack(jnp.broadcast_arrays(*y, *values(y))[len(y) :])


def final(problem, name, path, paths, dt):
    """The final states of paths, [component, path]."""
    names, *_, initial, drift, noise, _ = problem
    if name in LANGEVIN:  # The well is even: of -y, whose noise has the sign of Diffrax.
        y, u = tuple(jnp.full(paths, -c) for c in initial), 1.2**2 / 2
        forces = dx.UnderdampedLangevinDriftTerm(1.0, u, lambda x, args: 4 * x * (x**2 - 1) / u)
        terms = forces, dx.UnderdampedLangevinDiffusionTerm(1.0, u, path)
    else:
        y = jnp.broadcast_to(jnp.array(initial, float)[:, None], (len(initial), paths))
        terms = dx.ODETerm(field(names, drift)), Product(field(names, noise), path)
    found = dx.diffeqsolve(
        dx.MultiTerm(*terms), getattr(dx, name)(), 0.0, 1.0, dt, y, saveat=dx.SaveAt(t1=True),
        max_steps=FINEST, adjoint=dx.ForwardMode(), throw=False,
    ).ys
    return -jnp.concatenate(found) if name in LANGEVIN else found[0]


def of_diffrax(problem, name, grids, reference):
    """Steps, errors and seconds of a path."""
    solve = jax.jit(lambda areas: final(problem, name, Given(areas), PATHS, 1 / len(areas[0])))
    errors = [np.sqrt(np.mean(np.sum((solve(grids[n]) - reference) ** 2, 0))) for n in SIZES]
    least = dict.fromkeys(TIMED, np.inf)
    reads = getattr(getattr(dx, name)(), "minimal_levy_area", dx.AbstractBrownianIncrement)
    kinds = dx.BrownianIncrement, dx.SpaceTimeLevyArea, dx.SpaceTimeTimeLevyArea
    kind = next(kind for kind in kinds if issubclass(kind, reads))
    for paths, most in BATCHES.items():
        path = lambda key: dx.UnsafeBrownianPath((paths,), key, kind)
        solve = jax.jit(lambda key, dt: final(problem, name, path(key), paths, dt))
        for n, run in ((n, run) for n in TIMED if n <= most for run in range(4)):
            start = time.process_time()
            solve(jax.random.key(run), 1 / n).block_until_ready()
            least[n] = min(least[n], (time.process_time() - start) / paths)
    return SIZES, errors, [least.get(n, least[TIMED[-1]] * n / TIMED[-1]) for n in SIZES]


def of_casimir(problem, folder):
    """The same by scheme."""
    state, b, h0, h1, damping, initial, drift, noise, _ = problem
    with open(f"{folder}/scene.toml", "w") as file:
        file.write(f'[system]\nstate = {state.split()}\nB = "{b}"\nH0 = "{h0}"\nH = ["{h1}"]\n')
        file.write(f"drift = {drift}\nnoise = [{noise}]\n[damping]\n{damping}\n")
        file.write(f"[run]\ninitial = {initial}\nuntil = 1\nsteps = 64\n")

    def call(*words):
        words = [CASIMIR, *words, "scene.toml", "--threads", "1", "--json"]
        return json.loads(subprocess.run(words, cwd=folder, capture_output=True, check=True).stdout)

    found, falls = {}, {}
    for most in ("3e6", "1e7"):
        order = call("order", "--scheme", "split-h", "--path-steps", most)["strong"]
        falls |= {round(1 / p["tau"]): p["value"] for p in order["points"]}
    for c in call("compare", "--error", "1e-4")["candidates"]:
        points = [(p["steps"], p["error"], p["time"]["best"]) for p in c["points"] if p["resolved"]]
        if c["scheme"] == "split-h":
            last, error, seconds = points[-1]
            finer = ((n, falls[n] / falls[last]) for n in sorted(falls) if n > last)
            points += [(n, error * fall, seconds * n / last) for n, fall in finer]
        found[c["scheme"]] = zip(*points)
    return {scheme: found[scheme] for scheme in ("split-h", "sexp", "nv", "heun")}


def line(name, steps, errors, seconds):
    """Prints a row, and returns the seconds for each target."""
    rows = [row for row in zip(steps, errors, seconds) if row[1] > FLOOR]
    (n, x, y), at = np.log(rows).T * [[1], [-1], [1]], -np.log(TARGETS)
    slope, order = np.polyfit(x[-4:], y[-4:], 1)[0], np.polyfit(n[-4:], x[-4:], 1)[0]
    costs = np.exp(np.interp(at, x, y) + np.maximum(at - x[-1], 0) * slope)
    marks = ["≈" if a > x[-1] else "≤" if a < x[0] else "" for a in at]
    words = (f"{mark}{1e6 * cost:.3g}" for mark, cost in zip(marks, costs))
    print(f"{name:18} {order:5.2f}", *(f"{word:>9}" for word in words), flush=True)
    return costs


print("µs of a path; ≈: extrapolated, ≤: with the longest step, T/4")
for title, problem in PROBLEMS.items():
    print(f"\n{title:18} order", *(f"{target:9.0e}" for target in TARGETS))
    normals, tau = jax.random.normal(jax.random.key(1), (3, FINEST, PATHS)), 1 / FINEST
    grids = {FINEST: [np.sqrt(tau / part) * z for part, z in zip((1, 12, 720), normals)]}
    for n in (FINEST >> k for k in range(1, 12)):
        grids[n] = coarser(*grids[2 * n], 0.5 / n)
    solve = jax.jit(lambda areas: final(problem, problem[-1][-1], Given(areas), PATHS, tau))
    reference = solve(grids[FINEST])
    peers = [line(f"Diffrax {p}", *of_diffrax(problem, p, grids, reference)) for p in problem[-1]]
    with tempfile.TemporaryDirectory() as folder:
        ours = [line(name, *points) for name, points in of_casimir(problem, folder).items()]
    print(f"{'least, Diffrax/ours':24}", *(f"{r:9.3g}" for r in np.min(peers, 0) / np.min(ours, 0)))
