"""Progress of long calls, shown by the thread that waits."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import NamedTuple

from ._errors import SceneError
from ._formulas import whole

# Most threads that may be asked for, and that are started for each processor: more only wait for
# each other, and let an interrupt wait.
_MOST_THREADS, _EACH = 1024, 4


class How(NamedTuple):
    """How a call is made."""

    threads: int | None
    show: Callable[[str], None] | None
    folder: str | None
    gpu: bool = False


def how(
    threads: int | None,
    progress: bool,
    folder: str | os.PathLike[str] | None = None,
    on: str = "cpu",
) -> How:
    """Threads, what shows progress, a folder for unfinished work, and a machine for paths."""
    if on not in ("cpu", "gpu"):
        raise SceneError(f"`on` is 'cpu' or 'gpu', got {on!r}")
    if folder is not None and not isinstance(folder, (str, os.PathLike)):
        raise SceneError(f"`resume` is the name of a folder, got {type(folder).__name__}")
    if threads is not None:
        threads = min(whole("threads", threads, 1, _MOST_THREADS), _EACH * (os.cpu_count() or 1))
    to = None if folder is None else os.fspath(folder)
    return How(threads, _shown() if progress else None, to, on == "gpu")


def _shown() -> Callable[[str], None] | None:
    if "IPython" in sys.modules:
        from IPython import get_ipython

        shell = get_ipython()
        if shell is not None and hasattr(shell, "kernel"):
            return _notebook()
    return _terminal if sys.stderr is not None and sys.stderr.isatty() else None


def _terminal(words: str) -> None:
    sys.stderr.write(f"\r\x1b[K{words}")
    sys.stderr.flush()


def _notebook() -> Callable[[str], None]:
    from IPython.display import display

    shown: list[object] = []

    def show(words: str) -> None:
        data = {"text/plain": words}
        if shown:
            shown[0].update(data, raw=True)  # type: ignore[attr-defined]
        elif words:
            shown.append(display(data, raw=True, display_id=True))  # type: ignore[no-untyped-call]

    return show
