"""Scenes: from files, dictionaries and SymPy; changed; wrong."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import casimir

SYSTEM = {"state": ["q", "p"], "B": "canonical", "H0": "(p^2 + q^2)/2", "H": ["a*q"], "parameters": {"a": 0.1}}
RUN = {"initial": [1, 0], "until": 1, "steps": 64}


def test_one_scene_in_three_ways(tmp_path: Path) -> None:
    scene = casimir.Scene({"system": SYSTEM, "run": RUN})
    (tmp_path / "s.toml").write_text(scene.to_toml())
    others = casimir.Scene(tmp_path / "s.toml"), casimir.Scene.from_toml(scene.to_toml())
    values = {one.run()["q"].tobytes() for one in (scene, *others, casimir.Scene(scene.to_dict()))}
    assert len(values) == 1


def test_changes_keep_the_comments() -> None:
    scene = casimir.scene("rigid-body").with_(steps=400, observe={"sum": "y1 + y2"})
    assert "# the mean of the rate is zero" in scene.to_toml() and "steps = 400" in scene.to_toml()
    assert "sum" in scene.observables
    assert casimir.scene("rigid-body").to_dict()["run"]["steps"] == 800
    assert scene.with_(observe={"sum": None}).observables == ["y1", "y2", "y3"]
    assert scene.with_(damping="0.5*t").to_dict()["damping"] == {"rate": "0.5*t"}


def test_every_scene_of_the_gallery_goes_through_a_dictionary() -> None:
    for name in casimir.scenes():
        scene = casimir.scene(name)
        again = casimir.Scene(scene.to_dict())
        assert again.components == scene.components and again.observables == scene.observables


def test_numbers_of_numpy_are_numbers() -> None:
    scene = casimir.Scene({"system": SYSTEM, "run": RUN})
    changed = scene.with_(initial=np.array([0.1, 0.2]), until=np.float64(2), steps=np.int64(32))
    assert changed.to_dict()["run"]["initial"] == [0.1, 0.2]
    assert changed.with_(parameters={"a": 1e-300}).to_dict()["system"]["parameters"]["a"] == 1e-300


def test_sympy_is_printed_to_the_grammar() -> None:
    sympy = pytest.importorskip("sympy")
    from casimir._formulas import formula

    x, y = sympy.symbols("x y", real=True)
    rng = np.random.default_rng(1)
    expressions = [
        x**2 / 3 - y**3 + sympy.Rational(2, 7),
        sympy.sqrt(1 + x**2) + 1 / sympy.sqrt(2 + y**2) + (x**2 + 1) ** -3,
        sympy.exp(-x) * sympy.log(2 + y**2) + sympy.pi + sympy.E,
        sympy.sin(x) * sympy.cosh(y) - sympy.tanh(x * y) / (1 + sympy.Abs(x)),
        -((-x) ** 3) + 2**x - (-y) ** 2,
        sympy.Max(x, y, 0.25) - sympy.Min(x, y),
        sympy.Piecewise((x, x > y), (y**2, sympy.And(x < 0, y > 0)), (1.5, True)),
        # Both conditions hold at some of the points.
        sympy.Piecewise((x, x + y < 1), (y, x - y < 1), (1.5, True)),
        sympy.Max(x, y, x + y) - sympy.Min(x, y, x - y),
        sympy.Piecewise((x, sympy.Or(x > 0, y > 0)), (1.5, True)),
    ]
    for expression in expressions:
        system = casimir.System(state="x y", B="canonical", H0="x")
        texts = {"value": formula(expression)}
        for point in rng.normal(size=(5, 2)):
            scene = system.scene(initial=point, until=1, steps=1, observe=texts)
            expected = float(expression.subs({x: point[0], y: point[1]}))
            assert scene.run()["value"][0, 0] == pytest.approx(expected, rel=1e-12)


def test_what_the_grammar_lacks_is_named() -> None:
    sympy = pytest.importorskip("sympy")
    q, p = sympy.symbols("q p")
    for wrong, name in [
        (sympy.gamma(q), "function `gamma`"),
        (sympy.Function("f")(q), "function `f`"),
        (sympy.Integral(q, p), "`Integral`"),
        (sympy.I * q, "`ImaginaryUnit`"),
        (sympy.Symbol("q 1"), "'q 1' is no name"),
    ]:
        with pytest.raises(casimir.SceneError, match=name):
            casimir.System(state=[q, p], B="canonical", H0=wrong)


def test_an_equation_of_ito_is_compared() -> None:
    given: dict[str, Any] = {"state": "x y", "B": [[0, 1], [-1, 0]], "H0": "0", "H": ["a*(x^2 + y^2)/2"]}
    given |= {"parameters": {"a": 0.5}, "calculus": "ito", "noise": [["a*y", "-a*x"]]}
    changes: dict[str, Any] = {"initial": [1, 0], "until": 1, "steps": 64}
    casimir.System(**given, drift=["-a^2/2*x", "-a^2/2*y"]).scene(**changes)
    with pytest.raises(casimir.SceneError, match="this drift is") as raised:
        casimir.System(**given, drift=["-a^2/2*x", "-a^2*y"]).scene(**changes)
    assert raised.value.key == "system.drift"


def test_an_equation_may_be_all_there_is() -> None:
    sympy = pytest.importorskip("sympy")
    x, r = sympy.symbols("x r")
    system = casimir.System([x], drift=[r * x], noise=[[x / 2]], calculus="ito", parameters={r: 0.5})
    assert repr(system).startswith("System(x; drift = ['r*x'], noise = [['")
    found = system.scene(initial=[1], until=1, steps=64).expect(of=["x"], accuracy=0.01)
    assert abs(found["x"].value - math.exp(0.5)) < 2.5 * found["x"].half_width
    wrong: list[dict[str, Any]] = [{"H0": "x"}, {"B": "canonical"}, {"drift": None}]
    for changes in wrong:
        with pytest.raises(casimir.SceneError, match="is missing"):
            casimir.System("x", **{"drift": ["x"], **changes})


def changed(table: str, key: str, value: Any) -> dict[str, Any]:
    tables: dict[str, Any] = {"system": dict(SYSTEM), "run": dict(RUN)}
    tables.setdefault(table, {})[key] = value
    return tables


# What is wrong, the key that is named, and what stands in the text.
WRONG: list[tuple[dict[str, Any], str | None, str]] = [
    (changed("run", "steps", 0), "run.steps", "not a whole number"),
    (changed("run", "steps", 2.5), "run.steps", "not a whole number"),
    (changed("run", "until", -1), "run.until", "must be positive"),
    (changed("run", "until", "1 +"), "run.until", "is missing at the end"),
    (changed("run", "initial", [1]), "run.initial", "2 components"),
    (changed("run", "initial", ["w", 0]), "run.initial", "unknown name `w`"),
    (changed("run", "initial", [True, 0]), "run.initial", "expected a number or a formula"),
    (changed("run", "initial", "nowhere.csv"), "run.initial", "cannot read the states"),
    (changed("run", "times", 7), "run.times", "do not divide"),
    (changed("run", "scheme", "hein"), "run.scheme", "heun"),
    (changed("run", "path", 3), "run.path", "paths"),
    (changed("run", "seed", -1), "run.seed", ""),
    (changed("run", "columns", ["r"]), "run.columns", "no column `r`"),
    (changed("system", "H0", "p^2/2 + cosh(q"), "system.H0", ""),
    (changed("system", "H0", "p^2/2 + w*q"), "system.H0", "unknown name `w`"),
    (changed("system", "H0", "if(q > 0, q, 0)"), "system.H0", ""),
    (changed("system", "H", ["a*z"]), "system.H", "unknown name `z`"),
    (changed("system", "B", [["0", "1"], ["1", "0"]]), "system.B", ""),
    (changed("system", "B", "canonica"), "system.B", "canonical"),
    (changed("system", "state", ["q", "q"]), "system.state", "`q`"),
    (changed("system", "state", ["q"]), None, ""),
    (changed("system", "parameters", {"a": "1/0"}), "system.parameters.a", "division by zero"),
    (changed("system", "parameters", {"b": 1}), "system.H", "unknown name `a`"),
    (changed("system", "energy", "q"), "system.energy", "unknown key"),
    (changed("damping", "rate", "q"), "damping.rate", "q"),
    (changed("observe", "q", "p"), "observe.q", "already"),
    (changed("observe", "x", "1/(q - 1)"), "observe.x", "initial value"),
    (changed("probabilities", "up", "q"), "probabilities.up", "a condition"),
    (changed("events", "out", "q +"), "events.out", ""),
    (changed("expect", "of", []), None, ""),
    (changed("sweep", "b", [1, 2]), "sweep.b", "no parameter `b`"),
    (changed("figures", "show", ["nothing"]), "figures.show", "no column"),
    ({"system": SYSTEM}, None, "run"),
    ({"run": RUN}, None, "system"),
    ({"sytem": SYSTEM, "run": RUN}, "sytem", "system"),
]


@pytest.mark.parametrize(("tables", "key", "words"), WRONG)
def test_wrong_scenes_are_refused_with_their_place(
    tables: dict[str, Any], key: str | None, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(casimir.SceneError) as raised:
        casimir.Scene(tables).run()
    assert words in str(raised.value) and list(tmp_path.iterdir()) == []
    if key is not None:
        assert (raised.value.key or "").startswith(key)
        text = casimir.Scene.unchecked(tables).to_toml().splitlines()
        assert raised.value.line is not None and raised.value.column is not None
        assert raised.value.column <= len(text[raised.value.line - 1]) + 1


def test_columns_are_counted_in_letters() -> None:
    text = '[system]\nstate = ["q", "p"]\nparameters = { "γ" = 1 }\nB = "canonical"\nH0 = "γ*q + γ*w"\n'
    with pytest.raises(casimir.SceneError) as raised:
        casimir.Scene.from_toml(text + "[run]\ninitial = [1, 0]\nuntil = 1\nsteps = 4\n")
    assert (raised.value.line, raised.value.column) == (5, text.splitlines()[4].index("w") + 1)


def test_wrong_arguments(oscillator: casimir.Scene) -> None:
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: oscillator.run(step=4), "do you mean `steps`"),  # type: ignore[call-arg]
        (lambda: oscillator.run(threads=0), "from 1 to 1024, got 0"),
        (lambda: oscillator.run(initial=[[1.0, float("nan")]]), "finite"),
        (lambda: oscillator.run(initial=[[1.0], [2.0]]), "2 components"),
        (lambda: oscillator.run(steps=object()), "has the type object"),  # type: ignore[arg-type]
        (lambda: oscillator.expect(accuracy=-1), "positive"),
        (lambda: oscillator.compare(error=0.0), "above 0, got 0"),
        (lambda: casimir.scene("rigid"), "no scene `rigid`"),
        (lambda: casimir.Scene("nowhere.toml"), "cannot read the scene"),
        (lambda: casimir.Scene("[run]\n"), "from_toml"),
        (lambda: casimir.sweep(oscillator), "nothing is varied"),
        (lambda: casimir.sweep(oscillator, m=[1.0]).run(), "no parameter `m`"),
        (lambda: casimir.sweep(oscillator, k=["one"]), "are numbers"),  # type: ignore[list-item]
    ]
    for call, words in calls:
        with pytest.raises(casimir.SceneError, match=words):
            call()


def test_a_run_that_fails_is_no_scene_that_is_wrong() -> None:
    explodes = casimir.System(state="x y", B="canonical", H0="x^3*y^2", H=["50*x*y"])
    scene = explodes.scene(initial=[3, 3], until=50, steps=64, scheme="heun")
    with pytest.raises(casimir.RunError, match="all paths failed"):
        scene.run()


def test_what_a_new_user_tried(oscillator: casimir.Scene, tmp_path: Path) -> None:
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: casimir.sweep(oscillator, k=[1, 1, 2]), "a value twice"),
        (lambda: oscillator.run(parameters={"kk": 3}), "no parameter `kk`.*do you mean `k`"),
        (lambda: casimir.sweep(oscillator, sgima=[0.1]), "no parameter `sgima`.*`sigma`"),
        (lambda: casimir.sweep(oscillator, k=[1, 2]).run(parameters={"k": 5}), "varied already"),
        (lambda: oscillator.run(initial=np.array([[1j, 0]])), "complex"),
        (lambda: oscillator.run(threads="2"), "whole number"),  # type: ignore[arg-type]
        (lambda: oscillator.with_(H0="q"), "write system="),  # type: ignore[call-arg]
        (lambda: oscillator.with_(observe=["q"]), "`observe` is a dictionary"),  # type: ignore[arg-type]
        (lambda: oscillator.with_(parameters=3), "`parameters` is a dictionary"),  # type: ignore[arg-type]
        (lambda: casimir.Scene(casimir.System("q p", "canonical", "q")), "call its .scene"),  # type: ignore[arg-type]
        (lambda: oscillator.run().plot("q").save(tmp_path / "q.png"), "written as .svg"),
    ]
    for call, words in calls:
        with pytest.raises(casimir.SceneError, match=words):
            call()
    assert repr(oscillator) == "Scene 'Oscillator': q, p; 1 path to t = 2 in 128 steps"
    assert "damping" not in oscillator.with_(damping=None).to_dict()
    assert list(oscillator.run()) == ["q", "p"] and "q" in oscillator.run()
    assert oscillator.with_(of="p").expect(accuracy=0.1)["p"].half_width <= 0.1


def test_states_are_a_scene_s_own(oscillator: casimir.Scene, tmp_path: Path) -> None:
    states = np.array([[1.0, 0], [2, 0]])
    one, other = oscillator.with_(initial=states), oscillator.with_(initial=states + 4)
    states[0, 0] = 7
    assert one.run().initial[0, 0] == 1.0
    one.save(tmp_path / "one.toml")
    other.save(tmp_path / "other.toml")
    assert casimir.Scene(tmp_path / "one.toml").run().initial.tolist() == [[1, 0], [2, 0]]
    assert casimir.Scene(one.to_dict()).run().initial.tolist() == [[1, 0], [2, 0]]


def test_a_bath_is_a_table_or_several() -> None:
    table = {"friction": {"p": 0.5}, "temperature": 1.5}
    system = casimir.System(state="q p", B="canonical", H0="(p^2 + q^2)/2", bath=table)
    scene = system.scene(initial=[1, 0], until=4, steps=64)
    assert scene.inspect().data["bath"]["beta"] == pytest.approx(1 / 1.5, abs=1e-9)
    assert "H = []" in repr(system)
    tables = [{"temperature": kt, "through": [phi]} for kt, phi in [(1.0, "q"), (2.0, "q*q/2")]]
    system = casimir.System(state="q p", B="canonical", H0="(p^2 + q^2)/2", bath=tables)
    found = system.scene(initial=[1, 0], until=4, steps=64).inspect()
    assert found.data["bath"]["beta"] is None
