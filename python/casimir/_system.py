"""Systems of one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from ._changes import ChangesBesideSpan, explicit
from ._errors import SceneError
from ._formulas import plain
from ._scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

Formula = Any
"""A number, a formula in quotes, or an expression of SymPy."""


@explicit
class System:
    """dy = (B∇H0 − γy)dt + Σ B∇Hm ∘ dWm from formulas: strings, or expressions of SymPy.

    Or dy = (drift − γy)dt + Σ noise_m dW_m by ``drift`` and ``noise`` without ``B``, ``H0`` and
    ``H``.

    ``state`` names the components. ``B`` is the structure matrix: all rows, the entries above the
    diagonal, or blocks such as ``"canonical"`` and ``"spins(s1, s2)"``. ``H0`` is the Hamiltonian,
    ``H`` one for each noise. ``damping`` is the rate γ, which may depend on ``t``, or
    the table of a scene: ``{"rates": {"p": 0.5}}``. ``bath`` is a table or a list of tables:
    ``{"temperature": 1.0, "friction": {"p": 0.5}}``.

    ``calculus`` is the sense of ``drift`` and the fields ``noise``: ``"stratonovich"``, unless it
    is ``"ito"``. Beside B and H they are compared with these: what differs is named.

    >>> import casimir
    >>> oscillator = casimir.System(state="q p", B="canonical", H0="(q^2 + p^2)/2", H=["0.1*q"])
    >>> oscillator.scene(initial=[1, 0], until=1, steps=64).run(paths=3)["q"].shape
    (3, 65)
    """

    def __init__(
        self,
        state: str | Sequence[Any],
        B: Formula | None = None,
        H0: Formula | None = None,
        H: Formula | Sequence[Formula] = (),
        parameters: Mapping[Any, float] | None = None,
        *,
        damping: Formula | Mapping[str, Any] | None = None,
        bath: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        calculus: str | None = None,
        drift: Sequence[Formula] | None = None,
        noise: Sequence[Sequence[Formula]] | None = None,
        title: str | None = None,
    ) -> None:
        given = {"B": B, "H0": H0}
        alone = drift is not None and B is None and H0 is None
        for key, value in [("state", state), *([] if alone else given.items())]:
            if value is None:
                raise SceneError(f"`{key}` is missing", f"system.{key}")
        names = state.replace(",", " ").split() if isinstance(state, str) else plain(state, "system.state")
        system: dict[str, Any] = {"state": names}
        system |= {key: plain(value, f"system.{key}") for key, value in given.items() if value is not None}
        structure = system.get("B")
        if isinstance(structure, list) and not all(isinstance(row, list) for row in structure):
            raise SceneError("B is a matrix: a list of rows, each a list, or blocks in quotes")
        noises = plain(() if H is None else H, "system.H")
        if noises := noises if isinstance(noises, list) else [noises]:
            system["H"] = noises
        if parameters:
            system["parameters"] = plain(parameters, "system.parameters")
        for key, value in [("calculus", calculus), ("drift", drift), ("noise", noise)]:
            if value is not None:
                system[key] = plain(value, f"system.{key}")
        self._tables: dict[str, Any] = {"system": system}
        if title is not None:
            self._tables["title"] = title
        if damping is not None:
            table = damping if isinstance(damping, Mapping) else {"rate": damping}
            self._tables["damping"] = plain(table, "damping")
        if bath is not None:
            self._tables["bath"] = plain(bath, "bath")

    def scene(
        self, *, initial: Any, until: Any, steps: float, **changes: Unpack[ChangesBesideSpan]
    ) -> Scene:
        """The system with its initial value and what is wanted, as :meth:`Scene.with_` takes it."""
        run = {"initial": [0.0], "until": plain(until, "run.until"), "steps": plain(steps, "run.steps")}
        return Scene.unchecked({**self._tables, "run": run}).with_(initial=initial, **changes)

    def __repr__(self) -> str:
        system = self._tables["system"]
        if "B" not in system:
            return f"System({' '.join(system['state'])}; drift = {system['drift']}, noise = {system.get('noise', [])})"
        noises = ", ".join(map(str, system.get("H", [])))
        return f"System({' '.join(system['state'])}; B = {system['B']}, H0 = {system['H0']}, H = [{noises}])"

    def _repr_html_(self) -> str:
        rows = ((key, _shown(value)) for key, value in self._flat())
        cells = (f"<tr><th>{escape(a)}</th><td>{escape(b)}</td></tr>" for a, b in rows)
        return f"<table>{''.join(cells)}</table>"

    def _flat(self) -> list[tuple[str, Any]]:
        return [*self._tables["system"].items(), *((k, v) for k, v in self._tables.items() if k != "system")]


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} = {_shown(one)}" for key, one in value.items())
    return ", ".join(map(_shown, value)) if isinstance(value, list) else str(value)
