#!/usr/bin/env python3
"""Print the constants of `crates/real/src/coefficients.rs`.

Every polynomial is a minimax approximation found by the Remez exchange in 60-digit arithmetic
(mpmath); the coefficients are then rounded to f64, the first ones first, with the remaining ones
fitted again after each rounding. The rational tangent interpolates at Chebyshev nodes, which is
nearly minimax, and its coefficients are rounded. The argument-reduction constants are truncated so that their
products with the reduction index are exact. A literal is the shortest decimal which reads back as
the same f64; 2 pi and pi/2 have their names from `std::f64::consts`.

Usage: python3 crates/real/tools/coefficients.py
"""

import struct

from mpmath import (
    atan, cos, exp, floor, ldexp, log, lu_solve, mag, matrix, mp, mpf, pi, polyval, sin, sqrt, tan,
)

mp.dps = 60


def remez(f, w, a, b, powers, iterations=60):
    """Coefficients c minimising max |w(t) (f(t) - sum c_i t^powers[i])| over [a, b]."""
    n = len(powers)
    nodes = [(a + b) / 2 + (b - a) / 2 * cos(pi * (2 * i + 1) / (2 * n + 2)) for i in range(n + 1)]
    nodes.reverse()
    grid = [(a + b) / 2 - (b - a) / 2 * cos(pi * i / 800) for i in range(801)]
    fs = [f(t) for t in grid]
    ws = [w(t) for t in grid]
    for _ in range(iterations):
        lhs, rhs = matrix(n + 1, n + 1), matrix(n + 1, 1)
        for i, t in enumerate(nodes):
            for j, p in enumerate(powers):
                lhs[i, j] = t**p
            lhs[i, n] = (-1) ** i / w(t)
            rhs[i] = f(t)
        solution = lu_solve(lhs, rhs)
        c, level = [solution[j] for j in range(n)], abs(solution[n])
        err = [wi * (fi - sum(cj * t**p for cj, p in zip(c, powers))) for t, fi, wi in zip(grid, fs, ws)]
        # One extremum in every run of one sign.
        runs, best = [], 0
        for i in range(1, len(grid)):
            if err[i] * err[best] > 0:
                if abs(err[i]) > abs(err[best]):
                    best = i
            else:
                runs.append(best)
                best = i
        runs.append(best)
        runs = [i for i in runs if err[i] != 0]
        # Too many: drop the smallest at an end, or the smallest inside with its smaller neighbour,
        # so that the signs still alternate.
        while len(runs) > n + 1:
            ends = [0, len(runs) - 1]
            where = ends if len(runs) == n + 2 else range(len(runs))
            i = min(where, key=lambda j: abs(err[runs[j]]))
            if i in ends:
                runs.pop(i)
            else:
                j = min((i - 1, i + 1), key=lambda j: abs(err[runs[j]]))
                for m in sorted((i, j), reverse=True):
                    runs.pop(m)
        worst = max(abs(e) for e in err)
        if len(runs) < n + 1:
            return c, worst
        nodes = [grid[i] for i in runs]
        if worst < level * mpf("1.001"):
            break
    return c, worst


def rounded_remez(f, w, a, b, powers):
    """As `remez`, with the coefficients rounded to f64 one after the other."""
    fixed = []
    for i in range(len(powers)):
        rest = lambda t: f(t) - sum(c * t**p for c, p in zip(fixed, powers))
        c, _ = remez(rest, w, a, b, powers[i:], 25)
        fixed.append(mpf(float(c[0])))
    grid = [a + (b - a) * mpf(i) / 1000 for i in range(1001)]
    worst = max(abs(w(t) * (f(t) - sum(c * t**p for c, p in zip(fixed, powers)))) for t in grid)
    return fixed, worst


def literal(v):
    names = {float(2 * pi): "TAU", float(pi / 2): "FRAC_PI_2"}
    return names.get(float(v), repr(float(v)))


def array(name, c):
    print(f"pub const {name}: [f64; {len(c)}] = [")
    for v in c:
        print(f"    {literal(v)},")
    print("];")


def polynomial(name, f, w, a, b, degree):
    c, worst = rounded_remez(f, w, a, b, list(range(degree + 1)))
    print(f"// {name}: {degree + 1} coefficients, error 2^{float(log(worst, 2)):.2f}")
    array(name, c)


