"""The problems: as scenes for the referee, and as plain formulas for everybody's solvers."""

from dataclasses import dataclass
from typing import Any, Callable

import casimir

SPIN = [["-z", "y"], ["-x"]]


@dataclass
class Problem:
    """dy = (f − γy)dt + Σ b_m ∘ dW_m; `fields(m, y)` gives f and all b_m as lists of components of
    the list y, with the functions of a module m such as numpy."""

    system: casimir.System
    initial: list[float]
    fields: Callable[[Any, list[Any]], tuple[list[Any], list[list[Any]]]]
    gamma: float
    noises: int
    of: str
    commutes: bool = True
    additive: bool = False
    law: str | None = None
    until: float = 1.0

    def scene(self, **changes: Any) -> casimir.Scene:
        expect = {"of": [self.of], "accuracy": 1e-2}
        return self.system.scene(
            initial=self.initial, until=self.until, steps=256, expect=expect, **changes
        )


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def pendulum(m, y):
    f = [-m.sin(y[1]), y[0]]
    return f, [[0.5 * x for x in f]]


def rigid_body(m, y):
    f = cross(y, [y[0] / 2, y[1], 1.5 * y[2]])
    zero = 0 * y[0]
    axes = [[y[0], zero, zero], [zero, y[1] / 2, zero], [zero, zero, y[2] / 3]]
    return f, [cross(y, v) for v in axes]


def maxwell_bloch(m, y):
    return [y[1], y[2] * y[0], -y[1] * y[0]], [[0.5 * y[1], 0 * y[0], 0 * y[0]]]


def poisson(m, y):
    g = [m.cos(x) for x in y]
    f = [g[1] - g[2], g[2] - g[0], g[0] - g[1]]
    return f, [[0.5 * x for x in f]]


def kubo(m, y):
    return [y[1], -y[0]], [[0.5 * y[1], -0.5 * y[0]]]


def heavy_top(m, y):
    a, g, zero = y[:3], y[3:], 0 * y[0]
    one = zero + 1

    def field(u, v):
        return [s + t for s, t in zip(cross(a, u), cross(g, v))] + cross(g, u)

    f = field([a[0], 0.8 * a[1], 1.8 * a[2]], [zero, zero, one])
    return f, [field([0.5 * one, zero, zero], [zero] * 3), field([zero] * 3, [zero, zero, 0.7 * one])]


def bath(m, y):
    return [y[1] - 0 * y[0], -4 * y[0] * (y[0] ** 2 - 1)], [[0 * y[0], 0 * y[0] - 0.9]]


PROBLEMS = {
    "pendulum": Problem(
        casimir.System("p q", [["-1"]], "p^2/2 - cos(q)", ["0.5*(p^2/2 - cos(q))"], damping=2.0),
        [0.2, 1.0], pendulum, 2.0, 1, "p",
    ),
    "rigid body": Problem(
        casimir.System(
            "x y z", SPIN, "x^2/4 + y^2/2 + 3*z^2/4", ["x^2/2", "y^2/4", "z^2/6"], damping=0.2
        ),
        [0.4536, 0.0, 0.8912], rigid_body, 0.2, 3, "z^2", commutes=False, law="C1",
    ),
    "Maxwell–Bloch": Problem(
        casimir.System(
            "x y z", [["-z", "y"], ["0"]], "x^2/2 + z", ["0.5*z"], damping=0.2
        ),
        [1.0, 0.6, 0.8], maxwell_bloch, 0.2, 1, "x", law="C1",
    ),
    "Poisson": Problem(
        casimir.System(
            "x y z", [["1", "-1"], ["1"]], "sin(x) + sin(y) + sin(z)",
            ["0.5*(sin(x) + sin(y) + sin(z))"], damping=0.5,
        ),
        [-0.5, 0.5, 0.2], poisson, 0.5, 1, "x",
    ),
    "Kubo": Problem(
        casimir.System("q p", "canonical", "(q^2 + p^2)/2", ["0.5*(q^2 + p^2)/2"], damping=0.1),
        [1.0, 0.0], kubo, 0.1, 1, "q", law="H0",
    ),
    "heavy top": Problem(
        casimir.System(
            state=[f"{n}{i}" for n in "MG" for i in (1, 2, 3)],
            B=[
                ["0", "-M3", "M2", "0", "-G3", "G2"], ["M3", "0", "-M1", "G3", "0", "-G1"],
                ["-M2", "M1", "0", "-G2", "G1", "0"], ["0", "-G3", "G2", "0", "0", "0"],
                ["G3", "0", "-G1", "0", "0", "0"], ["-G2", "G1", "0", "0", "0", "0"],
            ],
            H0="M1^2/2 + 0.4*M2^2 + 0.9*M3^2 + G3", H=["0.5*M1", "0.7*G3"], damping=0.3,
        ),
        [0.2, 0.1, 1.0, 0.1, 0.2, 0.9], heavy_top, 0.3, 2, "G3", commutes=False, law="C1",
    ),
    "double well": Problem(
        casimir.System("q p", "canonical", "p^2/2 + (q^2 - 1)^2", ["0.9*q"], damping=0.5),
        [1.0, 0.3], bath, 0.5, 1, "q^2", additive=True,
    ),
}
