"""Keys of scenes as keyword arguments."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, SupportsFloat, SupportsIndex, TypedDict, TypeVar

C = TypeVar("C", bound=type)


# Keys: the test `declared` of the program writes these.
class _Others(TypedDict, total=False):
    columns: Sequence[Any] | str | None
    """The columns of tables: names of components, observables and laws, ``components`` for all of
    them, ``laws`` likewise. Default: all, but not more than twelve components."""
    paths: SupportsFloat | None
    """Number of paths. From 100 on means, quantiles and histograms are computed, below that
    tables of all paths. Default: 1."""
    scheme: str | None
    """The scheme: ``auto`` (one that damps exactly and keeps Casimirs and energy), ``sexp``,
    ``sexp-li``, ``split``, ``split-h``, ``sexp-h``, ``sexp-levy``, ``sexp-li-levy``, ``nv``,
    ``baoab``, ``midpoint``, ``heun``, ``heun-levy`` or ``em``. Default: ``auto``."""
    seed: SupportsIndex | str | None
    """Seed of the random numbers: the same seed gives the same bits. Default: 1."""
    snapshots: SupportsFloat | None
    """Number of snapshots of a large lattice after the start, evenly spaced, with correlations
    and structure factors; it divides the number of saved times. Default: 1, the end."""
    tables: SupportsFloat | None
    """Number of paths of which tables are kept beside the statistics. Default: 3."""
    times: SupportsFloat | None
    """Number of saved times, evenly spaced; it divides the number of steps. Default: the largest
    number up to 200 that does."""
    truncation: SupportsFloat | None
    """Order k of the truncation of increments, |ΔW| ≤ √(2kτ|ln τ|), for schemes that need one;
    the step τ must be below 1 then. Default: 4, and never fewer than six deviations."""
    gradient: Sequence[Any] | str | None
    """Parameters θ for the derivatives of all expectations."""
    of: Sequence[Any] | str | None
    """Functions φ: names of components or observables, or formulas."""
    bath: Any
    """A heat bath; or several, each at its temperature, by ``[[bath]]``. Default: none."""
    damping: Any
    """Linear damping −γ(t)y. Default: none."""
    events: Mapping[str, Any] | None
    """Events of a path, by name: the condition when one happens, ``"q > 2"``, or a table of
    ``when`` and ``stop``. An observable of this name is one from then on, ``… time`` is the
    time of the event."""
    expect: Mapping[str, Any] | None
    """Expectations for ``casimir expect``."""
    figures: Mapping[str, Any] | None
    """The figures that are drawn, and their axes."""
    fit: Mapping[str, Any] | None
    """Parameters that ``casimir fit`` finds."""
    observe: Mapping[str, Any] | None
    """Functions of the state that are of interest, by name."""
    probabilities: Mapping[str, Any] | None
    """Conditions whose probabilities in time are of interest, by name."""
    run: Mapping[str, Any] | None
    """Settings of the simulation."""
    statistics: Mapping[str, Any] | None
    """Statistics of how observables depend on each other and on their past."""
    sweep: Mapping[str, Any] | None
    """Values of parameters that are varied, with an answer for each combination: a list, or
    ``"from:to:number"``."""
    system: Mapping[str, Any] | None
    """The system to simulate."""
    title: str | None
    """Title of reports. Default: the name of the system or of the file."""


class _Accuracy(TypedDict, total=False):
    accuracy: SupportsFloat | None
    """Half-width of the 95 % intervals."""


class _Parameters(TypedDict, total=False):
    parameters: Mapping[Any, Any] | None
    """Values of names in formulas, changed one by one."""


class _Span(TypedDict, total=False):
    initial: Any
    """The initial value y(0): a number or a formula of the parameters for each component, and of
    random numbers: z1, z2, … are standard normals, u1, u2, … uniform on (0, 1). For spins on a
    lattice three may stand for all, and depend on the place x, y, z of a spin. Or the name of
    a file of states, one in a line: paths take them in turn."""
    steps: SupportsFloat | None
    """Number of steps on [0, T]."""
    until: Any
    """The final time T > 0; paths begin at time 0."""
# Keys: the test `declared` of the program writes these.


class Changes(_Others, _Accuracy, _Parameters, _Span, total=False):
    """All keys that change a scene; ``None`` removes one."""


class ChangesBesideAccuracy(_Others, _Parameters, _Span, total=False):
    """All but the accuracy."""


class ChangesBesideParameters(_Others, _Accuracy, _Span, total=False):
    """All but the parameters."""


class ChangesBesideSpan(_Others, _Accuracy, _Parameters, total=False):
    """All but the initial value and the time."""


class HowArguments(TypedDict, total=False):
    """How a call is made."""

    threads: int | None
    progress: bool
    raises: bool
    resume: str | PathLike[str] | None


class ExpectOptions(Changes, total=False):
    """Arguments of ``expect``."""

    coarsest_steps: int | None


class EquilibriumOptions(Changes, total=False):
    """Arguments of ``equilibrium``."""

    chains: int
    path_steps: float


class LyapunovOptions(Changes, total=False):
    """Arguments of ``lyapunov``."""

    chains: int
    count: int
    path_steps: float


class ExpectArguments(ExpectOptions, HowArguments, total=False):
    """All arguments of ``expect``."""


class EquilibriumArguments(EquilibriumOptions, HowArguments, total=False):
    """All arguments of ``equilibrium``."""


class LyapunovArguments(LyapunovOptions, HowArguments, total=False):
    """All arguments of ``lyapunov``."""


# Names of the arguments that change no scene.
OPTIONS = {
    "run": frozenset[str](),
    "expect": frozenset({"coarsest_steps"}),
    "equilibrium": frozenset({"chains", "path_steps"}),
    "lyapunov": frozenset({"accuracy", "chains", "count", "path_steps"}),
}


class _Unchanged:
    def __repr__(self) -> str:
        return "…"


_UNCHANGED = _Unchanged()


def explicit(cls: C) -> C:
    """Shows the keys that methods take in their signatures, for help and for completion."""
    for method in vars(cls).values():
        signature = inspect.signature(method) if inspect.isfunction(method) else None
        own = [*signature.parameters.values()] if signature else []
        kind = own[-1].annotation if own and own[-1].kind is inspect.Parameter.VAR_KEYWORD else ""
        if signature and "Changes" in str(kind):
            taken = {one.name for one in own}
            of = {name: getattr(of, "__forward_arg__", of) for name, of in Changes.__annotations__.items()}
            keys = {name: kind for name, kind in of.items() if name not in taken}
            more = [
                inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_UNCHANGED, annotation=of)
                for name, of in keys.items()
            ]
            method.__signature__ = signature.replace(parameters=[*own[:-1], *more])
    return cls
