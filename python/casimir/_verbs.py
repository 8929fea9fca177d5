"""Verbs of a scene; `declared.rs` of the tests of `casimir-cli` writes this file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from ._formulas import finite, whole
from ._progress import How, how
from ._results import Comparison, Expectation, Inspection, Order, Result

R = TypeVar("R", bound=Result)


class Verbs:
    """Verbs of a scene. Arguments other than the named ones change the scene as ``with_`` does;
    ``threads`` changes the time, and no bit of the results."""

    __slots__ = ()

    def _called(
        self,
        result: Callable[..., R],
        verb: str,
        options: Mapping[str, Any],
        changes: Mapping[str, Any],
        how: How,
        raises: bool = False,
    ) -> R:
        raise NotImplementedError

    def inspect(
        self,
        *,
        threads: int | None = None,
        progress: bool = True,
        **changes: Any,
    ) -> Inspection:
        """Inspects the system of a scene, whose scheme is not asked for."""
        options: Mapping[str, Any] = {}
        return self._called(Inspection, "inspect", options, changes, how(threads, progress))

    def expect(
        self,
        *,
        coarsest_steps: int | None = None,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        **changes: Any,
    ) -> Expectation:
        """Expectations E[φ(y(T))] with 95 % intervals: ``expect(of=["y1"], accuracy=1e-4)``.

        ``coarsest_steps``: Steps of the coarsest level. Default: chosen with the scheme; about
        eight in a unit of time for a scheme that is named, and with events or integrals.
        """
        options: Mapping[str, Any] = {
            "coarsest_steps": None if coarsest_steps is None else whole("coarsest_steps", coarsest_steps),
        }
        return self._called(Expectation, "expect", options, changes, how(threads, progress), raises)

    def equilibrium(
        self,
        *,
        chains: int = 256,
        path_steps: float = 1e10,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        **changes: Any,
    ) -> Expectation:
        """Averages over the stationary law with 95 % intervals that include the step error:
        ``equilibrium(of=["q^2"], accuracy=1e-3)``. Autocorrelation times, burn-in and histograms
        are in its JSON.

        ``chains``: Number of chains.

        ``path_steps``: Maximum number of path-steps.
        """
        options: Mapping[str, Any] = {
            "chains": whole("chains", chains),
            "path_steps": whole("path_steps", path_steps),
        }
        return self._called(Expectation, "equilibrium", options, changes, how(threads, progress), raises)

    def lyapunov(
        self,
        *,
        accuracy: float = 0.01,
        chains: int = 256,
        count: int = 1,
        path_steps: float = 1e10,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        **changes: Any,
    ) -> Expectation:
        """The largest Lyapunov exponents ``"λ1"``, … and ``"their sum"``, with 95 % intervals.

        ``accuracy``: Half-width of the 95 % intervals.

        ``chains``: Number of chains.

        ``count``: Number of exponents, from the largest on.

        ``path_steps``: Maximum number of path-steps.
        """
        options: Mapping[str, Any] = {
            "accuracy": finite("accuracy", accuracy, above=0),
            "chains": whole("chains", chains),
            "count": whole("count", count),
            "path_steps": whole("path_steps", path_steps),
        }
        return self._called(Expectation, "lyapunov", options, changes, how(threads, progress), raises)

    def order(
        self,
        *,
        path_steps: float = 3e8,
        threads: int | None = None,
        progress: bool = True,
        **changes: Any,
    ) -> Order:
        """The strong and the weak order of the scheme of a scene.

        ``path_steps``: Path-steps that each measurement may take.
        """
        options: Mapping[str, Any] = {
            "path_steps": whole("path_steps", path_steps),
        }
        return self._called(Order, "order", options, changes, how(threads, progress))

    def compare(
        self,
        *,
        budget: float = 60.0,
        error: float = 0.001,
        threads: int | None = None,
        progress: bool = True,
        **changes: Any,
    ) -> Comparison:
        """Error against cost of all schemes, and the cheapest one for an error of y(T).

        ``budget``: Seconds that it may take.

        ``error``: The wanted root-mean-square error of y(T).
        """
        options: Mapping[str, Any] = {
            "budget": finite("budget", budget, above=0),
            "error": finite("error", error, above=0),
        }
        return self._called(Comparison, "compare", options, changes, how(threads, progress))
