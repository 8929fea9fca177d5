"""Paths and their statistics."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._errors import SceneError
from ._results import Result, imported

if TYPE_CHECKING:
    from ._core import _Found
    from ._scene import Scene

Array = NDArray[np.float64]

# The array of a file of ours that has no numbers: how the result was found.
_ABOUT = "casimir"


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
    variance_lo: Array
    """The lower end of the 95 % interval of the variance."""
    variance_hi: Array
    """The upper end."""
    least: Array
    largest: Array

    def _alone(self) -> dict[str, Array]:
        """All but the quantiles."""
        return {what: array for what, array in self._asdict().items() if what != "quantiles"}


class Histogram(NamedTuple):
    """The law of an observable at the end, as :func:`numpy.histogram` gives it; of sweeps with an
    axis for each parameter before."""

    counts: Array
    """Paths in each bin. A few may lie outside of all."""
    edges: Array


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


class Snapshots(Mapping[tuple[int, float], Array]):
    """The spins of a large lattice by path and time, each read from its file when it is asked for:
    an array [z, y, site of the cell, x, axis]."""

    def __init__(self, files: dict[tuple[int, float], Path]) -> None:
        self._files = files

    def __getitem__(self, key: tuple[int, float]) -> Array:
        if key not in self._files:
            there = ", ".join(map(str, self._files))
            raise KeyError(f"no snapshot {key}; there are {there or 'none'}")
        with np.load(self._files[key]) as arrays:
            return np.asarray(arrays["spins"])

    def __iter__(self) -> Iterator[tuple[int, float]]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)


class Run(Result):
    """Paths and their statistics.

    ``run["q"]`` is an array [path, time] of the paths whose tables are kept, at the times ``run.t``;
    ``run.statistics["q"]`` is the law of all paths, if they are 100 or more. An autocorrelation,
    ``run.statistics["autocorrelation(q)"]``, is at the lags ``run.lag``, a spectrum at the angular
    frequencies ``run.omega``.
    """

    page: str
    """The report as HTML."""
    parameters: dict[str, Array]
    """The values of the parameters that are varied: an axis of the statistics for each, in order."""
    t: Array
    """The times."""
    lag: Array
    """The lags of autocorrelations."""
    omega: Array
    """The angular frequencies of spectra."""
    paths: dict[str, Array]
    """The columns of the paths that are kept: [path, time], of spins [path, time, spin, axis]."""
    statistics: dict[str, Statistics]
    """The laws of the observables in time, from 100 paths on."""
    histograms: dict[str, Histogram]
    """The laws of the observables at the end, from 100 paths on."""
    joint: dict[str, Array]
    """Counts of pairs at the end, ``joint["joint(q, p)"]``, and the edges of the bins by the same
    name with ``" x"`` and ``" y"`` after it."""
    quantile_levels: Array | None
    """The levels of the quantiles."""

    def __init__(
        self, scene: Scene, found: _Found, varied: dict[str, Array], folder: str | None = None
    ) -> None:
        super().__init__(scene, found)
        self._folder = folder
        self._found = {key: found[key] for key in ("text", "json", "figures", "interrupted")}
        self.page = found["page"]
        self.parameters = varied
        paths, statistics = found["paths"], found["statistics"]
        self._arrays = (paths, statistics)
        self.t = statistics["t"] if "t" in statistics else paths.get("t", np.empty(0))
        self.paths = {k: v for k, v in paths.items() if k != "t"}
        self.lag = statistics.get("lag", np.empty(0))
        self.omega = statistics.get("omega", np.empty(0))
        self.quantile_levels = statistics.get("quantile levels")
        self.statistics, self.histograms = _Named("observables with statistics"), {}
        for key in statistics:
            name = key.removesuffix(" mean")
            if name == key:
                continue
            fields = [(what, f"{name} {what.replace('_', ' ')}") for what in Statistics._fields]
            law = {what: statistics.get(key) for what, key in fields}
            self.statistics[name] = Statistics(**law)  # type: ignore[arg-type]
            if f"{name} histogram" in statistics:
                ends = statistics[f"{name} histogram"], statistics[f"{name} edges"]
                self.histograms[name] = Histogram(*ends)
        self.joint = {k: v for k, v in statistics.items() if k.startswith("joint(")}

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

    @property
    def snapshots(self) -> Snapshots:
        """The spins of a large lattice that ran with ``resume="folder"``, in whose files they are:
        ``run.snapshots[path, t]``. ``run(snapshots=8)`` asks for eight after the start."""
        if self._folder is None or self.parameters:
            raise SceneError(
                "snapshots are files of the folder of a large lattice: scene.run(resume='folder')"
            )
        steps: dict[int, dict[int, Path]] = {}
        for file in Path(self._folder).glob("spins-*-*.npz"):
            path, step = map(int, file.stem.split("-")[1:])
            steps.setdefault(path, {})[step] = file
        times = list(map(float, self._arrays[0].get("t of spectra", ())))
        files: dict[tuple[int, float], Path] = {}
        for path in sorted(steps):
            pairs = zip(times, sorted(steps[path].items()), strict=False)
            files.update(((path, t), file) for t, (_, file) in pairs)
        return Snapshots(files)

    @property
    def ends(self) -> dict[str, Array]:
        """The last values of each column, [path]: with ``times=1, tables=N`` those of N paths."""
        return {name: array[:, -1] for name, array in self.paths.items()}

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
        quantiles 5 % and 95 %, or the paths; of a sweep the mean at the end with its 95 % interval,
        against the parameter with most values, a line for each of the others. Autocorrelations and
        spectra are drawn with their 95 % intervals, joint laws as counts.
        """
        if ax is None:
            in_time = f"time-{name}"
            return super().plot(in_time if in_time in self.figures else name)
        if name is None:
            raise SceneError("name an observable to draw it on an axis: plot('q', ax=ax)")
        if name in self.joint:
            x, y = (self.joint[f"{name} {side}"] for side in "xy")
            ax.pcolormesh(x, y, self.joint[name].T)
            ax.set_title(name)
            return ax
        name = name.removeprefix("against-") if self.parameters else name
        law, against = self.statistics.get(name), self.axis(name)
        at = {"t": self.t, "lag": self.lag, "omega": self.omega}[against]
        if law is not None and (against != "t" or self.parameters):
            means = [law.mean, law.lo, law.hi]
            names = list(self.parameters)
            if against == "t":
                # The parameter with most values is the axis.
                against = max(names, key=lambda one: len(self.parameters[one]))
                order, place = np.argsort(self.parameters[against]), names.index(against)
                at = self.parameters[against][order]
                means = [np.moveaxis(array[..., -1], place, -1)[..., order] for array in means]
                names.remove(against)
                name = f"{name} at the end"
            for row in np.ndindex(means[0].shape[:-1]):
                chosen = zip(row, names, strict=True)
                values = [f"{one} = {self.parameters[one][k]:g}" for k, one in chosen]
                band(ax, at, [array[row] for array in means], ", ".join(values) or name)
        elif law is not None:
            (line,) = ax.plot(at, law.mean, label=f"mean of {name}")
            if law.quantiles is not None:
                ends, color = (law.quantiles[:, 0], law.quantiles[:, -1]), line.get_color()
                ax.fill_between(at, *ends, alpha=0.25, color=color, label="5 % … 95 %")
        else:
            ax.plot(at[: self[name].shape[1]], self[name].T)
        ax.set_xlabel(against)
        ax.set_ylabel(name)
        return ax

    def save(self, file: str | PathLike[str]) -> None:
        """Writes all of it as ``.npz``, which :func:`load` and :func:`numpy.load` read, or the report
        as ``.html``."""
        path = Path(file)
        if path.suffix == ".html":
            path.write_text(self.page, encoding="utf-8")
            return
        if path.suffix != ".npz":
            raise SceneError(f"{path}: results are written as .npz or .html")
        scene = {"text": self.scene.text, "name": self.scene.name}
        kept = [list(arrays) for arrays in self._arrays]
        about = {"found": self._found, "page": self.page, "scene": scene, "arrays": kept}
        about |= {"version": self.version, "varied": list(self.parameters)}
        own = {f"{_ABOUT} {name}": values for name, values in self.parameters.items()}
        if self.scene.states is not None:
            own[f"{_ABOUT} states"] = self.scene.states
        np.savez(path, **{_ABOUT: np.array(json.dumps(about))}, **own, **self.arrays)  # type: ignore[arg-type]

    def to_pandas(self, of: str = "t") -> Any:
        """A table of pandas: the statistics, with a row for each observable and time. Of fewer than
        100 paths there are mean, deviation, variance, least and largest value of those; the rest is
        NaN.

        ``of="path"`` is a table of the paths that are kept, with a row for each path and time;
        ``"lag"`` has autocorrelations, ``"omega"`` spectra, ``"end"`` histograms at the end, and
        ``"joint(q, p)"`` a joint law."""
        pandas = imported("pandas")
        if of == "path" and not self.parameters:
            paths = {name: array.ravel() for name, array in self._columns().items()}
            number, times = next(iter(self.paths.values())).shape[:2]
            index = pandas.MultiIndex.from_product([range(number), self.t[:times]], names=["path", "t"])
            return pandas.DataFrame(paths, index=index)
        if of in self.joint and f"{of} x" in self.joint:
            sides = [self.joint[f"{of} {side}"] for side in "xy"]
            ends = [np.meshgrid(*(s[k:][: len(s) - 1] for s in sides), indexing="ij") for k in (0, 1)]
            columns = dict(zip(("x lo", "y lo", "x hi", "y hi"), [*ends[0], *ends[1]], strict=True))
            columns["count"] = self.joint[of]
            return pandas.DataFrame({name: array.ravel() for name, array in columns.items()})
        tables = []
        if of == "end":
            for name, (counts, edges) in self.histograms.items():
                bins = {"lo": edges[..., :-1], "hi": edges[..., 1:], "count": counts}
                tables.append(pandas.DataFrame(self._rows(name, "bin", np.arange(counts.shape[-1]), bins)))
        places = {"t": self.t, "lag": self.lag, "omega": self.omega}.get(of, np.empty(0))
        for name, law in self.statistics.items() if of in ("t", "lag", "omega") else ():
            if self.axis(name) != of:
                continue
            arrays = law._alone()
            if law.quantiles is not None and self.quantile_levels is not None:
                levels = enumerate(self.quantile_levels)
                arrays |= {f"q{level:g}": law.quantiles[..., k] for k, level in levels}
            tables.append(pandas.DataFrame(self._rows(name, of, places, arrays)))
        if of == "t" and not self.statistics:
            for name, array in self._columns().items():
                rows = self._rows(name, "t", self.t[: array.shape[1]], _of_few(array))
                tables.append(pandas.DataFrame(rows))
        if not tables:
            there = ["t", "end", *(a for a in ("lag", "omega") if a in self.arrays)]
            there += [] if self.parameters else ["path"]
            there += [name for name in self.joint if not name.endswith((" x", " y"))]
            hint = ": add statistics={'autocorrelation': […]}" if of in ("lag", "omega") else ""
            raise SceneError(f"a table is of {', '.join(map(repr, there))}, not of {of!r}{hint}")
        return pandas.concat(tables, ignore_index=True)

    def _columns(self) -> dict[str, Array]:
        """The columns of paths [path, time], spins by their components."""
        columns = {name: array for name, array in self.paths.items() if array.ndim == 2}
        if (spins := self.paths.get("spins")) is not None:
            rows = np.moveaxis(spins.reshape(*spins.shape[:2], -1), -1, 0)
            columns.update(zip(self.scene.components, rows, strict=True))
        return columns

    def _rows(self, name: str, axis: str, at: NDArray[Any], arrays: dict[str, Array]) -> dict[str, Any]:
        """Columns of a table: observable, parameters, the axis, and numbers."""
        mesh = np.meshgrid(*self.parameters.values(), at, indexing="ij")
        places = zip([*self.parameters, axis], mesh, strict=True)
        columns = {"observable": name, **{one: values.ravel() for one, values in places}}
        return columns | {what: array.ravel() for what, array in arrays.items()}

    def to_xarray(self) -> Any:
        """A dataset of xarray with dimensions path, t, lag, omega, quantile, the parameters of a
        sweep, and bins: ``q bin`` of the histogram of q at the end, ``joint(q, p) x`` and ``… y`` of a
        joint law, whose coordinates are the middles."""
        xarray = imported("xarray")
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
                if array is not None:
                    variables[f"{name} {what.replace('_', ' ')}"] = (dims, array)
            if law.quantiles is not None:
                variables[f"{name} quantiles"] = ((*dims, "quantile"), law.quantiles)
                coordinates["quantile"] = self.quantile_levels
        for name, (counts, edges) in self.histograms.items():
            variables[f"{name} histogram"] = ((*self.parameters, f"{name} bin"), counts)
            variables[f"{name} edges"] = ((*self.parameters, f"{name} edge"), edges)
        for name, array in self.joint.items():
            if array.ndim == 2:
                variables[name] = ((f"{name} x", f"{name} y"), array)
            else:
                coordinates[name] = (array[1:] + array[:-1]) / 2
        attributes = {"seed": str(self.seed), "version": self.version, "scheme": self.scheme}
        attributes["scene"] = self.scene.to_toml()
        return xarray.Dataset(variables, coordinates, attributes)


