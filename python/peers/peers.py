"""Solvers of other packages before the referee: the tables of docs/peers.md.

    python -m venv peers && peers/bin/pip install ./python diffrax torchsde sdeint
    peers/bin/python python/peers/peers.py [part of a solver's name] > peers.md

Each solver gets the increments of the referee, with areas where it can take them, as its package
documents it: Diffrax by an `AbstractBrownianPath`, torchsde by a `BaseBrownian`, sdeint by its
arguments. All are asked step by step, on 1024 paths at once (sdeint: 64, one by one).
"""

import sys
import time
import warnings

import casimir
import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import sdeint
import torch
import torchsde
from systems import PROBLEMS

jax.config.update("jax_enable_x64", True)
torch.set_default_dtype(torch.float64)
torch.set_num_threads(1)
warnings.filterwarnings("ignore")


def correction(m, fields, y):
    """½Σ b′b by differences."""
    e, total = 1e-5, [0.0] * len(y)
    for k, b in enumerate(fields(m, y)[1]):
        up, down = (fields(m, [x + s * e * v for x, v in zip(y, b)])[1][k] for s in (1, -1))
        total = [t + (u - d) / (4 * e) for t, u, d in zip(total, up, down)]
    return total


def drift_and_noise(problem, m, ito):
    """f − γy, in the sense of Itô or Stratonovich, and [b₁, …], as lists of components of a list."""

    def drift(y):
        f = problem.fields(m, y)[0]
        c = correction(m, problem.fields, y) if ito else [0.0] * len(y)
        return [a + b - problem.gamma * x for a, b, x in zip(f, c, y)]

    return drift, lambda y: problem.fields(m, y)[1]


class Given(diffrax.AbstractBrownianPath):
    """The noise of one step."""

    dt: jax.Array
    dW: jax.Array
    H: jax.Array
    levy_area: type = diffrax.SpaceTimeLevyArea

    @property
    def t0(self):
        return None

    @property
    def t1(self):
        return None

    def evaluate(self, t0, t1=None, left=True, use_levy=False):
        if use_levy:
            return diffrax.SpaceTimeLevyArea(dt=self.dt, W=self.dW, H=self.H)
        return self.dW


def of_diffrax(name, ito):
    def make(problem):
        drift, noise = drift_and_noise(problem, jnp, ito)

        def field(t, y, args):
            return jnp.stack(drift(list(y)))

        at = [np.zeros(1)] * len(problem.initial)
        constant = np.stack([np.stack(b)[:, 0] for b in noise(at)], axis=1) if problem.additive else None

        def diffusion(t, y, args):
            if constant is not None:
                return jnp.asarray(constant)
            return jnp.stack([jnp.stack(b) for b in noise(list(y))], axis=1)

        def one(y, dt, dW, H):
            path = Given(dt, dW, H)
            terms = diffrax.MultiTerm(diffrax.ODETerm(field), diffrax.ControlTerm(diffusion, path))
            found = diffrax.diffeqsolve(
                terms, getattr(diffrax, name)(), 0.0, dt, dt, y, max_steps=1, throw=False,
                adjoint=diffrax.ForwardMode(),
            )
            return found.ys[0]

        step = jax.jit(jax.vmap(one, in_axes=(0, None, 0, 0)))

        def solver(y, dt, dW, areas, H):
            y = jnp.asarray(y)
            for dw, h in zip(dW, H):
                y = step(y, dt, dw, h)
            return jax.block_until_ready(y)

        for count in (192, 1024):  # Compiled before times are taken.
            zero = np.zeros((1, count, problem.noises))
            solver(np.ones((count, len(problem.initial))), 0.1, zero, None, zero)
        return solver

    return make


