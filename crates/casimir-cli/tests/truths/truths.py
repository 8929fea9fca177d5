"""Writes `truths.toml`: the problems of `problems.py` with their truths, each found in two ways.

    python3 truths.py            all problems; needs NumPy, SciPy and SymPy
    python3 truths.py spin       those with this word in their name; the others stay

Truths are means and deviations at T. No code of this project takes part. Methods:

linear         moments to fourth order of a linear system by their ordinary differential equations
clock          H₁ = cH₀: a deterministic path at a normal time, quadrature over that time
deterministic  the ordinary differential equation to 1e-12
lattice        independent spins: rotations with noise in closed form
sampled        paths by an integrator of order four between kicks of order two (`strang`) or, with
               `grid`, an independent Runge–Kutta method; the energy by the trace formula

`check` compares with paths of Runge–Kutta's method on the same formulas, whose derivatives are
SymPy's: no truth may be farther away than five standard errors.
"""

import sys
import tomllib

import numpy as np
import sympy as sp
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm
from sympy.codegen.rewriting import create_expand_pow_optimization

from problems import PROBLEMS

# Powers as products, which are ten times as fast.
POWERS = create_expand_pow_optimization(4)
TIGHT = dict(method="DOP853", rtol=1e-12, atol=1e-20)


class System:
    """What a scene says, with derivatives by SymPy."""

    def __init__(self, scene):
        table = tomllib.loads(scene)
        system, run = table["system"], table["run"]
        names = system["state"]
        self.names = names
        self.y = sp.symbols(names)
        known = dict(zip(names, self.y)) | {"ln": sp.log}
        for name, value in system.get("parameters", {}).items():
            known[name] = sp.Float(value, 17) if isinstance(value, float) else sp.Integer(value)
        read = lambda text: sp.sympify(str(text).replace("^", "**"), locals=known)
        d = len(names)
        rows = system["B"]
        b = sp.zeros(d, d)
        for i, row in enumerate(rows):
            for j, entry in enumerate(row):
                if len(rows) == d:
                    b[i, j] = read(entry)
                else:
                    b[i, i + 1 + j] = read(entry)
                    b[i + 1 + j, i] = -read(entry)
        assert sp.simplify(b + b.T) == sp.zeros(d, d)
        self.h0 = read(system["H0"])
        self.h = [read(h) for h in system.get("H", [])]
        gradient = lambda h: sp.Matrix([sp.diff(h, y) for y in self.y])
        self.fields = [list(b * gradient(h)) for h in [self.h0, *self.h]]
        self.t = sp.Symbol("t")
        rate = table.get("damping", {}).get("rate", "0")
        self.rate_of_t = sp.sympify(str(rate).replace("^", "**"), locals={"t": self.t})
        self.rate = sp.lambdify(self.t, self.rate_of_t, "numpy")
        self.y0 = np.array([float(read(x)) for x in run["initial"]])
        self.until, self.steps, self.paths = float(run["until"]), run["steps"], run["paths"]
        observe = {name: self.h0 if text == "H0" else read(text)
                   for name, text in table.get("observe", {}).items()}
        self.observed = dict(zip(names, self.y)) | observe
        self.field = [self.numbers(f) for f in self.fields]

    def numbers(self, expressions):
        # No `cse`: it makes −x²y of −2xy beside products that are not to be evaluated.
        fast = sp.lambdify(self.y, [POWERS(sp.sympify(f)) for f in expressions], "numpy")
        plain = sp.lambdify(self.y, list(expressions), "numpy")
        point = np.linspace(0.3, 1.1, len(self.y))
        assert np.allclose(fast(*point), plain(*point), rtol=1e-12, atol=0)
        return lambda y: np.stack([np.broadcast_to(x, y[0].shape) for x in fast(*y)])

    def observables(self, y):
        return {name: self.numbers([f])(y)[0] for name, f in self.observed.items()}


def of_samples(values):
    """Mean, deviation, kurtosis, and standard errors of the first two."""
    n, mean, s = values.size, values.mean(), values.std(ddof=1)
    kurtosis = np.mean((values - mean) ** 4) / s**4 if s > 0 else 1.0
    return mean, s, kurtosis, s / np.sqrt(n), s / 2 * np.sqrt(max(kurtosis - 1, 0) / n)


