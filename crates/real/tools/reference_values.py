#!/usr/bin/env python3
"""Print the table of reference values which `crates/real/tests/all/elementary.rs` compares with.

Each line is `function argument value remainder`: argument and value are the bits of an f64 in
hexadecimal, the value is the f64 nearest to the exact result, and the exact result is
value + remainder * ulp(value). Computed with mpmath at 60 digits.

Usage: python3 crates/real/tools/reference_values.py > crates/real/tests/elementary_reference.txt

With --measure it reads the lines printed by an example of the crate and prints the largest error of
each function, in ulp (absolute where `absolute` says so):

    cargo run --release --package casimir-real --example elementary_values |
        python3 crates/real/tools/reference_values.py --measure
"""

import math
import random
import struct
import sys

from mpmath import cos, exp, ldexp, log, mp, mpf, nint, pi, sin

mp.dps = 60
random.seed(20240229)


def bits(x):
    return struct.unpack("<Q", struct.pack("<d", x))[0]


def from_bits(b):
    return struct.unpack("<d", struct.pack("<Q", b))[0]


def nearest(v):
    """The f64 nearest to v, subnormal ones included."""
    if v == 0:
        return 0.0
    return float(ldexp(nint(ldexp(v, 1074)), -1074)) if abs(v) < ldexp(mpf(1), -1022) else float(v)


def emit(name, f, points):
    for x in sorted(set(points)):
        v = f(mpf(x))
        y = nearest(v)
        remainder = (v - mpf(y)) / mpf(math.ulp(y))
        print(f"{name} {bits(x):016x} {bits(y):016x} {float(remainder):.4f}")


def log_uniform(low, high, n):
    return [2.0 ** random.uniform(low, high) for _ in range(n)]


def near(x, ulps):
    b = bits(float(x))
    return [from_bits(b + d) for d in ulps]


def signed(xs):
    return [random.choice((-1.0, 1.0)) * x for x in xs]


def hardest(n, limit):
    """The f64 numbers up to limit which are relatively nearest to a multiple of pi/2."""
    shift = 200
    half_pi = int(ldexp(pi / 2, shift))
    found = []
    multiple = 0
    for _ in range(int(limit / (math.pi / 2))):
        multiple += half_pi
        unit = multiple.bit_length() - 53
        rounded = (multiple + (1 << (unit - 1))) >> unit
        distance = abs((rounded << unit) - multiple)
        found.append((distance, math.ldexp(rounded, unit - shift)))
    found.sort()
    return [x for _, x in found[:n]]


EXACT = {
    "sin": sin,
    "cos": cos,
    "sinc": lambda x: sin(x) / x,
    "sin_half_turn": lambda r: sin(pi * r),
    "cos_half_turn": lambda r: cos(pi * r),
    "exp": exp,
    "ln": log,
    "ln_unit": log,
    "sin_absolute": sin,
    "cos_absolute": cos,
    "deficit": lambda x: (1 - sin(x) / x) / x**2,
    "versine": lambda x: (1 - cos(x)) / x**2,
}


def absolute(name):
    return name.endswith(("_turn", "_absolute")) or name in ("deficit", "versine")


def measure():
    mp.prec = 130
    worst = {}
    for line in sys.stdin:
        fields = line.split()
        if len(fields) != 3 or fields[0] not in EXACT:
            continue
        name = fields[0]
        x, y = (from_bits(int(field, 16)) for field in fields[1:])
        if math.isinf(y):
            continue
        v = EXACT[name](mpf(x))
        unit = 1 if absolute(name) else mpf(math.ulp(nearest(v)))
        worst[name] = max(worst.get(name, (0.0, 0.0)), (float(abs(mpf(y) - v) / unit), x))
    for name, (error, x) in worst.items():
        print(f"{name}: {error:.4g} at {x!r}")


def main():
    trig = signed(log_uniform(-30, 3, 70)) + signed(log_uniform(3, 20, 70))
    trig += signed([random.uniform(0, 4) for _ in range(80)])
    trig += signed(hardest(40, 2**20))
    for k in list(range(1, 17)) + [random.randrange(17, 2**19) for _ in range(20)]:
        # Next to the multiples of pi/2 and where the quadrant changes.
        trig += signed(near(k * pi / 2, (-1, 0, 1)))
        trig += signed(near((k - mpf(1) / 2) * pi / 2, (0,)))
    trig += [5e-324, 1e-310, 2.0**-1022, 1e-100, 2.0**-27, 2.0**-26, 2.0**20]
    emit("sin", sin, trig)
    emit("cos", cos, trig)
    emit("sinc", EXACT["sinc"], trig)

    e = [random.uniform(-745.2, 709.78) for _ in range(150)]
    e += [random.uniform(-745.2, -708.0) for _ in range(60)]
    e += signed(log_uniform(-60, 0, 80)) + [random.uniform(-1, 1) for _ in range(80)]
    for k in list(range(-8, 9)) + [random.randrange(-1074, 1023) for _ in range(40)]:
        e += near((k + mpf(1) / 2) * log(mpf(2)), (-1, 1))
    e += [0.0, 709.782712893384, -745.1332191019411, -708.3964185322641, -708.3964185322642]
    emit("exp", exp, e)

    normal = log_uniform(-1022, 1023, 100) + log_uniform(-4, 4, 100)
    one = [1 + s * 2.0**-j for j in range(1, 53) for s in (-1, 1)]
    one += [1 + random.uniform(-0.3, 0.42) for _ in range(100)]
    edges = [x for k in range(-6, 7) for x in near(mpf(2) ** (k + mpf(1) / 2), (-1, 0, 1))]
    powers = [2.0**k for k in range(-1022, 1024, 93)] + [from_bits(0x7FEFFFFFFFFFFFFF), 2.0**-1022]
    subnormal = [5e-324, 1e-320, from_bits(0x000FFFFFFFFFFFFF)] + log_uniform(-1073, -1022, 20)
    emit("ln", log, normal + one + edges + powers + subnormal)
    unit = [x for x in normal + one + edges + powers if x < 1]
    emit("ln_unit", log, unit + [random.random() for _ in range(150)] + near(1, (-3, -2, -1)))

    few = signed(log_uniform(-10, 20, 30)) + signed([random.uniform(0, 8) for _ in range(30)])
    for k in list(range(1, 5)) + [random.randrange(17, 2**19) for _ in range(4)]:
        few += signed([float(k * pi / 2), float((k - mpf(1) / 2) * pi / 2)])
    emit("sin_absolute", sin, few)
    emit("cos_absolute", cos, few)
    short = signed(log_uniform(-30, -0.51, 40)) + signed([random.uniform(0, 0.7) for _ in range(35)])
    mp.dps = 100
    emit("deficit", EXACT["deficit"], short)
    emit("versine", EXACT["versine"], short)
    mp.dps = 60
    half = signed(log_uniform(-52, -1, 40)) + signed([random.uniform(0, 0.5) for _ in range(40)])
    half += [0.0, 0.25, -0.25, 0.5, -0.5] + near(0.5, (-2, -1))
    emit("sin_half_turn", EXACT["sin_half_turn"], half)
    emit("cos_half_turn", EXACT["cos_half_turn"], half)


if __name__ == "__main__":
    measure() if "--measure" in sys.argv[1:] else main()
