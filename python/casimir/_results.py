"""What was found: arrays with names, text, figures."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import __version__
from ._errors import SceneError, missing

if TYPE_CHECKING:
    from ._core import _Found
    from ._scene import Scene

Array = NDArray[np.float64]


class Figure:
    """A drawing, shown by notebooks."""

    def __init__(self, name: str, svg: str, caption: str) -> None:
        self.name, self.svg, self.caption = name, svg, caption

    def save(self, file: str | PathLike[str]) -> None:
        """Writes it as SVG."""
        if Path(file).suffix != ".svg":
            raise SceneError(f"{file}: figures are written as .svg; plot(…, ax=ax) draws elsewhere")
        Path(file).write_text(self.svg, encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Figure {self.name}: {self.caption}"


class Figures(Mapping[str, Figure]):
    """All figures by the names of their files, shown one after the other by notebooks. ``time-a/b``
    is found by this name, too."""

    def __init__(self, figures: list[tuple[str, str, str, str]]) -> None:
        self._figures = {one[0]: Figure(*one[:3]) for one in figures}
        self._files = {one[3]: one[0] for one in figures}

    def __getitem__(self, name: str) -> Figure:
        name = self._files.get(name, name)
        if name in self._figures:
            return self._figures[name]
        raise KeyError(f"no figure {name!r}; there are {', '.join(self._figures)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def _repr_html_(self) -> str:
        return "".join(
            f"<figure>{one.svg}<figcaption>{html.escape(one.caption)}</figcaption></figure>"
            for one in self._figures.values()
        )

    def __repr__(self) -> str:
        return f"figures: {', '.join(self._figures)}"


class Warning(NamedTuple):
    """Something that a reader of a result must know; ``str()`` is the sentence that is printed."""

    what: str
    why: str
    """Evidence; may be empty."""
    remedy: str
    """What would help; may be empty."""

    def __str__(self) -> str:
        why, remedy = self.why and f": {self.why}", self.remedy and f"; {self.remedy}"
        return f"{self.what}{why}{remedy}"


class Result:
    """What every command gives: the program's words, its JSON as ``data``, figures."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        self.scene = scene
        self.text = found["text"].rstrip("\n")
        self.data: dict[str, Any] = json.loads(found["json"])
        self.figures = Figures(found["figures"])
        self.version = __version__
        self.seed = int(scene._check()["seed"])
        self.interrupted = found["interrupted"]

    @property
    def warnings(self) -> list[Warning]:
        """What a reader must know."""
        return [Warning(**one) for one in self.data["warnings"]]

    def plot(self, name: str | None = None) -> Any:
        """One :class:`Figure` by its name, or all."""
        return self.figures if name is None else self.figures[name]

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return _table(self.text)


def citation(result: Result | None = None) -> str:
    """BibTeX of what a result used: the software, the paper and methods. Without one, of all."""
    if not isinstance(result, Result | None):
        raise TypeError(f"what to cite is known of results, not of {type(result).__name__}")
    return _core.citation(None if result is None else json.dumps(result.data))


def _table(text: str) -> str:
    """A text whose columns stand two blanks apart as HTML."""
    parts, rows = [], list[str]()

    def close() -> None:
        if rows:
            parts.append(f"<table>{''.join(rows)}</table>")
            rows.clear()

    for line in text.splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if len(cells) < 3:
            close()
            parts.append(f"<div>{html.escape(line)}</div>")
            continue
        kind = "td" if rows else "th"
        rows.append("<tr>" + "".join(f"<{kind}>{html.escape(c)}</{kind}>" for c in cells) + "</tr>")
    close()
    return "".join(parts)


class Statistics(NamedTuple):
    """The law of an observable in time; of sweeps with an axis for each parameter before."""

    mean: Array
    lo: Array
    """The lower end of the 95 % interval of the mean."""
    hi: Array
    """The upper end."""
    deviation: Array
    median: Array
    quantiles: Array | None
    """[time, level], at the levels ``quantile_levels`` of the run."""
    variance: Array
    least: Array
    largest: Array

    def _alone(self) -> dict[str, Array]:
        """All but the quantiles."""
        return {what: array for what, array in self._asdict().items() if what != "quantiles"}


