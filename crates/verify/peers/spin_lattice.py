"""What a step of a spin lattice costs in compiled Python, to compare with the example
`lattice_cost` of `lattice`.

The same equation as there, on classical spins of a periodic cubic lattice:
ds = s x (v dt - sigma o dW) with v = grad H0 + alpha s x grad H0 / |s| and H0 = -J sum of s_i . s_j
over bonds, with three independent noises at every site, and alpha = 0 as there. Double precision,
one thread, no fast-math.

- sib: the semi-implicit scheme B of Mentink, Tretyakov, Fasolino, Katsnelson and Rasing (2010):
  a predictor and a corrector, each a Cayley rotation of the spin at the start;
- heun: the stochastic Heun scheme with spins normalised after each step, as in VAMPIRE and Spirit.

Normals are drawn by NumPy's PCG64 and its ziggurat, in compiled code. Printed are ns of processor
time per spin and step, the least of some runs, and the part of it that is the noise.

    python3 -m venv venv && venv/bin/pip install numpy numba
    venv/bin/python crates/verify/peers/spin_lattice.py [most spins]
"""

import sys
import time

import numpy as np
from numba import njit

J, ALPHA, SIGMA, TAU = 1.0, 0.0, 0.1, 0.01
RUNS = 5
SPIN_STEPS = 4_000_000


@njit
def draw(generator, dw, scale):
    """Increments N(0, scale^2) at every site."""
    n = dw.shape[1]
    for c in range(3):
        for i in range(n):
            dw[c, i] = scale * generator.standard_normal()


@njit(inline="always")
def drive(s, x, y, z, i, up, down, edge, dw):
    """v dt - sigma dW at site i = x + edge (y + edge z)."""
    plane = edge * edge
    xy = i - x
    xz = i - edge * y
    yz = i - plane * z
    right, left = xy + up[x], xy + down[x]
    back, front = xz + edge * up[y], xz + edge * down[y]
    top, bottom = yz + plane * up[z], yz + plane * down[z]
    f0 = -J * (s[0, right] + s[0, left] + s[0, back] + s[0, front] + s[0, top] + s[0, bottom])
    f1 = -J * (s[1, right] + s[1, left] + s[1, back] + s[1, front] + s[1, top] + s[1, bottom])
    f2 = -J * (s[2, right] + s[2, left] + s[2, back] + s[2, front] + s[2, top] + s[2, bottom])
    a, b, c = s[0, i], s[1, i], s[2, i]
    weight = ALPHA / np.sqrt(a * a + b * b + c * c)
    return (
        (f0 + weight * (b * f2 - c * f1)) * TAU - SIGMA * dw[0, i],
        (f1 + weight * (c * f0 - a * f2)) * TAU - SIGMA * dw[1, i],
        (f2 + weight * (a * f1 - b * f0)) * TAU - SIGMA * dw[2, i],
    )


@njit(inline="always")
def cayley(a, b, c, u, v, w):
    """z = s + (s + z)/2 x v."""
    u, v, w = 0.5 * u, 0.5 * v, 0.5 * w
    p, q, r = b * w - c * v, c * u - a * w, a * v - b * u
    factor = 2.0 / (1.0 + u * u + v * v + w * w)
    return (
        a + factor * (p + q * w - r * v),
        b + factor * (q + r * u - p * w),
        c + factor * (r + p * v - q * u),
    )


@njit
def sib(s, middle, dw, up, down, edge):
    """One step of SIB."""
    i = 0
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                u, v, w = drive(s, x, y, z, i, up, down, edge, dw)
                a, b, c = s[0, i], s[1, i], s[2, i]
                p, q, r = cayley(a, b, c, u, v, w)
                middle[0, i] = 0.5 * (a + p)
                middle[1, i] = 0.5 * (b + q)
                middle[2, i] = 0.5 * (c + r)
                i += 1
    i = 0
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                u, v, w = drive(middle, x, y, z, i, up, down, edge, dw)
                s[0, i], s[1, i], s[2, i] = cayley(s[0, i], s[1, i], s[2, i], u, v, w)
                i += 1