def runge_kutta(system, steps, paths, seed=1):
    """Runge–Kutta's method on increments that are spread over their steps."""
    rng = np.random.default_rng(seed)
    tau = system.until / steps
    y = np.repeat(system.y0[:, None], paths, 1)
    for n in range(steps):
        dw = rng.standard_normal((len(system.h), paths)) * np.sqrt(tau)

        def f(y, c):
            slope = system.field[0](y) * tau - system.rate((n + c) * tau) * tau * y
            for field, increment in zip(system.field[1:], dw):
                slope = slope + field(y) * increment
            return slope

        a = f(y, 0)
        b = f(y + a / 2, 0.5)
        c = f(y + b / 2, 0.5)
        y = y + (a + 2 * b + 2 * c + f(y + c, 1)) / 6
    return system.observables(y)


def quadratic(system, name):
    """The matrix of an observable in (1, y), or None."""
    f, d = system.observed[name], len(system.y)
    poly = sp.Poly(f, *system.y)
    if poly.total_degree() > 2:
        return None
    q = np.zeros((d + 1, d + 1))
    for powers, c in poly.terms():
        at = [i + 1 for i, k in enumerate(powers) for _ in range(k)]
        i, j = ([0, 0] + at)[-2:]
        q[i, j] += float(c) / 2
        q[j, i] += float(c) / 2
    return q


def linear(system, settings):
    """Moments of z = (1, y) to fourth order; units make them of size one."""
    d = len(system.y)
    *scales, time = settings.get("units", (1,) * d + (1,))
    scale = np.array([1, *scales], float)

    def matrix(field):
        a = np.zeros((d + 1, d + 1))
        for i, f in enumerate(field):
            poly = sp.Poly(f, *system.y)
            assert poly.total_degree() <= 1
            for powers, c in poly.terms():
                a[i + 1, powers.index(1) + 1 if sum(powers) else 0] = float(c)
        return a / scale[:, None] * scale[None, :]

    a, *noises = [matrix(f) for f in system.fields]
    drift = (a + sum(m @ m for m in noises) / 2) / time
    noises = [m / np.sqrt(time) for m in noises]
    damped = np.diag([0.0] + [1.0] * d)
    until = system.until * time
    z0 = np.concatenate([[1], system.y0]) / scale

    def moments(order):
        shape = (d + 1,) * order
        start = z0
        for _ in range(order - 1):
            start = np.multiply.outer(start, z0)

        def apply(m, x, k):
            return np.moveaxis(np.tensordot(m, x, (1, k)), 0, k)

        def slope(s, x):
            x = x.reshape(shape)
            g = drift - system.rate(s / time) / time * damped
            total = sum(apply(g, x, k) for k in range(order))
            for m in noises:
                for k in range(order):
                    for l in range(k):
                        total = total + apply(m, apply(m, x, k), l)
            return total.ravel()

        size = (d + 1) ** order
        if system.rate_of_t.is_number and size < 700:
            generator = np.stack([slope(0, e) for e in np.eye(size)], 1)
            return (expm(generator * until) @ start.ravel()).reshape(shape)
        tight = TIGHT | dict(rtol=1e-12 if order < 4 else 1e-10)
        solution = solve_ivp(slope, (0, until), start.ravel(), **tight)
        assert solution.success
        return solution.y[:, -1].reshape(shape)

    m2, m4 = moments(2), moments(4)
    found = {}
    for name in system.observed:
        q = quadratic(system, name)
        if q is None:
            continue
        q = q * scale[:, None] * scale[None, :]
        mean = np.sum(q * m2)
        size = np.max(np.abs(q)) or 1
        centred = q / size
        centred = centred - np.diag([mean / size] + [0] * d)
        variance = np.einsum("ij,ijkl,kl", centred, m4, centred)
        floor = 1e-9 * np.einsum("ij,ijkl,kl", q / size, m4, q / size)
        found[name] = (mean, size * np.sqrt(max(variance, 0)) if variance > floor else 0.0)
    return found


