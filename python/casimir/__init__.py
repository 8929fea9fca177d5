"""Structure-preserving simulation of damped stochastic Poisson systems.

dy = (B(y)∇H0(y) − γ(t) y) dt + Σ B(y)∇Hm(y) ∘ dWm in the sense of Stratonovich, with B antisymmetric.

>>> import casimir
>>> paths = casimir.scene("rigid-body").run(paths=2, steps=64)
>>> paths["y1"].shape
(2, 65)
"""

from ._core import __version__
from ._doctor import doctor
from ._errors import RunError, SceneError
from ._estimates import (
    Comparison,
    Estimate,
    Estimates,
    Expectation,
    ExpectationSweep,
    Fit,
    Inspection,
    Order,
)
from ._parts import Part, PartResult, merge
from ._referee import Level, Referee, Report, Seeds, one_step, verify_seeds
from ._results import Figure, Warning, citation
from ._run import Histogram, Run, Statistics, load
from ._scene import Scene, Sweep, scene, scenes, sweep
from ._system import System

__all__ = [
    "Comparison",
    "Estimate",
    "Estimates",
    "Expectation",
    "ExpectationSweep",
    "Figure",
    "Fit",
    "Histogram",
    "Inspection",
    "Level",
    "Order",
    "Part",
    "PartResult",
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
    "doctor",
    "load",
    "merge",
    "one_step",
    "scene",
    "scenes",
    "sweep",
    "verify_seeds",
]
