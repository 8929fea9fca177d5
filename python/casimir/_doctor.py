"""Facts for reports of faults."""

import platform

import numpy as np

from . import _core


def doctor() -> bool:
    """Prints facts about the package and this machine, and tests known results; whether all hold."""
    text, holds = _core.doctor()
    print(f"Python        {platform.python_version()}, NumPy {np.__version__}")
    print(text, end="")
    print("To report a fault, attach this text, the code, and what should have come out.")
    return holds