class Steps(torchsde.BaseBrownian):
    """The increments of steps, in the order of their times."""

    __slots__ = ("dt", "dW", "A")

    def __init__(self, dt, dW, areas):
        self.dt, self.dW, self.A = dt, torch.from_numpy(dW), torch.from_numpy(areas)

    def __call__(self, ta, tb=None, return_U=False, return_A=False):
        n = min(round(float(ta) / self.dt), len(self.dW) - 1)
        return (self.dW[n], self.A[n]) if return_A else self.dW[n]

    def __repr__(self):
        return "Steps"

    dtype = property(lambda self: torch.float64)
    device = property(lambda self: torch.device("cpu"))
    shape = property(lambda self: self.dW.shape[1:])
    levy_area_approximation = property(lambda self: "foster")


def of_torchsde(method, ito, **options):
    def make(problem):
        drift, noise = drift_and_noise(problem, torch, ito)

        class Equation(torch.nn.Module):
            sde_type = "ito" if ito else "stratonovich"
            noise_type = "additive" if problem.additive else "scalar" if problem.noises == 1 else "general"

            def f(self, t, y):
                return torch.stack(drift(list(y.T)), dim=1)

            def g(self, t, y):
                fields = [torch.stack([x + 0 * y[:, 0] for x in b], dim=1) for b in noise(list(y.T))]
                return torch.stack(fields, dim=2)

        def solver(y, dt, dW, areas, H):
            times = torch.tensor([0.0, dt * len(dW)])
            bm = Steps(dt, dW, areas)
            with torch.no_grad() if method != "milstein" else torch.enable_grad():
                ys = torchsde.sdeint(Equation(), torch.from_numpy(y), times, bm=bm, method=method, dt=dt, options=dict(options))
            return ys[-1]

        return solver

    return make


def of_sdeint(name, ito, integrals):
    def make(problem):
        drift, noise = drift_and_noise(problem, np, ito)

        def f(y, t):
            return np.array(drift(list(y)))

        def G(y, t):
            return np.array(noise(list(y))).T

        def solver(y, dt, dW, areas, H):
            times = np.linspace(0, dt * len(dW), len(dW) + 1)
            ends = []
            for p in range(len(y)):
                dw = dW[:, p]
                more = {}
                if integrals:
                    both = 0.5 * dw[:, :, None] * dw[:, None, :] + areas[:, p]
                    if ito:
                        both = both - 0.5 * dt * np.eye(dw.shape[1])
                    more = {integrals: both}
                ends.append(getattr(sdeint, name)(f, G, y[p], times, dW=dw, **more)[-1])
            return np.array(ends)

        return solver

    return make


def sib(problem):
    """Semi-implicit B of Mentink et al. (2010), for y × ω(y) with γ in two halves."""
    if problem.law != "C1" or len(problem.initial) != 3 or problem.noises != 3:
        return None

    def omega(y, dt, dW):
        return np.stack([0.5 * y[:, 0], y[:, 1], 1.5 * y[:, 2]], 1) * dt + y / [1, 2, 3] * dW

    def turned(y, w):  # Cayley: (y⁺ − y) = ½(y + y⁺) × w
        a = y + 0.5 * np.cross(y, w)
        w2 = 0.25 * (w * w).sum(1, keepdims=True)
        return (a + 0.25 * w * (a * w).sum(1, keepdims=True) + 0.5 * np.cross(a, w)) / (1 + w2)

    def solver(y, dt, dW, areas, H):
        decay = np.exp(-0.5 * problem.gamma * dt)
        for dw in dW:
            y = decay * y
            ahead = turned(y, omega(y, dt, dw))
            y = decay * turned(y, omega(0.5 * (y + ahead), dt, dw))
        return y

    return solver