@njit
def heun(s, predicted, first, dw, up, down, edge):
    """One step of Heun, normalised."""
    i = 0
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                u, v, w = drive(s, x, y, z, i, up, down, edge, dw)
                a, b, c = s[0, i], s[1, i], s[2, i]
                p, q, r = b * w - c * v, c * u - a * w, a * v - b * u
                first[0, i], first[1, i], first[2, i] = p, q, r
                predicted[0, i], predicted[1, i], predicted[2, i] = a + p, b + q, c + r
                i += 1
    i = 0
    for z in range(edge):
        for y in range(edge):
            for x in range(edge):
                u, v, w = drive(predicted, x, y, z, i, up, down, edge, dw)
                a, b, c = predicted[0, i], predicted[1, i], predicted[2, i]
                p = s[0, i] + 0.5 * (first[0, i] + b * w - c * v)
                q = s[1, i] + 0.5 * (first[1, i] + c * u - a * w)
                r = s[2, i] + 0.5 * (first[2, i] + a * v - b * u)
                scale = 1.0 / np.sqrt(p * p + q * q + r * r)
                s[0, i], s[1, i], s[2, i] = scale * p, scale * q, scale * r
                i += 1


def energy(s, edge):
    """H0 per spin."""
    grid = s.reshape(3, edge, edge, edge)
    return -J * sum(np.mean(np.sum(grid * np.roll(grid, 1, axis), axis=0)) for axis in (1, 2, 3))


def start(edge):
    """Spins along x, y and z in turn."""
    n = edge**3
    s = np.zeros((3, n))
    s[np.arange(n) % 3, np.arange(n)] = 1.0
    sites = np.arange(edge)
    return s, (sites + 1) % edge, (sites - 1) % edge


def check():
    """Lengths stay, both schemes agree, and without noise the energy stays."""
    edge = 6
    ends = []
    for scheme in ("sib", "heun"):
        generator = np.random.default_rng(5)
        s, up, down = start(edge)
        work, dw = [np.zeros_like(s) for _ in range(2)], np.zeros_like(s)
        before = energy(s, edge)
        for n in range(200):
            if n < 100:
                draw(generator, dw, np.sqrt(TAU))
            else:
                dw[:] = 0.0
                before = energy(s, edge) if n == 100 else before
            if scheme == "sib":
                sib(s, work[0], dw, up, down, edge)
            else:
                heun(s, work[0], work[1], dw, up, down, edge)
        assert np.abs(np.sum(s * s, axis=0) - 1.0).max() < 1e-12, scheme
        assert abs(energy(s, edge) - before) < 1e-3, scheme
        ends.append(s)
    distance = np.abs(ends[0] - ends[1]).max()
    assert 0.0 < distance < 0.05, distance


def measure(scheme, edge):
    """ns per spin and step, and of the noise alone."""
    s, up, down = start(edge)
    n = s.shape[1]
    work, dw = [np.zeros_like(s) for _ in range(2)], np.zeros_like(s)
    generator = np.random.default_rng(1)
    steps = max(2, SPIN_STEPS // n)
    least, least_noise = np.inf, np.inf
    for _ in range(RUNS):
        total, noise = -time.thread_time(), 0.0
        for _ in range(steps):
            noise -= time.thread_time()
            draw(generator, dw, np.sqrt(TAU))
            noise += time.thread_time()
            if scheme == "sib":
                sib(s, work[0], dw, up, down, edge)
            else:
                heun(s, work[0], work[1], dw, up, down, edge)
        total += time.thread_time()
        least, least_noise = min(least, total), min(least_noise, noise)
    return 1e9 * least / (steps * n), 1e9 * least_noise / (steps * n)


def main():
    most = int(sys.argv[1]) if len(sys.argv) > 1 else 10**6
    check()
    print("ns per spin and step: all (noise alone)\n")
    print("scheme     spins       all     noise")
    for edge in (10, 22, 46, 100):
        if edge**3 <= most:
            for scheme in ("sib", "heun"):
                every, noise = measure(scheme, edge)
                print(f"{scheme:6} {edge**3:9} {every:9.2f} {noise:9.2f}")


main()
