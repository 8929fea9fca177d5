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

    scene: Scene
    """The scene, with all changes."""
    text: str
    """The words of the program, as ``print`` shows them."""
    data: dict[str, Any]
    """The JSON of the program."""
    figures: Figures
    """The figures by their names."""
    version: str
    """The version of the package that computed it."""
    seed: int
    """The seed of the random numbers."""
    interrupted: bool
    """Whether Ctrl-C ended it early."""

    def __init__(self, scene: Scene, found: _Found) -> None:
        self.scene = scene
        self.text = found["text"].rstrip("\n")
        self.data = json.loads(found["json"])
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
        return table(self.text)


def citation(result: Result | None = None) -> str:
    """BibTeX of what a result used: the software, the paper and methods. Without one, of all."""
    if not isinstance(result, Result | None):
        raise TypeError(f"what to cite is known of results, not of {type(result).__name__}")
    return _core.citation(None if result is None else json.dumps(result.data))


def table(text: str) -> str:
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


def number_or_none(value: Any) -> float | None:
    return None if value is None else float(value)


def imported(package: str) -> Any:
    import importlib

    try:
        return importlib.import_module(package)
    except ImportError as error:
        package = package.partition(".")[0]
        if error.name != package:
            raise
        raise missing(package, "this") from error