# Name, package, constructor, paths, and the strong order that the package states: with commuting
# noise, in general, and with additive noise.
SOLVERS = [
    ("Euler", "Diffrax", of_diffrax("Euler", True), 1024, (0.5, 0.5, 1)),
    ("Heun", "Diffrax", of_diffrax("Heun", False), 1024, (0.5, 0.5, 0.5)),
    ("EulerHeun", "Diffrax", of_diffrax("EulerHeun", False), 1024, (0.5, 0.5, 0.5)),
    ("ItoMilstein", "Diffrax", of_diffrax("ItoMilstein", True), 1024, (1, None, 1)),
    ("StratonovichMilstein", "Diffrax", of_diffrax("StratonovichMilstein", False), 1024, (1, None, 1)),
    ("SlowRK", "Diffrax", of_diffrax("SlowRK", False), 1024, (1.5, 0.5, 1.5)),
    ("SPaRK", "Diffrax", of_diffrax("SPaRK", False), 1024, (1, 0.5, 1.5)),
    ("ShARK", "Diffrax", of_diffrax("ShARK", False), 1024, (None, None, 1.5)),
    ("SRA1", "Diffrax", of_diffrax("SRA1", False), 1024, (None, None, 1.5)),
    ("euler", "torchsde", of_torchsde("euler", True), 1024, (0.5, 0.5, 1)),
    ("milstein", "torchsde", of_torchsde("milstein", False), 1024, (1, None, 1)),
    ("milstein, grad_free", "torchsde", of_torchsde("milstein", False, grad_free=True), 1024, (1, None, 1)),
    ("heun", "torchsde", of_torchsde("heun", False), 1024, (0.5, 0.5, 0.5)),
    ("midpoint", "torchsde", of_torchsde("midpoint", False), 1024, (0.5, 0.5, 0.5)),
    ("euler_heun", "torchsde", of_torchsde("euler_heun", False), 1024, (0.5, 0.5, 0.5)),
    ("reversible_heun", "torchsde", of_torchsde("reversible_heun", False), 1024, (0.5, 0.5, 1)),
    ("log_ode", "torchsde", of_torchsde("log_ode", False), 1024, (1, 1, 1)),
    ("itoEuler", "sdeint", of_sdeint("itoEuler", True, None), 64, (0.5, 0.5, 1)),
    ("stratHeun", "sdeint", of_sdeint("stratHeun", False, None), 64, (0.5, 0.5, 0.5)),
    ("itoSRI2", "sdeint", of_sdeint("itoSRI2", True, "I"), 64, (1, 1, 1)),
    ("stratSRS2", "sdeint", of_sdeint("stratSRS2", False, "J"), 64, (1, 1, 1)),
    ("SIB", "NumPy", sib, 1024, (0.5, 0.5, None)),
]
TARGET = 1e-2


def seconds_at(report, target):
    """Microseconds of a path whose y(T) has this error, along a line through both finest sizes."""
    errors, seconds = (np.array(report.data[key]) for key in ("errors", "seconds"))
    slope = np.log(errors[-2] / errors[-1]) / np.log(2)
    steps = (errors[-1] / target) ** (1 / max(slope, 0.1))
    return seconds[-1] / report.paths * steps * 1e6


def weak_cost(data, nanoseconds, problem):
    """Microseconds of a path whose mean has an error of 10⁻³, from the difference of the two coarsest
    sizes, which is half of the error for order one; nothing where that is noise."""
    first = data["weak"][0]["points"][0]
    if abs(first["value"]) < 3 * first["se"]:
        return "–"
    return f"{nanoseconds * problem.until / first['tau'] * abs(first['value']) * 2:.1f}"


def measured(name, problem, make, paths, claimed, reference):
    try:
        solver = make(problem)
        if solver is None:
            return None
        report = reference(paths).judge(
            solver, areas=True, strong=claimed, same_step=name != "reversible_heun"
        )
    except Exception as error:  # What a package refuses is told.
        print(f"refused: {error}", file=sys.stderr)
        return "–"
    report.paths = paths
    return report


