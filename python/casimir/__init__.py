"""Structure-preserving simulation of damped stochastic Poisson systems.

dy = (B(y)∇H0(y) − γ(t) y) dt + Σ B(y)∇Hm(y) ∘ dWm in the sense of Stratonovich, with B antisymmetric.

>>> import casimir
>>> paths = casimir.scene("rigid-body").run(paths=2, steps=64)
>>> paths["y1"].shape
(2, 65)
"""

from ._core import __version__
from ._errors import RunError, SceneError
from ._referee import Level, Referee, Report, Seeds, one_step, verify_seeds
from ._results import (
    Comparison,
    Estimate,
    Expectation,
    Figure,
    Fit,
    Inspection,
    Order,
    Run,
    Statistics,
    Warning,
    citation,
)
from ._scene import Scene, Sweep, scene, scenes, sweep
from ._system import System

__all__ = [
    "Comparison",
    "Estimate",
    "Expectation",
    "Figure",
    "Fit",
    "Inspection",
    "Level",
    "Order",
    "Referee",
    "Report",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Seeds",
    "Statistics",
    "Sweep",
    "System",
    "Warning",
    "__version__",
    "citation",
    "one_step",
    "scene",
    "scenes",
    "sweep",
    "verify_seeds",
]