def half_tangent(name, degree):
    """tan(pi r/2) = r A(r^2) / B(r^2) for |r| <= 1/2 with B(0) = 1; the error is that of the angle."""
    n = 2 * degree + 1
    nodes = [(1 + cos(pi * (2 * i + 1) / (2 * n))) / 8 for i in range(n)]
    lhs, rhs = matrix(n, n), matrix(n, 1)
    for i, z in enumerate(nodes):
        rhs[i] = tan(pi * sqrt(z) / 2) / sqrt(z)
        for j in range(degree + 1):
            lhs[i, j] = z**j
        for j in range(1, degree + 1):
            lhs[i, degree + j] = -rhs[i] * z**j
    solution = [mpf(float(c)) for c in lu_solve(lhs, rhs)]
    above, below = solution[: degree + 1], [mpf(1)] + solution[degree + 1 :]
    worst = 0
    for i in range(1, 1001):
        r = mpf(i) / 2000
        angle = 2 * atan(r * polyval(above[::-1], r * r) / polyval(below[::-1], r * r))
        worst = max(worst, abs(angle / (pi * r) - 1))
    print(f"// {name}: degrees {degree} and {degree}, relative error 2^{float(log(worst, 2)):.2f}")
    array(f"{name}_ABOVE", above)
    array(f"{name}_BELOW", below)


def truncated(v, bits):
    """v with only its leading `bits` significant bits."""
    shift = bits - mag(v)
    return ldexp(floor(ldexp(v, shift)), -shift)


def parts(name, v, bits):
    """v as a sum of parts, the leading ones with bits[i] significant bits, the last a whole f64."""
    for i, b in enumerate(bits):
        part = truncated(v, b)
        print(f"pub const {name}_{i + 1}: f64 = {literal(part)};")
        v -= part
    print(f"pub const {name}_{len(bits) + 1}: f64 = {literal(v)};")


def main():
    one = mpf(1)
    tiny = mpf(10) ** -12
    parts("HALF_PI", pi / 2, [33, 33, 33])
    print(f"pub const HALF_PI_REST: f64 = {literal(pi / 2 - truncated(pi / 2, 33))};")
    parts("LN_2", log(mpf(2)), [40])
    half = f"{struct.unpack('<Q', struct.pack('<d', float(sqrt(one / 2))))[0]:016x}"
    print(f"pub const SQRT_HALF_BITS: u64 = 0x{'_'.join(half[i : i + 4] for i in range(0, 16, 4))};")

    q = (pi / 4) ** 2 * mpf("1.0001")
    polynomial(
        "SIN",
        lambda z: (sin(sqrt(z)) / sqrt(z) - 1) / z,
        lambda z: z * sqrt(z) / sin(sqrt(z)),
        tiny, q, 5,
    )
    polynomial(
        "COS",
        lambda z: (cos(sqrt(z)) - 1 + z / 2) / z**2,
        lambda z: z**2 / cos(sqrt(z)),
        tiny, q, 5,
    )
    half_tangent("HALF_TANGENT", 3)
    s = (sqrt(mpf(2)) - 1) / (sqrt(mpf(2)) + 1)
    atanh2 = lambda z: log((1 + sqrt(z)) / (1 - sqrt(z))) / sqrt(z)
    polynomial(
        "LN",
        lambda z: (atanh2(z) - 2) / z,
        lambda z: z / atanh2(z),
        tiny, s * s * mpf("1.0001"), 6,
    )
    polynomial(
        "MINUS_TWO_LN",
        lambda z: -2 * (atanh2(z) - 2) / z,
        lambda z: z / (2 * atanh2(z)),
        tiny, s * s * mpf("1.0001"), 5,
    )
    h = log(mpf(2)) / 2 * mpf("1.0001")
    polynomial(
        "EXP",
        lambda r: (exp(r) - 1 - r) / r**2 if r else one / 2,
        lambda r: r * r / exp(r),
        -h, h * mpf("1.00001"), 9,
    )
    z = one / 2
    deficit = lambda z: (1 - sin(sqrt(z)) / sqrt(z)) / z
    versine = lambda z: (1 - cos(sqrt(z))) / z
    polynomial("DEFICIT", deficit, lambda z: z, mpf(10) ** -8, z, 5)
    polynomial("VERSINE", versine, lambda z: sqrt(z), mpf(10) ** -8, z, 5)


if __name__ == "__main__":
    main()