def load(file: str | PathLike[str]) -> Run:
    """The result that :meth:`Run.save` wrote as ``.npz``."""
    from ._scene import restored

    try:
        with np.load(file) as arrays:
            if _ABOUT not in arrays.files:
                raise SceneError(
                    f"{fspath(file)} has arrays without their scene, as `casimir run` writes them: "
                    "numpy.load reads them"
                )
            about = json.loads(str(arrays[_ABOUT]))
            read = [{name: arrays[name] for name in names} for names in about["arrays"]]
            varied = {name: arrays[f"{_ABOUT} {name}"] for name in about["varied"]}
            rows = f"{_ABOUT} states"
            states = arrays[rows] if rows in arrays.files else None
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(f"cannot read the result {fspath(file)}: {error}") from error
    scene = restored(about["scene"]["text"], about["scene"]["name"], states)
    found = {**about["found"], "page": about["page"], "paths": read[0], "statistics": read[1]}
    run = Run(scene, found, varied)  # type: ignore[arg-type]
    run.version = about["version"]
    return run


def band(ax: Any, at: Array, of: list[Array], label: str) -> None:
    """A line with its interval: mean, lower and upper end."""
    mean, lo, hi = of
    (line,) = ax.plot(at, mean, ".-" if len(at) < 50 else "-", label=label)
    ax.fill_between(at, lo, hi, alpha=0.25, color=line.get_color())


def _of_few(paths: Array) -> dict[str, Array]:
    """The statistics of a few paths [path, time], with the columns of those of many."""
    values, unknown = np.ma.masked_invalid(paths), np.full(paths.shape[1], np.nan)
    known = dict.fromkeys(Statistics._fields, unknown)
    del known["quantiles"]
    known |= {"mean": values.mean(axis=0), "least": values.min(axis=0), "largest": values.max(axis=0)}
    known["median"] = np.ma.median(values, axis=0)  # type: ignore[no-untyped-call]
    if len(paths) > 1:
        known |= {"variance": values.var(axis=0, ddof=1), "deviation": values.std(axis=0, ddof=1)}
    known |= {f"q{level:g}": unknown for level in (0.05, 0.25, 0.5, 0.75, 0.95)}
    return {name: np.ma.filled(array, np.nan) for name, array in known.items()}