def clock(system, settings):
    """y(T) = e^{−Γ}x(S) with dx = B∇H₀ ds, S normal."""
    c, t = settings["strength"], system.t
    until = system.until
    if settings.get("homogeneous"):
        gamma = sp.integrate(system.rate_of_t, (t, 0, t))
        factor = sp.lambdify(t, sp.exp(-gamma), "numpy")
        tight = dict(epsabs=1e-13, epsrel=1e-13, limit=500)
        mean = quad(factor, 0, until, **tight)[0]
        variance = c * c * quad(lambda s: factor(s) ** 2, 0, until, **tight)[0]
        last = float(factor(until))
    else:
        mean, variance, last = until, c * c * until, 1.0
    width = np.sqrt(variance)
    nodes = np.linspace(-9, 9, 4001)
    weights = np.exp(-nodes**2 / 2)
    weights /= weights.sum()
    times = mean + width * nodes
    f = lambda s, y: system.field[0](y[:, None])[:, 0]
    y = np.empty((len(system.y), times.size))
    for sign in (1, -1):
        some = times * sign > 0
        if some.any():
            order = np.argsort(np.abs(times[some]))
            at = times[some][order]
            solution = solve_ivp(f, (0, at[-1]), system.y0, t_eval=at, **TIGHT)
            assert solution.success
            y[:, np.flatnonzero(some)[order]] = solution.y
    y *= last
    found = {}
    for name, values in system.observables(y).items():
        m = np.sum(weights * values)
        s = np.sqrt(np.sum(weights * (values - m) ** 2))
        found[name] = (m, s if s > 1e-9 * abs(m) else 0.0)
    return found


def deterministic(system, settings):
    f = lambda s, y: system.field[0](y[:, None])[:, 0] - system.rate(s) * y
    solution = solve_ivp(f, (0, system.until), system.y0, **TIGHT)
    again = solve_ivp(f, (0, system.until), system.y0, method="Radau", rtol=1e-9, atol=1e-11)
    assert np.allclose(solution.y[:, -1], again.y[:, -1], rtol=1e-6)
    return {k: (v[0], 0.0) for k, v in system.observables(solution.y[:, -1:]).items()}


def lattice(scene):
    """Four spins, each in its noise σ(dW₁, dW₂, dW₃), with field h e₃: E s decays with γ + σ².

    The traceless part of E ssᵀ decays with 2γ + 3σ², the trace with 2γ. By the equation of Landau
    and Lifshitz ds = −s × h dt: with the field e₃ a spin turns about e₃ by the right hand.
    """
    table = tomllib.loads(scene)
    s = table["system"]["parameters"]["noise"]
    gamma, until = float(table["damping"]["rate"]), float(table["run"]["until"])
    y0 = np.array([0.6, 0, 0.8])
    found = {}
    mean = np.exp(-(gamma + s * s) * until)
    turn = until
    r = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    m = mean * (r @ y0)
    p = np.outer(r @ y0, r @ y0) - np.eye(3) / 3
    second = np.exp(-2 * gamma * until) * (np.eye(3) / 3 + np.exp(-3 * s * s * until) * p)
    for i, axis in enumerate("xyz"):
        dev = np.sqrt(second[i, i] - m[i] ** 2)
        found["m" + axis] = (m[i], dev / 2)
        found["s1" + axis] = (m[i], dev)
    found["energy"] = (-m[2], found["mz"][1])
    return found


def strang(system, steps, paths, seed=3):
    """Canonical H₀ = ½p² + V(q), Hₘ = σₘq: kicks around steps of order four (Forest and Ruth).

    Half a kick with its own increment at both ends: weak order two, and error terms of size σ².
    """
    rng = np.random.default_rng(seed)
    d = len(system.y) // 2
    tau = system.until / steps
    y = np.repeat(system.y0[:, None], paths, 1)
    kicks = [system.numbers(f)(y[:, :1])[d:, 0] for f in system.fields[1:]]
    force = system.numbers([-sp.diff(system.h0, q) for q in system.y[:d]])
    x = 1 / (2 - 2 ** (1 / 3))
    drifts = [x / 2, (1 - x) / 2, (1 - x) / 2, x / 2]
    pushes = [x, 1 - 2 * x, x]
    q, p = y[:d].copy(), y[d:].copy()

    def kick():
        for k in kicks:
            dw = rng.standard_normal(paths) * np.sqrt(tau / 2)
            for i in np.flatnonzero(k):
                p[i] += k[i] * dw

    def full(z):
        return np.concatenate([z, np.zeros_like(z)])

    for _ in range(steps):
        kick()
        for a, b in zip(drifts, [*pushes, 0]):
            q += a * tau * p
            if b:
                p += b * tau * force(full(q))
        kick()
    return system.observables(np.concatenate([q, p]))


