"""The compiled half of the package."""

from collections.abc import Callable, Sequence
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "__version__",
    "as_json",
    "call",
    "changed",
    "check",
    "citation",
    "doctor",
    "judge",
    "main",
    "run",
    "scene",
    "scenes",
    "schema",
    "settle",
    "single_steps",
    "solver_noise",
    "student",
]

__version__: str

class _Given(Protocol):
    @property
    def text(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def states(self) -> NDArray[np.float64] | None: ...

class _How(Protocol):
    @property
    def threads(self) -> int | None: ...
    @property
    def show(self) -> Callable[[str], None] | None: ...
    @property
    def folder(self) -> str | None: ...
    @property
    def gpu(self) -> bool: ...

class _Found(TypedDict):
    text: str
    json: str
    figures: list[tuple[str, str, str, str]]
    page: str
    paths: dict[str, NDArray[np.float64]]
    statistics: dict[str, NDArray[np.float64]]
    left: list[str]
    interrupted: bool

def check(given: _Given) -> str: ...

_Part = tuple[tuple[int, int], str]

def run(given: _Given, independent: bool, how: _How, part: _Part | None = None) -> _Found: ...
def settle(given: _Given, independent: bool) -> str: ...
def call(verb: str, given: _Given, options: str, how: _How) -> _Found: ...
_Sizes = tuple[int | None, int, int]
_States = NDArray[np.float64]

def solver_noise(
    given: _Given, sizes: _Sizes, range: tuple[int, int]
) -> tuple[list[dict[str, _States]], list[_States]]: ...
def single_steps(
    given: _Given, sizes: _Sizes
) -> tuple[int, list[tuple[float, list[dict[str, _States]]]]]: ...
def judge(
    given: _Given,
    sizes: _Sizes,
    answers: tuple[_States, Sequence[_States], _States, Sequence[_States], Sequence[Sequence[_States]]],
    seconds: Sequence[float],
    said: tuple[float | None, float | None, bool, bool],
    how: _How,
) -> _Found: ...
def main(program: str, arguments: Sequence[str]) -> int: ...
def doctor() -> tuple[str, bool]: ...
def student(degrees: float) -> float: ...
def citation(result: str | None) -> str: ...
def scenes() -> list[str]: ...
def scene(name: str) -> str: ...
def schema() -> str: ...
def changed(text: str, changes: Sequence[tuple[Sequence[str], str]]) -> str: ...
def as_json(text: str) -> str: ...