class _Named(dict[str, Statistics]):
    """A dictionary that says which names it has."""

    def __init__(self, what: str) -> None:
        super().__init__()
        self._what = what

    def __missing__(self, name: str) -> Statistics:
        there = ", ".join(self) or "none: there are fewer than 100 paths"
        raise KeyError(f"{name!r} is none of the {self._what}; there are {there}")

    def __reduce__(self) -> tuple[Any, ...]:
        return _Named, (self._what,), None, None, iter(self.items())


class Run(Result):
    """Paths and their statistics.

    ``run["q"]`` is an array [path, time] of the paths whose tables are kept, at the times ``run.t``;
    ``run.statistics["q"]`` is the law of all paths, if they are 100 or more. An autocorrelation,
    ``run.statistics["autocorrelation(q)"]``, is at the lags ``run.lag``, a spectrum at the angular
    frequencies ``run.omega``.
    """

    def __init__(self, scene: Scene, found: _Found, varied: dict[str, Array]) -> None:
        super().__init__(scene, found)
        self.page = found["page"]
        self.parameters = varied
        paths, statistics = found["paths"], found["statistics"]
        self._arrays = (paths, statistics)
        self.t: Array = statistics["t"] if "t" in statistics else paths.get("t", np.empty(0))
        self.paths: dict[str, Array] = {k: v for k, v in paths.items() if k != "t"}
        self.lag: Array = statistics.get("lag", np.empty(0))
        self.omega: Array = statistics.get("omega", np.empty(0))
        self.quantile_levels: Array | None = statistics.get("quantile levels")
        self.statistics: dict[str, Statistics] = _Named("observables with statistics")
        for key in statistics:
            name = key.removesuffix(" mean")
            if name != key:
                arrays = {what: statistics.get(f"{name} {what}") for what in Statistics._fields}
                self.statistics[name] = Statistics(**arrays)  # type: ignore[arg-type]
        self.joint: dict[str, Array] = {k: v for k, v in statistics.items() if k.startswith("joint(")}

    @property
    def arrays(self) -> dict[str, Array]:
        """All arrays by the names that they have in the program's files of the format npz."""
        return {**self._arrays[0], **self._arrays[1]}

    def axis(self, name: str) -> str:
        """What an observable with statistics is against: ``"t"``, ``"lag"`` or ``"omega"``."""
        kinds = {"autocorrelation(": "lag", "spectrum(": "omega"}
        found = [axis for kind, axis in kinds.items() if name.startswith(kind) and axis in self.arrays]
        return found[0] if found else "t"

    @property
    def scheme(self) -> str:
        """The scheme."""
        return str(self.data.get("scheme") or self.data["runs"][0]["scheme"])

    @property
    def initial(self) -> Array:
        """Where the paths whose tables are kept began: [path, component]."""
        if self.parameters:
            raise AttributeError("a sweep keeps no paths: run one combination")
        names = [name for name in self.scene.components if name in self.paths]
        if "spins" in self.paths:
            return self.paths["spins"][:, 0].reshape(len(self.paths["spins"]), -1)
        return np.stack([self.paths[name][:, 0] for name in names], axis=1)

    def keys(self) -> Any:
        """The names of the columns of paths."""
        return self.paths.keys()

    def __contains__(self, name: object) -> bool:
        return name in self.paths

    def __iter__(self) -> Iterator[str]:
        return iter(self.paths)

    def __getitem__(self, name: str) -> Array:
        try:
            return self.paths[name]
        except KeyError:
            known = ", ".join(self.paths) or "none: a sweep has statistics"
            raise KeyError(f"no column {name!r} of paths; there are {known}") from None

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """A figure of ``run.figures`` by its name or by an observable, or all of them.

        With Matplotlib's ``ax``, an observable is drawn there: the mean with its band between the
        quantiles 5 % and 95 %, or the paths; of a sweep the mean at the end with its 95 % interval.
        Autocorrelations and spectra are drawn with their 95 % intervals.
        """
        if ax is None:
            in_time = f"time-{name}"
            return super().plot(in_time if in_time in self.figures else name)
        if name is None:
            raise SceneError("name an observable to draw it on an axis: plot('q', ax=ax)")
        name = name.removeprefix("against-") if self.parameters else name
        law, against = self.statistics.get(name), self.axis(name)
        at = {"t": self.t, "lag": self.lag, "omega": self.omega}[against]
        if law is not None and against != "t":
            numbers = ", ".join(self.parameters)
            for place in np.ndindex(law.mean.shape[:-1]):
                chosen = zip(place, self.parameters.values(), strict=True)
                at_values = ", ".join(f"{values[k]:g}" for k, values in chosen)
                label = f"{numbers} = {at_values}" if numbers else name
                (line,) = ax.plot(at, law.mean[place], label=label)
                ax.fill_between(at, law.lo[place], law.hi[place], alpha=0.25, color=line.get_color())
            ax.set_xlabel(against)
            ax.set_ylabel(name)
            return ax
        if self.parameters and law is not None:
            if len(self.parameters) > 1:
                raise SceneError("a sweep of several parameters: draw `to_xarray()`")
            ((axis, values),) = self.parameters.items()
            order = np.argsort(values)
            mean, lo, hi = (array[order, -1] for array in (law.mean, law.lo, law.hi))
            (line,) = ax.plot(values[order], mean, ".-", label=f"mean of {name} at the end")
            color = line.get_color()
            ax.fill_between(values[order], lo, hi, alpha=0.25, color=color, label="95 % interval")
            ax.set_xlabel(axis)
            ax.set_ylabel(name)
            return ax
        if law is not None and law.quantiles is not None:
            (line,) = ax.plot(at, law.mean, label=f"mean of {name}")
            ends, color = (law.quantiles[:, 0], law.quantiles[:, -1]), line.get_color()
            ax.fill_between(at, *ends, alpha=0.25, color=color, label="5 % … 95 %")
        elif law is not None:
            ax.plot(at, law.mean, label=f"mean of {name}")
        else:
            ax.plot(at[: self[name].shape[1]], self[name].T)
        ax.set_xlabel("t")
        ax.set_ylabel(name)
        return ax

    def save(self, file: str | PathLike[str]) -> None:
        """Writes arrays as ``.npz``, or the report as ``.html``."""
        path = Path(file)
        if path.suffix == ".npz":
            np.savez(path, **self.arrays)  # type: ignore[arg-type]
        elif path.suffix == ".html":
            path.write_text(self.page, encoding="utf-8")
        else:
            raise SceneError(f"{path}: results are written as .npz or .html")

    def to_pandas(self, axis: str = "t") -> Any:
        """A table of pandas: of 100 paths or more and of sweeps the statistics, with a row for each
        observable and time; of fewer paths the paths, with a row for each path and time.

        Autocorrelations are in ``to_pandas("lag")``, spectra in ``to_pandas("omega")``; joint laws
        are arrays in ``joint``."""
        pandas = _imported("pandas")
        places_of = {"t": self.t, "lag": self.lag, "omega": self.omega}
        if axis not in places_of or (axis != "t" and axis not in self.arrays):
            there = " or ".join(repr(one) for one in places_of if one == "t" or one in self.arrays)
            hint = "" if axis not in places_of else ": add statistics={'autocorrelation': […]}"
            raise SceneError(f"a table is against {there}, not against {axis!r}{hint}")
        if self.statistics:
            mesh = np.meshgrid(*self.parameters.values(), places_of[axis], indexing="ij")
            tables = []
            for name, law in self.statistics.items():
                if self.axis(name) != axis:
                    continue
                places = zip([*self.parameters, axis], mesh, strict=True)
                columns = {"observable": name, **{axis: m.ravel() for axis, m in places}}
                columns |= {what: array.ravel() for what, array in law._alone().items()}
                if law.quantiles is not None and self.quantile_levels is not None:
                    levels = enumerate(self.quantile_levels)
                    columns |= {f"q{level:g}": law.quantiles[..., k].ravel() for k, level in levels}
                tables.append(pandas.DataFrame(columns))
            return pandas.concat(tables, ignore_index=True)
        paths = {name: a.ravel() for name, a in self.paths.items() if a.ndim == 2}
        if "spins" in self.paths:
            spins = self.paths["spins"].reshape(-1, len(self.scene.components))
            paths.update(zip(self.scene.components, spins.T, strict=True))
        number = len(next(iter(self.paths.values())))
        index = pandas.MultiIndex.from_product([range(number), self.t], names=["path", "t"])
        return pandas.DataFrame(paths, index=index)

    def to_xarray(self) -> Any:
        """A dataset of xarray with dimensions path, t, lag, omega, quantile and the parameters of a
        sweep. Joint laws are arrays in ``joint``."""
        xarray = _imported("xarray")
        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {"t": self.t, **self.parameters}
        coordinates |= {axis: self.arrays[axis] for axis in ("lag", "omega") if axis in self.arrays}
        for name, array in self.paths.items():
            dims = ("path", "t", "spin", "axis")[: array.ndim]
            # Paths that were interrupted have fewer times.
            short = len(self.t) - array.shape[1]
            widths = [(0, 0), (0, short), *[(0, 0)] * (array.ndim - 2)]
            variables[name] = (dims, np.pad(array, widths, constant_values=np.nan) if short else array)
        for name, law in self.statistics.items():
            dims = (*self.parameters, self.axis(name))
            for what, array in law._alone().items():
                variables[f"{name} {what}"] = (dims, array)
            if law.quantiles is not None:
                variables[f"{name} quantiles"] = ((*dims, "quantile"), law.quantiles)
                coordinates["quantile"] = self.quantile_levels
        attributes = {"seed": self.seed, "version": self.version, "scheme": self.scheme}
        attributes["scene"] = self.scene.to_toml()
        return xarray.Dataset(variables, coordinates, attributes)


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