def sampled(system, settings):
    found = {}
    if settings.get("grid"):
        coarse = {k: of_samples(v) for k, v in runge_kutta(system, 400, 400000, 11).items()}
    else:
        steps, paths = settings["hamiltonian"]
        coarse = {k: of_samples(v) for k, v in strang(system, steps, paths).items()}
    for name, (m, s, k, em, es) in coarse.items():
        found[name] = (m, s, em, es, k)
    if "energy" in settings:
        f0 = float(system.h0.subs(dict(zip(system.y, system.y0))))
        m, s, em, es, k = found["energy"]
        exact = f0 + settings["energy"] * system.until
        assert abs(m - exact) < 5 * em, (m, exact, em)
        found["energy"] = (exact, s, 0.0, es, k)
    if "only" in settings:
        found = {k: found[k] for k in settings["only"]}
    return found


def answers(method, settings, scene, say):
    """Name → mean, deviation, their standard errors, kurtosis."""
    if method == "lattice":
        return {k: (m, s, 0.0, 0.0, 3.0) for k, (m, s) in lattice(scene).items()}
    system = System(scene)
    if method == "sampled":
        found = sampled(system, settings)
        if "hamiltonian" in settings:
            steps, paths = settings["hamiltonian"]
            check = strang(system, steps // 2, paths // 4, 5)
        else:
            check = runge_kutta(system, *settings["check"])
    else:
        found = globals()[method](system, settings)
        if method == "deterministic":
            return {k: (m, s, 0.0, 0.0, 1.0) for k, (m, s) in found.items()}
        check = runge_kutta(system, *settings["check"])
    result = {}
    for name, truth in found.items():
        m, s, k, em, es = of_samples(check[name])
        error = truth[2:4] if len(truth) > 2 else (0.0, 0.0)
        small = 1e-3 * abs(truth[0]) / (1 if s < 1e-3 * abs(m) else 1e9)
        z = (m - truth[0]) / np.hypot(em, error[0] + small + 1e-300)
        v = (s - truth[1]) / np.hypot(es, error[1] + small + 1e-300)
        say(f"  {name:12} {truth[0]:+.10e} {truth[1]:.6e}  kurtosis {k:.2f}  z {z:+.2f} {v:+.2f}")
        assert abs(z) < 5 and abs(v) < 5, name
        result[name] = (truth[0], truth[1], *error, truth[4] if len(truth) > 4 else k)
    return result


HEAD = """# Written by truths.py: scenes with means and deviations that are known without this project.
# NAME = [mean, deviation, standard errors of both, kurtosis]
"""


def main():
    words = sys.argv[1:]
    try:
        with open("truths.toml", "rb") as file:
            known = {old["name"]: old for old in tomllib.load(file)["problem"]}
    except FileNotFoundError:
        known = {}
    text = HEAD
    for name, method, settings, scene in PROBLEMS:
        if words and not any(word in name for word in words):
            if name not in known or known[name]["scene"] != scene:
                continue
            truth = known[name]["truth"]
        else:
            print(name, flush=True)
            truth = answers(method, settings, scene, print)
        text += f"\n[[problem]]\nname = \"{name}\"\nmethod = \"{method}\"\nscene = '''\n{scene}'''\n"
        text += "[problem.truth]\n"
        for key, (m, s, em, es, k) in truth.items():
            text += f"{key} = [{m:.13e}, {s:.10e}, {em:.1e}, {es:.1e}, {k:.4g}]\n"
    with open("truths.toml", "w") as file:
        file.write(text)


main()
