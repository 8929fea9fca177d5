"""Solvers that are not ours: they get noise, give states, and are judged."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import SceneError
from ._formulas import finite, whole
from ._progress import how
from ._estimates import Measured
from ._scene import Scene
from ._system import System

Array = NDArray[np.float64]


class Level:
    """A step size: what a solver gets.

    ``y0`` [path, component] are the states at time 0, ``dt`` the step, ``dW`` [step, path, noise] the
    increments of the Wiener processes, ``areas`` [step, path, i, j] the Lévy areas
    ½∫(W_i dW_j − W_j dW_i), ``H`` [step, path, noise] the space-time areas ∫(W − tΔW/dt)dt/dt.
    """

    def __init__(self, y0: Array, dt: float, noise: dict[str, Array], place: tuple[str, int, int]) -> None:
        self.y0, self.dt, self._place = y0, dt, place
        self.dW, self.areas, self.H = noise["dW"], noise["areas"], noise["H"]
        self._begun = 0.0

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.dW)

    def __repr__(self) -> str:
        what, number, first = self._place
        paths = "states" if what == "single" else f"paths from {first} on"
        again = ", again" if what == "again" else ""
        return f"Level: {self.steps} steps of {self.dt:g} on {len(self.y0)} {paths}{again}"


class Report(Measured):
    """What the states of a solver show: printed as text, ``data`` as JSON, ``figures``."""

    @property
    def verdicts(self) -> dict[str, str | None]:
        """``"confirmed"``, ``"refuted"`` or ``"cannot tell"`` of what was claimed, else ``None``."""
        return {str(one["what"]): one["verdict"] for one in self.data["verdicts"]}

    @property
    def strong(self) -> float | None:
        """The strong order, if one can be named."""
        return self.data["strong"]["order"]  # type: ignore[no-any-return]


class Referee:
    """Measures the orders of a solver that is not ours, on the noise of a scene.

    >>> import numpy as np
    >>> import casimir
    >>> def euler(y, dt, dW):
    ...     for dw in dW:
    ...         turned = np.stack([y[:, 1], -y[:, 0]], axis=1)
    ...         y = y + (turned - (0.1 + 0.5**2 / 2) * y) * dt + 0.5 * turned * dw
    ...     return y
    >>> referee = casimir.Referee(casimir.scene("kubo"), until=2, paths=4096)
    >>> referee.judge(euler, strong=0.5).verdicts["strong order"]
    'confirmed'

    Every level has to be answered: the step sizes of the scene's time on ``paths`` paths, ``chunk`` of
    them at a time, the coarsest one twice, and single steps as dt → 0. Time begins at 0 in each; the
    equation is dy = (B∇H0 − γy)dt + Σ B∇Hm ∘ dWm in the sense of Stratonovich.
    """

    def __init__(
        self,
        scene: Scene | System,
        *,
        paths: int = 2048,
        levels: int = 6,
        steps: int | None = None,
        seed: int | None = None,
        chunk: int = 1024,
        **changes: Any,
    ) -> None:
        if isinstance(scene, System):
            scene = scene.scene(**changes)
        elif not isinstance(scene, Scene):
            raise SceneError(f"a referee is of a scene or a system, got {type(scene).__name__}")
        elif changes:
            scene = scene.with_(**changes)
        # Orders need five step sizes; more than thirty are not told apart from rounding.
        levels = whole("levels", levels, 5, 30)
        steps = None if steps is None else whole("steps", steps)
        paths, chunk = whole("paths", paths), whole("chunk", chunk)
        self.scene = scene if seed is None else scene.with_(seed=seed)
        self.paths, self.chunk = (-(-n // 32) * 32 for n in (paths, min(chunk, paths)))
        self._sizes = (steps, levels, self.paths)
        self._restart()

    def _restart(self) -> None:
        levels = self._sizes[1]
        self._start: list[Array] = []
        self._reference: list[list[Array]] = [[], []]
        self._states: list[list[Array]] = [[] for _ in range(levels)]
        self._again = np.empty((0, 0))
        self._single: list[list[Array]] = []
        self._seconds = [0.0] * levels
        self._open: dict[tuple[str, int, int], Level] = {}
        self._complete = False

    def __iter__(self) -> Iterator[Level]:
        self._restart()
        for first in range(0, self.paths, self.chunk):
            paths = min(self.chunk, self.paths - first)
            noise, states = _core.solver_noise(self.scene, self._sizes, (first, paths))
            y0 = states[0]
            self._start.append(y0)
            for kept, reference in zip(self._reference, states[1:], strict=True):
                kept.append(reference)
            until = float(self.scene._check()["until"])
            for number, arrays in enumerate(noise):
                dt = until / len(arrays["dW"])
                yield from self._ask(Level(y0.copy(), dt, arrays, ("level", number, first)))
                if first == number == 0:
                    yield from self._ask(Level(y0.copy(), dt, arrays, ("again", 0, 0)))
        number, all_steps = _core.single_steps(self.scene, self._sizes)
        good = np.concatenate(self._reference[0])
        good = good[np.isfinite(good).all(axis=1)]
        if not len(good):
            raise SceneError("all paths of the reference failed: take more steps, or another scene")
        for k, (tau, both) in enumerate(all_steps):
            y0 = np.resize(good, (number, good.shape[1]))
            y0 = np.tile(y0, (both[0]["dW"].shape[1] // number, 1))
            self._single.append([])
            for half, arrays in enumerate(both):
                yield from self._ask(Level(y0.copy(), tau / (1 + half), arrays, ("single", k, half)))
        self._complete = True

    def _ask(self, level: Level) -> Iterator[Level]:
        self._open[level._place] = level
        level._begun = time.perf_counter()
        yield level

    def add(self, level: Level, y: Any, seconds: float | None = None) -> None:
        """Takes the states y(T) [path, component] of a level: an array of NumPy, JAX or PyTorch.

        An array [time, path, component] of all states, from ``y0`` on, is taken at its last time.
        ``seconds`` of the solver are those since the level was given, unless set.
        """
        if not isinstance(level, Level) or level._place not in self._open:
            raise SceneError(f"{level!r} was answered already, or is not of this loop")
        if seconds is None:
            seconds = time.perf_counter() - level._begun
        if y is None:
            raise SceneError("the states are None: does the solver lack a `return`?")
        if hasattr(y, "detach"):
            y = y.detach().cpu()
        array = np.asarray(y)
        if array.ndim == 3 and len(array) == level.steps + 1 and np.array_equal(array[0], level.y0):
            array = array[-1]
        if array.shape != level.y0.shape:
            hint = "; of a map that makes one step take casimir.one_step(step)" if array.ndim == 3 else ""
            raise SceneError(f"states are [path, component], {level.y0.shape}, got {array.shape}{hint}")
        if array.dtype != np.float64:
            raise SceneError(
                f"states are float64, got {array.dtype}; rounding of float32 hides orders: "
                'y.astype(float), jax.config.update("jax_enable_x64", True), torch.float64'
            )
        array = np.array(array)
        what, number, _ = level._place
        if what == "single":
            self._single[number].append(array)
        elif what == "again":
            self._again = array
        else:
            self._states[number].append(array)
            self._seconds[number] += seconds
        del self._open[level._place]

    def judge(self, solver: Callable[..., Any], *, areas: bool = False, **claims: Any) -> Report:
        """Asks a solver at every level, and reports: ``solver(y0, dt, dW)`` gives y(T).

        With ``areas`` it is called as ``solver(y0, dt, dW, areas, H)``.
        """
        for level in self:
            noise = (level.dW, level.areas, level.H) if areas else (level.dW,)
            # Single steps with strong noise may overflow, and are left out then.
            with np.errstate(all="ignore" if level._place[0] == "single" else None):
                y = solver(level.y0, level.dt, *noise)
            self.add(level, y)
        claims.setdefault("same_step", getattr(solver, "same_step", False))
        return self.report(**claims)

    def report(
        self,
        *,
        strong: float | None = None,
        weak: float | None = None,
        keeps: bool = False,
        same_step: bool = False,
    ) -> Report:
        """What the answers show. ``strong`` and ``weak`` are orders that the solver claims to have,
        ``keeps`` that it keeps the laws of the scene: each is confirmed, refuted, or undecided. With
        ``same_step``, as of :func:`one_step`, all steps are the same map: single steps of a lower
        order refute it even where paths do not show this yet."""
        if self._open:
            raise SceneError(f"no answer to {next(iter(self._open.values()))!r}: call add(level, y) for each")
        if not self._complete:
            raise SceneError("the loop over the referee was not run to its end: it asks all levels")
        answers = (
            np.concatenate(self._start),
            [np.concatenate(level) for level in self._states],
            self._again,
            [np.concatenate(level) for level in self._reference],
            self._single,
        )
        if not np.all([np.isfinite(level).all(axis=1) for level in answers[1]], axis=0).any():
            raise SceneError("no path is finite at all step sizes: mend the solver, or take more `steps`")
        strong, weak = (
            order if order is None else finite(name, order, above=0)
            for name, order in [("strong", strong), ("weak", weak)]
        )
        said = (strong, weak, keeps, same_step)
        found = _core.judge(self.scene, self._sizes, answers, self._seconds, said, how(None, False))
        return Report(self.scene, found)


def one_step(step: Callable[..., Any]) -> Callable[..., Any]:
    """A solver of a one-step map: ``step(y, dt, dW)`` gives the state after a step, for all paths at
    once; with ``areas=True`` in :meth:`Referee.judge` it is ``step(y, dt, dW, areas, H)``."""

    def solver(y: Any, dt: float, *noise: Any) -> Any:
        for now in zip(*noise, strict=True):
            y = step(y, dt, *now)
        return y

    solver.same_step = True  # type: ignore[attr-defined]
    return solver


class Seeds(dict[str, bool]):
    """Each check of :func:`verify_seeds` with whether it held."""

    def __init__(self, found: dict[str, bool], words: list[str]) -> None:
        super().__init__(found)
        self._words = words

    def __bool__(self) -> bool:
        return all(self.values())

    def __repr__(self) -> str:
        return "\n".join(self._words)


def verify_seeds(solver: Callable[..., Any], *, paths: int = 64, seed: int = 1, threads: int = 4) -> Seeds:
    """Whether the random numbers of a solver follow from its seed alone.

    ``solver(seed, paths)`` gives the states of the paths of these numbers, an array whose first axis
    is the path. It is called twice, with another seed, and with the paths in two chunks in the other
    order. If it has an argument ``threads`` it is called with one and with several, if it has
    ``steps`` and ``state`` half of the way and then the rest: ``solver(seed, paths, steps=(0.5, 1.0),
    state=before)`` goes on from what ``steps=(0.0, 0.5)`` gave. All that has to agree has to agree to
    the bit; with another seed, and of other paths, no numbers may be the same.
    """
    # Half of them is compared with the other half.
    numbers = np.arange(whole("paths", paths, 2, 10**6))
    threads = whole("threads", threads)
    known = inspect.signature(solver).parameters
    found: dict[str, bool] = {}
    words: list[str] = []

    def call(seed: int, numbers: NDArray[np.intp], **more: Any) -> NDArray[Any]:
        y = np.asarray(solver(seed, numbers, **more))
        if y.dtype == object or y.ndim == 0 or len(y) != len(numbers):
            raise SceneError(f"solver(seed, paths) has no row for each of {len(numbers)} paths: {y!r:.60}")
        if not np.isfinite(y).any():
            raise SceneError("all states are NaN or infinite")
        return y.reshape(len(y), -1)

    def apart(what: str, a: NDArray[Any], b: NDArray[Any]) -> None:
        rows = {row.tobytes() for row in a}
        same = sum(row.tobytes() in rows for row in b)
        found[what] = not same
        words.append(f"{what}: {f'refuted, {same} of {len(b)} paths are the same' if same else 'holds'}")

    def check(what: str, a: NDArray[Any], b: NDArray[Any]) -> None:
        wrong = int((~((a == b) | ((a != a) & (b != b))).all(axis=1)).sum())
        found[what] = not wrong
        words.append(f"{what}: {f'refuted, {wrong} of {len(a)} paths differ' if wrong else 'holds'}")

    first = call(seed, numbers)
    check("same seed, same bits", first, call(seed, numbers))
    apart("another seed, other numbers", first, call(seed + 1, numbers))
    half = len(numbers) // 2
    apart("another path, other numbers", first[:half], first[half:])
    parts = [call(seed, part) for part in (numbers[half:], numbers[:half])]
    check("chunks in another order", first, np.concatenate(parts[::-1]))
    if "threads" in known:
        check(f"1 and {threads} threads", *(call(seed, numbers, threads=n) for n in (1, threads)))
        other = call(seed + 1, numbers, threads=threads)
        apart(f"another seed on {threads} threads", first, other)
    if {"steps", "state"} <= set(known):
        before = solver(seed, numbers, steps=(0.0, 0.5), state=None)
        check("restart in the middle", first, call(seed, numbers, steps=(0.5, 1.0), state=before))
    for argument in ("threads", "state"):
        if argument not in known:
            words.append(f"not tested: it has no argument `{argument}`")
    return Seeds(found, words)
