"""Expectations, fits, orders: numbers with intervals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._errors import SceneError
from ._results import Result, Warning, imported, number_or_none, table
from ._run import band

if TYPE_CHECKING:
    from ._core import _Found
    from ._scene import Scene

Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """An expectation."""

    value: float
    lo: float
    """The lower end of the 95 % interval, which has the bias in it."""
    hi: float
    """The upper end."""
    half_width: float

    @property
    def interval(self) -> tuple[float, float]:
        """The ends of the 95 % interval."""
        return self.lo, self.hi


def _estimate(one: Any) -> Estimate:
    values = (one[key] for key in ("value", "lo", "hi", "half_width"))
    return Estimate(*(np.nan if value is None else float(value) for value in values))


class Expectation(Result, Mapping[str, Estimate]):
    """Expectations by name, each with its 95 % interval."""

    gradient: dict[str | tuple[str, str], Estimate]
    """Derivatives: ``gradient["q", "sigma"]`` is ∂E[q]/∂sigma, and so is ``gradient["sigma"]``
    if nothing but q is expected."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        Result.__init__(self, scene, found)

        self._estimates = {str(one["of"]): _estimate(one) for one in self.data["estimates"]}
        names = list(self._estimates)
        self.gradient = {}
        for parameter, estimates in self.data.get("gradient", {}).items():
            for name, one in zip(names, estimates, strict=True):
                self.gradient[name, parameter] = _estimate(one)
                if len(names) == 1:
                    self.gradient[parameter] = _estimate(one)

    @property
    def reached(self) -> bool:
        """Whether all intervals are as narrow as was wanted."""
        return bool(self.data["reached"])

    @property
    def scheme(self) -> str:
        """The scheme."""
        return str(self.data["scheme"])

    def __getitem__(self, name: str) -> Estimate:
        try:
            return self._estimates[name]
        except KeyError:
            known = ", ".join(self._estimates)
            raise KeyError(f"{name!r} is not expected; there are {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._estimates)

    def __len__(self) -> int:
        return len(self._estimates)

    def to_pandas(self) -> Any:
        """A table of pandas with a row for each."""
        pandas = imported("pandas")
        return pandas.DataFrame.from_dict(self._estimates, "index", columns=Estimate._fields)

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """A figure by its name, or all; with Matplotlib's ``ax`` the values with their intervals."""
        if ax is None:
            return super().plot(name)
        chosen = self._estimates if name is None else {name: self[name]}
        values = [one.value for one in chosen.values()]
        ax.errorbar(list(chosen), values, [one.half_width for one in chosen.values()], fmt="o")
        return ax


class Estimates(NamedTuple):
    """Expectations at each combination of the values of parameters, which are the axes."""

    value: Array
    lo: Array
    """The lower ends of the 95 % intervals, which have the bias in them."""
    hi: Array
    """The upper ends."""
    half_width: Array


class ExpectationSweep(Mapping[str, Estimates]):
    """Expectations at every combination of the values of parameters: ``found["q"]`` has arrays with
    an axis for each parameter, NaN where an interrupt came before."""

    scene: Scene
    """The scene whose parameters are varied."""
    parameters: dict[str, Array]
    """The values of each parameter."""
    results: list[Expectation | None]
    """The result at each combination; the last parameter changes fastest."""

    def __init__(
        self, scene: Scene, parameters: dict[str, Array], results: list[Expectation | None]
    ) -> None:
        self.scene, self.parameters, self.results = scene, parameters, results

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of values of each parameter."""
        return tuple(map(len, self.parameters.values()))

    @property
    def reached(self) -> bool:
        """Whether all intervals are as narrow as was wanted."""
        return all(one is not None and one.reached for one in self.results)

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl-C ended it early."""
        return any(one is None or one.interrupted for one in self.results)

    @property
    def warnings(self) -> list[Warning]:
        """What a reader must know, of all results."""
        return [warning for one in self.results if one is not None for warning in one.warnings]

    def __getitem__(self, name: str) -> Estimates:
        unknown = Estimate(*[np.nan] * 4)
        rows = [unknown if one is None else one[name] for one in self.results]
        arrays = np.array(rows, dtype=np.float64).T.reshape(4, *self.shape)
        return Estimates(*arrays)

    def __iter__(self) -> Iterator[str]:
        return iter(next((one for one in self.results if one is not None), {}))

    def __len__(self) -> int:
        return len(list(iter(self)))

    def to_pandas(self) -> Any:
        """A table of pandas with a row for each function and combination."""
        pandas = imported("pandas")
        mesh = np.meshgrid(*self.parameters.values(), indexing="ij")
        places = {one: values.ravel() for one, values in zip(self.parameters, mesh, strict=True)}
        tables = [
            {"observable": name, **places} | {k: np.ravel(v) for k, v in self[name]._asdict().items()}
            for name in self
        ]
        return pandas.concat(map(pandas.DataFrame, tables), ignore_index=True)

    def to_xarray(self) -> Any:
        """A dataset of xarray with the parameters as dimensions: ``q``, ``q lo`` and ``q hi``."""
        variables = {}
        for name in self:
            for what, array in [("", self[name].value), (" lo", self[name].lo), (" hi", self[name].hi)]:
                variables[name + what] = (tuple(self.parameters), array)
        return imported("xarray").Dataset(variables, self.parameters)

    def plot(self, name: str, *, ax: Any) -> Any:
        """The values with their intervals on Matplotlib's ``ax``, against the parameter with most
        values, a line for each of the others."""
        names = list(self.parameters)
        against = max(names, key=lambda one: len(self.parameters[one]))
        place, order = names.index(against), np.argsort(self.parameters[against])
        names.remove(against)
        found = [np.moveaxis(np.asarray(one), place, -1)[..., order] for one in self[name][:3]]
        for at in np.ndindex(found[0].shape[:-1]):
            values = [f"{one} = {self.parameters[one][k]:g}" for k, one in zip(at, names, strict=True)]
            label = ", ".join(values) or name
            band(ax, self.parameters[against][order], [one[at] for one in found], label)
        ax.set_xlabel(against)
        ax.set_ylabel(name)
        return ax

    def __repr__(self) -> str:
        lines = ["  ".join([*self.parameters, *(f"{name} ± half-width" for name in self)])]
        for place, one in zip(np.ndindex(self.shape), self.results, strict=True):
            values = zip(place, self.parameters.values(), strict=True)
            cells = [f"{of[k]:g}" for k, of in values]
            cells += [f"{e.value:.6g} ± {e.half_width:.1g}" for e in (one or {}).values()]
            lines.append("  ".join(cells))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return table(repr(self))


class Fit(Result):
    """Parameters that were fitted to data, each with its 95 % interval."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        super().__init__(scene, found)

        self.parameters = {str(one["name"]): _estimate(one) for one in self.data["parameters"]}
        self.covariance = np.array(self.data["covariance"], dtype=np.float64)
        """The covariance of the parameters, in their order."""

    @property
    def reached(self) -> bool:
        """Whether nothing speaks against the fit."""
        return bool(self.data["reached"])

    @property
    def chi2(self) -> float:
        """χ² of the moments."""
        return float(self.data["chi_square"])

    @property
    def degrees(self) -> int:
        """Degrees of freedom of χ²."""
        return int(self.data["degrees"])

    @property
    def probability(self) -> float | None:
        """Probability of a larger χ² if the model is right; ``None`` without degrees of freedom."""
        return number_or_none(self.data["probability"])

    def to_pandas(self) -> Any:
        """A table of pandas: the moments of the data and of the fit."""
        return imported("pandas").DataFrame(self.data["moments"])


class Measured(Result):
    """Errors at several step sizes."""

    def to_pandas(self) -> Any:
        """A table of pandas with a row for each quantity and step size: the difference to the next
        one with its 95 % interval."""
        rows = [
            {"kind": kind, "quantity": one["quantity"], "tau": point["tau"], "difference": point["value"]}
            | {"lo": point["lo"], "hi": point["hi"]}
            for kind in ("strong", "weak")
            for one in _listed(self.data.get(kind))
            for point in one["points"]
        ]
        return imported("pandas").DataFrame(rows)

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """A figure by its name, or all; with Matplotlib's ``ax`` the sizes of the differences between
        step sizes, ``"strong"``, ``"weak"`` or both."""
        if ax is None:
            return super().plot(name)
        if name not in (None, "strong", "weak"):
            raise SceneError(f"errors are 'strong' or 'weak', got {name!r}")
        for kind in ("strong", "weak") if name is None else (name,):
            for one in _listed(self.data.get(kind)):
                tau = [point["tau"] for point in one["points"]]
                size = [abs(point["value"]) for point in one["points"]]
                ax.loglog(tau, size, "o-", label=f"{kind}: {one['quantity']}")
        ax.set_xlabel("step")
        return ax


def _listed(one: Any) -> list[Any]:
    return one if isinstance(one, list) else [] if one is None else [one]


class Order(Measured):
    """Orders of a scheme; ``strong`` and ``weak`` are ``None`` where none can be named."""

    @property
    def strong(self) -> float | None:
        """The strong order."""
        return number_or_none(self.data["strong"]["order"])

    @property
    def weak(self) -> dict[str, float | None]:
        """The weak order of each function."""
        return {str(one["quantity"]): number_or_none(one["order"]) for one in self.data["weak"]}

    @property
    def scheme(self) -> str:
        """The scheme."""
        return str(self.data["scheme"])


class Comparison(Result):
    """Errors and costs of all schemes."""

    def to_pandas(self) -> Any:
        """A table of pandas with a row for each scheme and number of steps: the root-mean-square error
        with its 95 % interval, and the seconds of a path."""
        rows = [
            {"scheme": one["scheme"], "steps": point["steps"], "error": point["error"]}
            | {"lo": point["lo"], "hi": point["hi"], "seconds": point["time"]["median"]}
            for one in self.data["candidates"]
            for point in one["points"]
        ]
        return imported("pandas").DataFrame(rows)

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """A figure by its name, or all; with Matplotlib's ``ax`` errors against seconds of a path, of
        the scheme ``name`` or of all."""
        if ax is None:
            return super().plot(name)
        frame = self.to_pandas()
        for scheme, rows in frame.groupby("scheme", sort=False):
            if name in (None, scheme):
                ax.loglog(rows["seconds"], rows["error"], "o-", label=scheme)
        ax.set_xlabel("seconds of a path")
        ax.set_ylabel("error of y(T)")
        return ax


class Inspection(Result):
    """What a system is."""