class Expectation(Result, Mapping[str, Estimate]):
    """Expectations by name, each with its 95 % interval."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        Result.__init__(self, scene, found)

        def estimate(one: Any) -> Estimate:
            return Estimate(*(float(one[key]) for key in ("value", "lo", "hi", "half_width")))

        self._estimates = {str(one["of"]): estimate(one) for one in self.data["estimates"]}
        names = list(self._estimates)
        self.gradient: dict[str | tuple[str, str], Estimate] = {}
        """Derivatives: ``gradient["q", "sigma"]`` is ∂E[q]/∂sigma, and so is ``gradient["sigma"]``
        if nothing but q is expected."""
        for parameter, estimates in self.data.get("gradient", {}).items():
            for name, one in zip(names, estimates, strict=True):
                self.gradient[name, parameter] = estimate(one)
                if len(names) == 1:
                    self.gradient[parameter] = estimate(one)

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
        pandas = _imported("pandas")
        return pandas.DataFrame.from_dict(self._estimates, "index", columns=Estimate._fields)


class Fit(Result):
    """Parameters that were fitted to data, each with its 95 % interval."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        super().__init__(scene, found)

        def estimate(one: Any) -> Estimate:
            return Estimate(*(float(one[key]) for key in ("value", "lo", "hi", "half_width")))

        self.parameters = {str(one["name"]): estimate(one) for one in self.data["parameters"]}
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
        return _number(self.data["probability"])

    def to_pandas(self) -> Any:
        """A table of pandas: the moments of the data and of the fit."""
        return _imported("pandas").DataFrame(self.data["moments"])


class Order(Result):
    """Orders of a scheme; ``strong`` and ``weak`` are ``None`` where none can be named."""

    @property
    def strong(self) -> float | None:
        """The strong order."""
        return _number(self.data["strong"]["order"])

    @property
    def weak(self) -> dict[str, float | None]:
        """The weak order of each function."""
        return {str(one["quantity"]): _number(one["order"]) for one in self.data["weak"]}

    @property
    def scheme(self) -> str:
        """The scheme."""
        return str(self.data["scheme"])


class Comparison(Result):
    """Errors and costs of all schemes."""


class Inspection(Result):
    """What a system is."""


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _imported(package: str) -> Any:
    import importlib

    try:
        return importlib.import_module(package)
    except ImportError as error:
        if error.name != package:
            raise
        raise missing(package, "this") from error
