"""Formulas of scenes from Python: strings, numbers, and expressions of SymPy."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Mapping
from numbers import Real
from os import PathLike, fspath
from typing import Any

import numpy as np

from ._errors import SceneError

# SymPy's name of a function, and that of the grammar.
_FUNCTIONS = {
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "exp": "exp",
    "log": "ln",
    "sqrt": "sqrt",
    "Abs": "abs",
    "sinh": "sinh",
    "cosh": "cosh",
    "tanh": "tanh",
    "sinc": "sinc",
    "Min": "min",
    "Max": "max",
}


# The largest whole number of the compiled half.
_WHOLE = 2**63 - 1


def plain(value: Any, key: str = "") -> Any:
    """What JSON has: finite numbers, strings, lists and dictionaries. ``key`` stands in messages."""
    if isinstance(value, (str, bool, np.bool_, int)) or value is None:
        return bool(value) if isinstance(value, np.bool_) else value
    if _is_sympy(value):
        return _matrix(value) if hasattr(value, "tolist") else formula(value)
    if isinstance(value, Mapping):
        return {str(name): plain(v, f"{key}.{name}" if key else str(name)) for name, v in value.items()}
    if isinstance(value, PathLike):
        return fspath(value)
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, Real):
        return finite(key or "a value", value)
    if isinstance(value, (list, tuple, range)):
        return [plain(inner, key) for inner in value]
    # Arrays of NumPy, pandas, JAX and PyTorch.
    if hasattr(value, "tolist") and not isinstance(value, np.generic):
        return plain(value.tolist(), key)
    where = f"`{key}`: " if key else ""
    raise SceneError(
        f"{where}{value!r} has the type {type(value).__name__}: a value is a number, a formula in "
        "quotes, an expression of SymPy, or a list or dictionary of them",
        key or None,
    )


def finite(key: str, value: Any, *, above: float = -math.inf) -> float:
    """A finite number."""
    try:
        number = math.nan if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if math.isfinite(number) and number > above:
        return number
    which = "finite number" if above == -math.inf else f"finite number above {above:g}"
    raise SceneError(f"`{key}` is a {which}, got {value!r}", key)


def whole(key: str, value: Any, least: int = 1, most: int = _WHOLE) -> int:
    """A whole number; 1e6 is one, too."""
    try:
        number = int(value) if isinstance(value, (float, np.floating)) else operator.index(value)
    except (TypeError, ValueError, OverflowError):
        number = least - 1
    if least <= number <= most and number == value and not isinstance(value, bool):
        return number
    which = f"of at least {least}" if most == _WHOLE else f"from {least} to {most}"
    raise SceneError(f"`{key}` is a whole number {which}, got {value!r}", key)


def _matrix(value: Any) -> list[Any]:
    rows = [[plain(entry) for entry in row] for row in value.tolist()]
    # A column or a row is a list.
    if 1 in value.shape:
        return [entry for row in rows for entry in row]
    return rows


def _is_sympy(value: Any) -> bool:
    # Whoever has such a value has imported the package.
    sympy = sys.modules.get("sympy")
    return sympy is not None and isinstance(value, (sympy.Basic, sympy.MatrixBase))


def formula(expression: Any) -> str:
    """An expression of SymPy in the grammar of scenes."""
    return str(_printer().doprint(expression))


def _printer() -> Any:
    from sympy.printing.precedence import PRECEDENCE, precedence
    from sympy.printing.str import StrPrinter

    def refused(what: str) -> SceneError:
        known = ", ".join(sorted(set(_FUNCTIONS.values())))
        return SceneError(f"formulas have no {what}: there are + - * / ^, conditions, and {known}")

    class Printer(StrPrinter):  # type: ignore[misc]
        def _print_Symbol(self, expr: Any) -> str:
            name = str(expr.name)
            if not name.isidentifier():
                raise SceneError(f"the symbol {name!r} is no name: take letters, digits and _")
            return name

        def _print_Pow(self, expr: Any, rational: bool = False) -> str:
            base, power = expr.as_base_exp()
            if str(power) == "1/2":
                return f"sqrt({self._print(base)})"
            if str(power) == "-1/2":
                return f"1/sqrt({self._print(base)})"
            if power == -1:
                return f"1/{self.parenthesize(base, PRECEDENCE['Pow'])}"
            left = self.parenthesize(base, PRECEDENCE["Pow"])
            return f"{left}^{self.parenthesize(power, PRECEDENCE['Pow'])}"

        def _print_Function(self, expr: Any) -> str:
            name = expr.func.__name__
            if name not in _FUNCTIONS:
                raise refused(f"function `{name}`")
            arguments = list(expr.args)
            if name in ("Min", "Max"):
                text = self._print(arguments[0])
                for one in arguments[1:]:
                    text = f"{_FUNCTIONS[name]}({text}, {self._print(one)})"
                return str(text)
            if len(arguments) != 1:
                raise refused(f"`{name}` of {len(arguments)} arguments")
            return f"{_FUNCTIONS[name]}({self._print(arguments[0])})"

        _print_Min = _print_Max = _print_Abs = _print_Function

        def _print_ExpBase(self, expr: Any) -> str:
            return f"exp({self._print(expr.exp)})"

        def _print_Exp1(self, expr: Any) -> str:
            return "exp(1)"

        def _print_Pi(self, expr: Any) -> str:
            return "pi"

        def _print_Float(self, expr: Any) -> str:
            return repr(float(expr))

        def _print_Relational(self, expr: Any) -> str:
            if expr.rel_op not in ("<", "<=", ">", ">="):
                raise refused(f"relation `{expr.rel_op}`")
            left, right = (self.parenthesize(e, precedence(expr)) for e in (expr.lhs, expr.rhs))
            return f"{left} {expr.rel_op} {right}"

        def _print_And(self, expr: Any) -> str:
            return " and ".join(f"({self._print(one)})" for one in expr.args)

        def _print_Or(self, expr: Any) -> str:
            return " or ".join(f"({self._print(one)})" for one in expr.args)

        def _print_Not(self, expr: Any) -> str:
            return f"not ({self._print(expr.args[0])})"

        def _print_Piecewise(self, expr: Any) -> str:
            pieces = list(expr.args)
            if pieces[-1].cond != True:  # noqa: E712
                raise refused("Piecewise without a last piece (value, True)")
            text = self._print(pieces[-1].expr)
            for piece in reversed(pieces[:-1]):
                text = f"if({self._print(piece.cond)}, {self._print(piece.expr)}, {text})"
            return str(text)

        def emptyPrinter(self, expr: Any) -> str:
            raise refused(f"`{type(expr).__name__}`")

        def _refuse(self, expr: Any) -> str:
            raise refused(f"`{type(expr).__name__}`")

        _print_Derivative = _print_Integral = _print_Sum = _print_Product = _refuse
        _print_Infinity = _print_NegativeInfinity = _print_NaN = _print_ImaginaryUnit = _refuse
        _print_ComplexInfinity = _print_Indexed = _print_MatrixElement = _refuse
        _print_Mod = _print_Dummy = _refuse

    return Printer()
