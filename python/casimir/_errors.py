"""What goes wrong, as exceptions."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene, a system or an argument is wrong. The text says what would be right.

    ``key`` is the key of the scene, such as ``"run.steps"``; ``line`` and ``column`` count from one
    in ``scene.to_toml()``. They are ``None`` where nothing in the text is to blame.
    """

    def __init__(
        self,
        message: str,
        key: str | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        super().__init__(message)
        self.key, self.line, self.column = key, line, column

    def __reduce__(self) -> tuple[type[SceneError], tuple[object, ...]]:
        return type(self), (str(self), self.key, self.line, self.column)


class RunError(RuntimeError):
    """A computation failed."""

    def __init__(self, message: str, *_: object) -> None:
        super().__init__(message)


def missing(package: str, why: str) -> ImportError:
    """An optional package is not installed."""
    return ImportError(f"{why} needs {package}: pip install {package}", name=package)
