"""Scenes: one description of what is simulated."""

from __future__ import annotations

import csv
import difflib
import functools
import html
import inspect
import io
import itertools
import json
import warnings
from collections.abc import Callable, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._changes import (
    OPTIONS,
    Changes,
    ChangesBesideAccuracy,
    ChangesBesideParameters,
    EquilibriumArguments,
    EquilibriumOptions,
    ExpectArguments,
    ExpectOptions,
    HowArguments,
    LyapunovArguments,
    LyapunovOptions,
    explicit,
)
from ._errors import SceneError
from ._estimates import Comparison, Expectation, ExpectationSweep, Fit, Inspection, Order
from ._formulas import finite, plain, whole
from ._parts import Part, derived, divided
from ._progress import How, how
from ._results import Result
from ._run import Run

if TYPE_CHECKING:
    from typing_extensions import Unpack

R = TypeVar("R", bound=Result)

# A folder for unfinished work.
Folder = str | PathLike[str] | None

# What a text names where an array of initial states goes with it; no file is read then.
_STATES = "states.csv"
# Keys of a system, which are changed as one table.
_SYSTEM = ("state", "B", "H0", "H", "calculus", "drift", "noise")


@functools.cache
def _keys() -> tuple[dict[str, tuple[str, ...]], frozenset[str]]:
    """Where the keyword of a change goes, and which keys are tables."""
    schema = json.loads(_core.schema())
    tables = schema["properties"]
    keys: dict[str, tuple[str, ...]] = {"parameters": ("system", "parameters")}
    for table in ("expect", "run"):
        definition = schema["$defs"][_definition(tables[table])]
        keys.update({key: (table, key) for key in definition["properties"]})
    return keys, frozenset(tables)


def _definition(entry: dict[str, Any]) -> str:
    references = [entry, *entry.get("anyOf", []), *entry.get("allOf", [])]
    found = [one["$ref"] for one in references if "$ref" in one]
    return str(found[0]).rsplit("/", 1)[-1]