def ours(scheme):
    """A row of a scheme of this project, by `order` and `run`, on one thread."""
    cells, ns, cost, weak, law = [], [], "–", "–", "–"
    for label, problem in PROBLEMS.items():
        scene = problem.scene(scheme=scheme)
        try:
            order = scene.order(threads=1)
        except casimir.SceneError:
            cells.append("–")
            continue
        cells.append("?" if order.strong is None else f"{order.strong:g}")
        begun, paths = time.perf_counter(), 20_000
        scene.run(paths=paths, threads=1, **{"times": 1})
        ns.append((time.perf_counter() - begun) / (paths * 256) * 1e9)
        if label == "Kubo":
            weak = weak_cost(order.data, ns[-1], problem)
        if label == "rigid body":
            last = order.data["strong"]["points"][-1]
            # Differences of successive sizes are 1 − 2^−p of the error.
            rate = order.data["strong"]["rate"]["estimate"]
            error = last["value"] / (1 - 0.5**rate)
            steps = problem.until / last["tau"] * (error / TARGET) ** (1 / rate)
            cost = f"{steps * ns[-1] * 1e-3:.1f}"
            long = scene.run(paths=32, until=100, steps=10_000)
            law = f"{np.abs(long['C1 defect'][:, -1]).max():.0e}"
    row = [f"ours `{scheme}`", "", *cells, f"{np.median(ns):.0f}", cost, weak, law]
    print("|" + "|".join(row) + "|", flush=True)


def main():
    wanted = sys.argv[1] if len(sys.argv) > 1 else ""
    names = list(PROBLEMS)
    print("|solver|stated|" + "|".join(names) + "|ns|µs strong|µs weak|law|")
    print("|---" * (len(names) + 6) + "|")
    for name, package, make, paths, stated in SOLVERS:
        if wanted not in f"{package} {name}":
            continue
        begun, cells, ns, cost, weak, law = time.time(), [], [], "–", "–", "–"
        for label, problem in PROBLEMS.items():
            claimed = stated[2] if problem.additive else stated[0 if problem.commutes else 1]

            def referee(paths, problem=problem):
                return casimir.Referee(problem.scene(), paths=paths, levels=6 if paths > 64 else 5)

            found = measured(name, problem, make, paths, claimed, referee)
            if found is None or isinstance(found, str):
                cells.append("–")
                continue
            verdict = found.data["verdicts"][0]
            limit = found.data["strong"]["words"]
            order = f"{found.strong:g}" if found.strong is not None else f"≥{claimed}"
            other = "✗" if limit.startswith("no order: the scheme converges") else f"✗{order}"
            mark = {"confirmed": order, "refuted": other, "cannot tell": "?", None: f"({order})"}
            cells.append(mark[verdict["verdict"]])
            print(f"{package} {name} on {label}: {verdict['words']}", file=sys.stderr)
            steps = [problem.until / tau for tau in found.data["steps"]]
            ns.append(found.data["seconds"][-1] / (paths * steps[-1]) * 1e9)
            if label == "Kubo" and verdict["verdict"] != "refuted":
                weak = weak_cost(found.data, ns[-1], problem)
            if label == "rigid body":
                cost = f"{seconds_at(found, TARGET):.0f}"
                generator = np.random.default_rng(1)
                few = 192 if package == "Diffrax" else 1 if package == "sdeint" else 32
                y = np.tile(problem.initial, (few, 1))
                dW = 0.1 * generator.standard_normal((10_000, few, 3))
                ends = np.asarray(make(problem)(y, 0.01, dW, np.zeros((10_000, few, 3, 3)), 0 * dW))
                exact = np.exp(-problem.gamma * 100.0) * np.linalg.norm(problem.initial)
                law = f"{np.abs(np.linalg.norm(ends, axis=1) / exact - 1).max():.0e}"
        words = ", ".join("–" if order is None else f"{order:g}" for order in stated)
        median = f"{np.median(ns):.0f}" if ns else "–"
        row = [f"{package} `{name}`", words, *cells, median, cost, weak, law]
        print("|" + "|".join(row) + "|", flush=True)
        print(f"{time.time() - begun:.0f} s", file=sys.stderr)
    for scheme in ("heun", "sexp-li", "sexp", "sexp-levy", "em"):
        if wanted in f"ours {scheme}":
            ours(scheme)


if __name__ == "__main__":
    main()
