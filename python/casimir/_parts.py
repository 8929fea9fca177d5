"""Parts of a computation for any executor."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np

from . import _core
from ._errors import SceneError
from ._estimates import Expectation
from ._progress import how
from ._run import Run

if TYPE_CHECKING:
    from ._scene import Scene

R = TypeVar("R", Run, Expectation)

# What of a half-width a mean of several does not make smaller: the most that a bias has of it.
_BIAS = 1 / 3


class Whole(NamedTuple):
    """What is divided."""

    scene: Scene
    verb: str
    parts: int
    options: Mapping[str, Any]
    settled: str
    """The schemes of a run, and nothing of other verbs."""
    independent: bool


class Part(Generic[R]):
    """One of several parts, which :meth:`run` computes anywhere, in any order, any number of times:
    ``scene.parts(64)`` has all. Parts pickle."""

    number: int
    """The number of the part, from one."""
    whole: Whole
    """What is divided."""

    def __init__(self, number: int, whole: Whole) -> None:
        self.number, self.whole = number, whole

    def run(
        self,
        *,
        threads: int | None = 1,
        progress: bool = False,
        resume: str | PathLike[str] | None = None,
    ) -> PartResult[R]:
        """Computes it, on one thread unless said otherwise: executors start a process for each
        processor. With a folder ``resume`` it goes on from its checkpoint there."""
        scene, verb, parts, options, settled, independent = self.whole
        if verb != "run":
            if resume is not None:
                resume = Path(resume, f"part-{self.number}-of-{parts}")
            own = scene.with_(seed=derived(_seed(scene), self.number))
            given = {**options, "threads": threads, "progress": progress, "resume": resume}
            found = getattr(own, verb)(**given, raises=True)
            return PartResult(self, json.dumps(found.data).encode())
        with tempfile.TemporaryDirectory() as here:
            folder = Path(here if resume is None else resume)
            share = (self.number, parts), settled
            _core.run(scene, independent, how(threads, progress, folder), share)
            return PartResult(self, (folder / _file(self.number, parts)).read_bytes())

    def __repr__(self) -> str:
        return f"part {self.number} of {self.whole.parts} of {self.whole.verb}: {self.whole.scene!r}"


class PartResult(Generic[R]):
    """What a part found, for :func:`merge`. It pickles."""

    part: Part[R]
    """The part."""
    found: bytes
    """Sums of a run, or the JSON of an expectation."""

    def __init__(self, part: Part[R], found: bytes) -> None:
        self.part, self.found = part, found

    def __repr__(self) -> str:
        return f"result of {self.part!r}"


def merge(results: Iterable[PartResult[R]]) -> R:
    """The result of all parts, in any order: of a run with the bits of one run.

    Expectations, averages and exponents are replicates: each part has random numbers of its own, and
    the interval is Student's over the parts, with their bounds of the bias.
    """
    checked = _checked(results)
    found = {result.part.number: result for result in checked}
    whole: Whole = checked[0].part.whole
    missing = sorted({*range(1, whole.parts + 1)} - found.keys())
    if missing:
        shown = ", ".join(map(str, missing[:20])) + ", …" * (len(missing) > 20)
        raise SceneError(f"of {whole.parts} parts these are missing: {shown}")
    if whole.verb != "run":
        return _mean(whole, [json.loads(found[k].found) for k in sorted(found)])  # type: ignore[return-value]
    with tempfile.TemporaryDirectory() as folder:
        for number, result in found.items():
            Path(folder, _file(number, whole.parts)).write_bytes(result.found)
        scene, share = whole.scene, ((0, 0), whole.settled)
        arrays = _core.run(scene, whole.independent, how(None, False, Path(folder)), share)
    return Run(scene, arrays, scene.varied)  # type: ignore[return-value]


def _checked(results: Iterable[PartResult[R]]) -> list[PartResult[R]]:
    """All of them, which are of one computation."""
    if isinstance(results, PartResult):
        raise SceneError("merge takes the results of all parts: merge([part.run() for part in parts])")
    all = list(results)
    if not all:
        raise SceneError("there are no results to merge")
    for one in all:
        if not isinstance(one, PartResult):
            raise SceneError(f"merge takes what part.run() gives, got {type(one).__name__}")
        if one.part.whole != all[0].part.whole:
            raise SceneError(f"these are parts of different computations: {all[0].part!r}, {one.part!r}")
    return all


def divided(scene: Scene, number: int, verb: str, options: Mapping[str, Any], independent: bool) -> list[Any]:
    """All parts."""
    if verb == "run":
        if scene._check()["paths"] < 100:
            raise SceneError("a few paths are not divided: take at least 100 `paths`", "run.paths")
        settled = _core.settle(scene, independent)
        whole = Whole(scene, verb, number, {}, settled, independent)
        return [Part(k, whole) for k in range(1, number + 1)]
    if number < 4:
        raise SceneError(f"Student's interval needs at least four parts, got {number}")
    accuracy = options.get("accuracy")
    share = 1 / (_BIAS + (1 - _BIAS) * number**-0.5)
    if accuracy is not None:
        options = {**options, "accuracy": accuracy * share}
    else:
        wanted = scene.to_dict().get("expect", {}).get("accuracy")
        scene = scene if wanted is None else scene.with_(accuracy=wanted * share)
    return [Part(k, Whole(scene, verb, number, options, "", False)) for k in range(1, number + 1)]


def _file(number: int, parts: int) -> str:
    return f"part-{number:0{len(str(parts))}}-of-{parts}.bin"


def _seed(scene: Scene) -> int:
    return int(scene._check()["seed"])


def derived(seed: int, number: int) -> int:
    """A seed of its own for one of several replicates."""
    return int.from_bytes(hashlib.sha256(f"{seed} {number}".encode()).digest()[:7], "big")


def _mean(whole: Whole, parts: list[dict[str, Any]]) -> Expectation:
    """The mean over parts with Student's interval."""
    number, first = len(parts), parts[0]
    quantile = _core.student(number - 1.0)
    share = 1 / (_BIAS + (1 - _BIAS) * number**-0.5)
    accuracy = None if first["accuracy"] is None else first["accuracy"] / share

    def mean(rows: Iterable[Any]) -> dict[str, Any]:
        rows = list(rows)
        of = {
            key: np.array([np.nan if one.get(key) is None else one.get(key, 0.0) for one in rows], float)
            for key in ("value", "bias_bound", "bias", "unsettled", "missed")
        }
        is_expectation = "bias_bound" in rows[0]
        value, error = of["value"].mean(), of["value"].std(ddof=1) / number**0.5
        bias = of["bias_bound"] if is_expectation else of["bias"] + of["unsettled"]
        # Events that no sample showed, of all samples.
        missed = of["missed"].max() / number if is_expectation else 0.0
        half_width = float(np.hypot(quantile * error, missed) + bias.mean())
        return {
            "of": rows[0]["of"],
            "value": float(value),
            "standard_error": float(error),
            "bias_bound": float(bias.mean()),
            "lo": float(value - half_width),
            "hi": float(value + half_width),
            "half_width": half_width,
        }

    estimates = [mean(rows) for rows in zip(*(part["estimates"] for part in parts), strict=True)]
    gradient = {
        name: [mean(rows) for rows in zip(*(part["gradient"][name] for part in parts), strict=True)]
        for name in first.get("gradient", {})
    }
    warnings = {json.dumps(one): one for part in parts for one in part["warnings"]}
    all_estimates = [*estimates, *(one for of in gradient.values() for one in of)]
    narrow = accuracy is None or all(one["half_width"] <= accuracy for one in all_estimates)
    finite = all(np.isfinite(one["half_width"]) for one in all_estimates)
    data = {
        "title": first["title"],
        "scheme": first["scheme"],
        "accuracy": accuracy,
        "reached": bool(narrow and finite and all(part["reached"] for part in parts)),
        "estimates": estimates,
        "gradient": gradient,
        "parts": number,
        "warnings": list(warnings.values()),
    }
    lines = [f"{number} parts of {first['scheme']}"]
    lines += [f"{one['of']} = {one['value']:.10g} ± {one['half_width']:.2g}" for one in estimates]
    lines += [f"warning: {one['what']}" for one in warnings.values()]
    if not data["reached"]:
        lines.append("not reached" if accuracy is None else f"±{accuracy:g} is not reached")
    found = {"text": "\n".join(lines), "json": json.dumps(data), "figures": [], "interrupted": False}
    return Expectation(whole.scene, found)  # type: ignore[arg-type]