@explicit
class Scene:
    """A system with its initial value and what is wanted: the contents of a scene's file.

    ``Scene("body.toml")`` reads a file, ``Scene({...})`` takes a dictionary with the same keys, and
    :meth:`from_toml` a text. A scene is checked when it is made, and does not change:
    :meth:`with_` gives another.
    """

    __slots__ = ("_about", "name", "states", "text")

    name: str
    """The name in messages: that of the file."""
    text: str
    """The text in TOML."""
    states: NDArray[np.float64] | None
    """The initial states [path, component], where an array was given."""

    def __init__(self, source: str | PathLike[str] | Mapping[str, Any]) -> None:
        if isinstance(source, Mapping):
            scene = Scene.unchecked(source)
            self._set(scene.text, scene.name, scene.states)
        else:
            if not isinstance(source, (str, PathLike)):
                what = type(source).__name__
                hint = "; call its .scene(initial=…, until=…, steps=…)" if what == "System" else ""
                raise SceneError(f"a scene is a file or a dictionary, got {what}{hint}")
            name = fspath(source)
            if "\n" in name:
                raise SceneError("this is a text, not the name of a file: Scene.from_toml(text)")
            try:
                self._set(Path(name).read_text(encoding="utf-8"), name, None)
            except OSError as error:
                raise SceneError(f"cannot read the scene {name}: {error.strerror}") from error
        self._check()

    @classmethod
    def from_toml(cls, text: str, name: str = "scene") -> Scene:
        """The scene of a text; ``name`` stands in messages."""
        if not isinstance(text, str):
            raise SceneError(f"a scene is a text, got {type(text).__name__}")
        scene = cls.__new__(cls)
        scene._set(text, name, None)
        scene._check()
        return scene

    @classmethod
    def unchecked(cls, tables: Mapping[str, Any]) -> Scene:
        """The scene of a dictionary, which is checked when it is used."""
        scene = cls.__new__(cls)
        scene._set("", "scene", None)
        tables = dict(tables)
        run = tables.get("run")
        states = run.get("initial") if isinstance(run, Mapping) else None
        if isinstance(run, Mapping) and isinstance(states, np.ndarray) and states.ndim == 2:
            scene.states = _array(states)
            tables["run"] = {**run, "initial": _STATES}
        pairs = [([str(key)], json.dumps(plain(v, str(key)))) for key, v in tables.items()]
        scene.text = _text("", sorted(pairs, key=lambda pair: pair[1].startswith("{")))
        return scene

    def _set(self, text: str, name: str, states: NDArray[np.float64] | None) -> None:
        self.text, self.name, self.states = text, name, states
        self._about: dict[str, Any] | None = None

    def _check(self) -> dict[str, Any]:
        if self._about is None:
            self._about = json.loads(_core.check(self))
        return self._about

    def with_(self, **changes: Unpack[Changes]) -> Scene:
        """Another scene with some keys changed.

        Keys of ``[run]`` and ``[expect]`` go by their names, ``parameters`` are changed one by one,
        other tables key by key, ``None`` removes a key:
        ``scene.with_(steps=800, parameters={"h": 3.0}, observe={"energy": "H0"})``. ``initial`` may
        be an array of states [path, component]; path *i* begins in row *i*, counted round.
        """
        keys, tables = _keys()
        pairs: list[tuple[Sequence[str], str]] = []
        states = self.states
        for name, value in changes.items():
            if name == "initial":
                states = None
                if hasattr(value, "to_numpy"):
                    value = value.to_numpy()
                rows = value if isinstance(value, (list, tuple)) else []
                is_table = isinstance(value, np.ndarray) and value.ndim == 2
                if is_table or any(isinstance(row, (list, tuple, np.ndarray)) for row in rows):
                    states, value = _array(value), _STATES
            if name == "damping" and value is not None and not isinstance(value, Mapping):
                value = {"rate": value}
            if name == "parameters" and isinstance(value, Mapping):
                self._know_parameters(value)
            if value is not None and not isinstance(value, Mapping):
                example = {"parameters": '{"k": 2.0}', "observe": '{"energy": "H0"}'}.get(name, "{…}")
                if name == "parameters" or name in tables - {"title"}:
                    raise SceneError(f"`{name}` is a dictionary: {name}={example}", name)
            if isinstance(value, Mapping) and (name == "parameters" or name in tables):
                above = keys.get(name, (name,))
                items = plain(value, ".".join(above)).items()
                pairs += [((*above, key), json.dumps(inner)) for key, inner in items]
            elif name in keys or name in tables:
                if name == "of" and isinstance(value, str):
                    value = [value]
                path = keys.get(name, (name,))
                pairs.append((path, json.dumps(plain(value, ".".join(path)))))
            else:
                near = difflib.get_close_matches(name, [*keys, *tables], 1)
                hint = f"; do you mean `{near[0]}`?" if near else ""
                if name in _SYSTEM:
                    hint = f"; write system={{'{name}': …}}"
                raise SceneError(f"unknown key `{name}`{hint}", name)
        if states is not None and "initial" in changes and changes.get("paths") is None:
            pairs.append((keys["paths"], json.dumps(len(states))))
        scene = Scene.__new__(Scene)
        scene._set(_text(self.text, pairs), self.name, states)
        scene._check()
        return scene

    def _know_parameters(self, names: Mapping[str, Any]) -> None:
        """Refuses parameters that formulas do not have; a system of the project knows its own."""
        system = self.to_dict().get("system", {})
        known = [*system.get("parameters", {})]
        for name in map(str, names):
            if "name" not in system and name not in known:
                near = difflib.get_close_matches(name, known, 1)
                hint = f"; do you mean `{near[0]}`?" if near else ""
                there = ", ".join(known) or "none"
                raise SceneError(f"no parameter `{name}`; there are {there}{hint}", name)

    def to_toml(self) -> str:
        """The text of the scene; an array of initial states is written by :meth:`save`."""
        return self.text

    def to_dict(self) -> dict[str, Any]:
        """The keys of the scene; ``initial`` is the array where there is one."""
        tables = dict(json.loads(_core.as_json(self.text)))
        if self.states is not None:
            tables["run"]["initial"] = self.states.copy()
        return tables

    def save(self, file: str | PathLike[str]) -> None:
        """Writes the text, and an array of initial states beside it."""
        path, text = Path(file), self.text
        if self.states is not None:
            states = path.with_name(f"{path.stem}-{_STATES}")
            text = _text(text, [(("run", "initial"), json.dumps(states.name))])
            rows = (",".join(map(repr, row)) for row in self.states.tolist())
            states.write_text("\n".join(rows) + "\n", encoding="utf-8")
        path.write_text(text, encoding="utf-8")

    @property
    def title(self) -> str:
        """The title."""
        return str(self._check()["title"])

    @property
    def components(self) -> list[str]:
        """The names of the components of the state."""
        return list(self._check()["components"])

    @property
    def observables(self) -> list[str]:
        """The names of the observables, before components if these are few."""
        return list(self._check()["observables"])

    def run(
        self,
        *,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        resume: Folder = None,
        on: Literal["cpu", "gpu"] = "cpu",
        **changes: Unpack[Changes],
    ) -> Run:
        """Simulates paths: tables of the first, statistics of all where they are 100 or more.

        Further arguments change the scene as :meth:`with_` does. Ctrl-C gives what is complete, and
        ``interrupted`` is true; with ``raises`` it raises ``KeyboardInterrupt`` instead. ``threads``
        changes the time, and no bit of the results. ``resume`` is a folder for checkpoints: the same
        call goes on from there after a kill, to the bits of an undisturbed run. ``on="gpu"`` advances
        the paths on a graphics card of NVIDIA, to the same bits; a warning names what is not for it.
        """
        scene = self.with_(**changes) if changes else self
        return scene._run(False, how(threads, progress, resume, on), raises)

    def _run(self, independent: bool, how: How, raises: bool) -> Run:
        found = _core.run(self, independent, how)
        for why in found["left"]:
            warnings.warn(f"paths were computed on the processor: {why}", stacklevel=3)
        return Run(self, _raising(found, raises), self.varied, how.folder)

    @property
    def varied(self) -> dict[str, NDArray[np.float64]]:
        """The values of the parameters that ``[sweep]`` varies."""
        return {str(key): np.array(values) for key, values in self._check()["sweep"].items()}

    @overload
    def parts(self, number: int, **changes: Unpack[Changes]) -> list[Part[Run]]: ...
    @overload
    def parts(
        self, number: int, verb: Literal["expect"], **changes: Unpack[ExpectOptions]
    ) -> list[Part[Expectation]]: ...
    @overload
    def parts(
        self, number: int, verb: Literal["equilibrium"], **changes: Unpack[EquilibriumOptions]
    ) -> list[Part[Expectation]]: ...
    @overload
    def parts(
        self, number: int, verb: Literal["lyapunov"], **changes: Unpack[LyapunovOptions]
    ) -> list[Part[Expectation]]: ...
    def parts(self, number: int, verb: str = "run", **changes: Any) -> Any:
        """A computation in parts, which have ``run()``, pickle, and need nothing from each other: for
        the processes of any executor. :func:`merge` makes a result of theirs.

        Merged runs have the bits of one run. ``"expect"``, ``"equilibrium"`` and ``"lyapunov"``, with
        their arguments, are replicates with Student's interval over the parts.
        """
        if verb not in OPTIONS:
            raise SceneError(f"parts are of {', '.join(OPTIONS)}, not of {verb!r}")
        options = {name: changes.pop(name) for name in OPTIONS[verb] & changes.keys()}
        if verb == "lyapunov":
            default = inspect.signature(type(self).lyapunov).parameters["accuracy"].default
            options.setdefault("accuracy", default)
        scene = self.with_(**changes) if changes else self
        return divided(scene, whole("number of parts", number, 1, 10**6), verb, options, False)

    # Verbs: the test `declared` of the program writes these methods.
    def inspect(
        self,
        *,
        threads: int | None = None,
        progress: bool = True,
        **changes: Unpack[Changes],
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
        resume: Folder = None,
        **changes: Unpack[Changes],
    ) -> Expectation:
        """Expectations E[φ(y(T))] with 95 % intervals: ``expect(of=["y1"], accuracy=1e-4)``.

        ``coarsest_steps``: Steps of the coarsest level. Default: chosen with the scheme; about
        eight in a unit of time for a scheme that is named, and with events or integrals.
        """
        options: Mapping[str, Any] = {
            "coarsest_steps": None if coarsest_steps is None else whole("coarsest_steps", coarsest_steps),
        }
        return self._called(Expectation, "expect", options, changes, how(threads, progress, resume), raises)

    def equilibrium(
        self,
        *,
        chains: int = 256,
        path_steps: float = 1e10,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        resume: Folder = None,
        **changes: Unpack[Changes],
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
        return self._called(Expectation, "equilibrium", options, changes, how(threads, progress, resume), raises)

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
        resume: Folder = None,
        **changes: Unpack[ChangesBesideAccuracy],
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
        return self._called(Expectation, "lyapunov", options, changes, how(threads, progress, resume), raises)

    def order(
        self,
        *,
        path_steps: float = 3e8,
        threads: int | None = None,
        progress: bool = True,
        resume: Folder = None,
        **changes: Unpack[Changes],
    ) -> Order:
        """The strong and the weak order of the scheme of a scene.

        ``path_steps``: Path-steps that each measurement may take.
        """
        options: Mapping[str, Any] = {
            "path_steps": whole("path_steps", path_steps),
        }
        return self._called(Order, "order", options, changes, how(threads, progress, resume))

    def compare(
        self,
        *,
        budget: float = 60.0,
        error: float = 0.001,
        threads: int | None = None,
        progress: bool = True,
        resume: Folder = None,
        **changes: Unpack[Changes],
    ) -> Comparison:
        """Error against cost of all schemes, and the cheapest one for an error of y(T).

        ``budget``: Seconds that it may take.

        ``error``: The wanted root-mean-square error of y(T).
        """
        options: Mapping[str, Any] = {
            "budget": finite("budget", budget, above=0),
            "error": finite("error", error, above=0),
        }
        return self._called(Comparison, "compare", options, changes, how(threads, progress, resume))
    # Verbs: the test `declared` of the program writes these methods.

    def fit(
        self,
        data: Any,
        parameters: str | Sequence[str] = (),
        *,
        path_steps: float = 1e9,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        resume: Folder = None,
        **changes: Unpack[ChangesBesideParameters],
    ) -> Fit:
        """Finds parameters from moments or samples: ``fit(frame, ["I1", "sigma"])``.

        ``data`` is a frame of pandas, a dictionary of columns, or the name of a CSV file. Moments
        have the columns time, observable, statistic (mean, variance or a quantile as q0.05), value
        and error; samples have t and a column for each observable.

        ``parameters``: Names, instead of those of ``[fit]``; the search begins at their values.

        ``path_steps``: Path-steps after which neither paths nor steps are doubled.
        """
        names = [parameters] if isinstance(parameters, str) else list(parameters)
        options: Mapping[str, Any] = {
            "table": _table(data),
            "parameters": names,
            "path_steps": whole("path_steps", path_steps),
        }
        return self._called(Fit, "fit", options, changes, how(threads, progress, resume), raises)

    def _called(
        self,
        result: Callable[..., R],
        verb: str,
        options: Mapping[str, Any],
        changes: Mapping[str, Any],
        how: How,
        raises: bool = False,
    ) -> R:
        scene = self.with_(**changes) if changes else self
        scene._check()
        return result(scene, _raising(_core.call(verb, scene, json.dumps(options), how), raises))

    def __repr__(self) -> str:
        if self._about is None:
            return f"Scene {self.name}"
        about, names = self._about, self.components
        shown = ", ".join(names if len(names) <= 6 else [*names[:5], "…", names[-1]])
        paths = f"{about['paths']} {'path' if about['paths'] == 1 else 'paths'}"
        return f"Scene {self.title!r}: {shown}; {paths} to t = {about['until']:g} in {about['steps']} steps"

    def _repr_html_(self) -> str:
        text = html.escape(self.text)
        return f"<details><summary>{html.escape(repr(self))}</summary><pre>{text}</pre></details>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene) or self.text != other.text:
            return False
        return np.array_equal(_or_empty(self.states), _or_empty(other.states))

    def __hash__(self) -> int:
        return hash(self.text)

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (self.text, self.name, self.states)


def restored(text: str, name: str, states: NDArray[np.float64] | None) -> Scene:
    scene = Scene.__new__(Scene)
    scene._set(text, name, states)
    return scene


def _or_empty(states: NDArray[np.float64] | None) -> NDArray[np.float64]:
    return np.empty(0) if states is None else states


def _array(states: Any) -> NDArray[np.float64]:
    try:
        if np.iscomplexobj(states):
            raise TypeError("these are complex")
        array = np.array(states, dtype=np.float64)
        array.flags.writeable = False
    except (TypeError, ValueError) as error:
        raise SceneError(f"initial states are numbers [path, component]: {error}", "run.initial") from error
    if array.ndim != 2:
        raise SceneError(f"initial states are [path, component], got {array.shape}", "run.initial")
    wrong = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if array.size == 0 or len(wrong):
        where = f"row {wrong[0]} is {array[wrong[0]].tolist()}" if len(wrong) else "there is none"
        raise SceneError(f"initial states must be finite, and at least one: {where}", "run.initial")
    return array


def _table(data: Any) -> str:
    """Data as a text of CSV."""
    if isinstance(data, (str, PathLike)):
        try:
            return Path(data).read_text(encoding="utf-8")
        except OSError as error:
            raise SceneError(f"cannot read the data {fspath(data)}: {error.strerror}") from error
    if hasattr(data, "to_csv"):
        index = getattr(data.index, "names", None) or [None]
        return str(data.to_csv(index=any(name is not None for name in index)))
    if not isinstance(data, Mapping):
        what = type(data).__name__
        raise SceneError(f"data are a frame, a dictionary of columns or a CSV file, got {what}")
    file = io.StringIO()
    csv.writer(file).writerows([list(data), *zip(*data.values(), strict=True)])
    return file.getvalue()


def _text(text: str, pairs: Sequence[tuple[Sequence[str], str]]) -> str:
    try:
        return _core.changed(text, pairs)
    except ValueError as error:
        raise SceneError(str(error)) from error


def _raising(found: Any, raises: bool) -> Any:
    if raises and found["interrupted"]:
        raise KeyboardInterrupt
    return found


@explicit
class Sweep:
    """A scene at every combination of values of its parameters; see :func:`sweep`."""

    scene: Scene
    """The scene."""
    values: dict[str, NDArray[np.float64]]
    """The values of each parameter."""
    independent: bool
    """Whether combinations have random numbers of their own."""

    def __init__(self, scene: Scene, independent: bool, values: Mapping[str, Sequence[float]]) -> None:
        if not isinstance(scene, Scene):
            raise SceneError(f"a sweep is of a scene, got {type(scene).__name__}")
        if not values:
            raise SceneError("nothing is varied: sweep(scene, h=[0.1, 0.2])")
        scene._know_parameters(values)
        self.scene, self.independent = scene, independent
        self.values = {name: plain_values(name, v) for name, v in values.items()}

    def run(
        self,
        *,
        threads: int | None = None,
        progress: bool = True,
        raises: bool = False,
        resume: Folder = None,
        on: Literal["cpu", "gpu"] = "cpu",
        **changes: Unpack[Changes],
    ) -> Run:
        """Runs every combination. Arrays have an axis for each parameter, before that of time."""
        scene = self._varied(dict(changes))
        return scene._run(self.independent, how(threads, progress, resume, on), raises)

    def parts(self, number: int, **changes: Unpack[Changes]) -> list[Part[Run]]:
        """The run in parts, as :meth:`Scene.parts`: each has some paths of all combinations."""
        scene = self._varied(dict(changes))
        return divided(scene, whole("number of parts", number, 1, 10**6), "run", {}, self.independent)

    def expect(self, **arguments: Unpack[ExpectArguments]) -> ExpectationSweep:
        """Expectations at every combination, with the arguments of :meth:`Scene.expect`."""
        return self._each("expect", dict(arguments))

    def equilibrium(self, **arguments: Unpack[EquilibriumArguments]) -> ExpectationSweep:
        """Averages over the stationary law, with the arguments of :meth:`Scene.equilibrium`."""
        return self._each("equilibrium", dict(arguments))

    def lyapunov(self, **arguments: Unpack[LyapunovArguments]) -> ExpectationSweep:
        """Lyapunov exponents, with the arguments of :meth:`Scene.lyapunov`."""
        return self._each("lyapunov", dict(arguments))

    def _each(self, verb: str, arguments: dict[str, Any]) -> ExpectationSweep:
        own = OPTIONS[verb] | HowArguments.__annotations__.keys()
        given = {name: arguments.pop(name) for name in own & arguments.keys()}
        folder = given.pop("resume", None)
        scene = self._varied(arguments)
        varied = scene.varied
        scene = scene.with_(sweep=None)
        found: list[Expectation | None] = []
        for k, place in enumerate(itertools.product(*varied.values())):
            values = dict(zip(varied, map(float, place), strict=True))
            one = scene.with_(parameters=values)
            if self.independent:
                one = one.with_(seed=derived(int(one._check()["seed"]), k))
            resume = folder if folder is None else Path(folder, f"combination-{k + 1}")
            stopped = bool(found) and (found[-1] is None or found[-1].interrupted)
            try:
                found.append(None if stopped else getattr(one, verb)(**given, resume=resume))
            except KeyboardInterrupt:
                if given.get("raises") or not found:
                    raise
                found.append(None)
        return ExpectationSweep(scene, varied, found)

    def _varied(self, changes: dict[str, Any]) -> Scene:
        twice = set(changes.get("parameters") or ()) & set(self.values)
        if twice:
            raise SceneError(f"`{min(twice)}` is varied already: leave it out of `parameters`")
        sweep = {**(changes.pop("sweep", None) or {}), **self.values}
        return self.scene.with_(**changes, sweep=sweep)

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name}: {len(values)}" for name, values in self.values.items())
        return f"Sweep of {self.scene!r} over {numbers}"

    def _repr_html_(self) -> str:
        rows = ((name, ", ".join(f"{x:g}" for x in values)) for name, values in self.values.items())
        cells = "".join(f"<tr><th>{html.escape(a)}</th><td>{b}</td></tr>" for a, b in rows)
        return f"<table>{cells}</table>{self.scene._repr_html_()}"


for _verb in ("expect", "equilibrium", "lyapunov"):
    _signature = inspect.signature(getattr(Scene, _verb))
    getattr(Sweep, _verb).__signature__ = _signature.replace(return_annotation="ExpectationSweep")


def plain_values(name: str, values: Any) -> NDArray[np.float64]:
    """The values of a parameter as numbers."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise SceneError(f"the values of `{name}` are numbers: {error}", name) from error
    array = np.atleast_1d(array)
    if not np.isfinite(array).all():
        raise SceneError(f"the values of `{name}` must be finite, got {array.tolist()}", name)
    if array.size == 0 or array.ndim != 1:
        raise SceneError(f"the values of `{name}` are a list of numbers, at least one", name)
    if len(np.unique(array)) < len(array):
        raise SceneError(f"`{name}` has a value twice: {array.tolist()}", name)
    return array


def sweep(scene: Scene, /, *, independent: bool = False, **values: Sequence[float]) -> Sweep:
    """A scene at every combination of the values of its parameters.

    All combinations see the same random numbers, so that neighbours can be compared; with
    ``independent`` each has its own. ``sweep(scene, sigma=[0.1, 0.2], k=[1, 2]).run()``.
    """
    return Sweep(scene, independent, values)


def scenes() -> list[str]:
    """The names of the scenes of the gallery."""
    return _core.scenes()


def scene(name: str) -> Scene:
    """A scene of the gallery."""
    if not isinstance(name, str):
        raise SceneError(f"a scene of the gallery has a name, got {name!r}")
    try:
        return Scene.from_toml(_core.scene(name), name)
    except ValueError as error:
        raise error if isinstance(error, SceneError) else SceneError(str(error)) from error
