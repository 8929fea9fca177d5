"""Results: names, shapes, closed forms, other packages, files."""

import json
import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

import casimir


def test_paths_have_named_columns(oscillator: casimir.Scene) -> None:
    run = oscillator.run(paths=3)
    assert run["q"].shape == (3, len(run.t)) and run.t[-1] == 2.0
    assert run.initial.tolist() == [[1, 0]] * 3
    assert run.statistics == {} and run.seed == 1 and run.scheme == "sexp-h"
    assert "path 2" in repr(run) and "<table>" in run._repr_html_()
    with pytest.raises(KeyError, match="no column 'x' of paths; there are q, p"):
        run["x"]


def test_a_mean_is_that_of_the_closed_form(oscillator: casimir.Scene) -> None:
    # Without noise in the mean: q'' = −q with both damped, so E q = exp(−γt) cos t.
    run = oscillator.run(paths=20_000, steps=256)
    law, exact = run.statistics["q"], np.exp(-0.1 * run.t) * np.cos(run.t)
    slack = 2.5 * (law.hi - law.lo)  # ten standard errors: an error of steps is far below
    assert np.all(abs(law.mean - exact) <= slack + 1e-12)
    # The twin: another rate is refused.
    wrong = np.exp(-0.2 * run.t) * np.cos(run.t)
    assert np.any(abs(law.mean - wrong) > slack + 1e-12)


def test_an_expectation_contains_the_exact_value(oscillator: casimir.Scene) -> None:
    pytest.importorskip("pandas")
    found = oscillator.expect(accuracy=1e-4)
    exact = np.exp(-0.2) * np.cos(2.0)
    assert found.reached and found["q"].half_width <= 1e-4
    # An interval of 95 % that is four times as wide misses once in 10^14.
    assert abs(found["q"].value - exact) < 4 * found["q"].half_width
    assert list(found) == ["q"] and found.to_pandas().loc["q", "value"] == found["q"].value


def test_derivatives_contain_the_exact_values() -> None:
    scene = casimir.Scene.from_toml(
        """
[system]
state = ["q", "p"]
B = "canonical"
H0 = "w*(q^2 + p^2)/2"
H = ["s*(q^2 + p^2)/2"]
parameters = { w = 1, s = 0.5 }
[run]
initial = [1, 0]
until = 2
steps = 64
"""
    )
    found = scene.expect(of=["q"], accuracy=1e-3, gradient=["s", "w"])
    for parameter, exact in (("s", 0.3240955), ("w", -1.416323)):
        # Two half-widths are missed once in 10^4.
        estimate = found.gradient[parameter]
        low, high = estimate.interval
        assert abs(estimate.value - exact) < 2 * estimate.half_width and low < estimate.value < high
        assert found.gradient["q", parameter] == found.gradient[parameter]
    assert not scene.expect(of=["q"], accuracy=1e-2).gradient
    with pytest.raises(casimir.SceneError, match="no parameter `k`"):
        scene.expect(of=["q"], accuracy=1e-2, gradient=["k"])


def test_averages_over_the_stationary_law(oscillator: casimir.Scene) -> None:
    well = casimir.scene("langevin")
    found = well.equilibrium(accuracy=0.02, parameters={"kT": 1.0})
    assert found.reached and list(found) == ["kinetic", "q^2"]
    # <p²/2m> = kT/2; four half-widths are missed once in 10^14.
    assert abs(found["kinetic"].value - 0.5) < 4 * found["kinetic"].half_width
    assert "density-kinetic" in found.figures and abs(found.data["kT"] - 1.0) < 1e-9
    # What is asked for goes before the wish of the scene.
    exponents = well.with_(expect={"of": ["kinetic"], "accuracy": 9.0}).lyapunov(count=2, accuracy=0.05)
    assert exponents.reached and exponents["λ1"].half_width <= 0.05 == exponents.data["accuracy"]
    assert list(exponents) == ["λ1", "λ2", "their sum"]
    assert abs(exponents["their sum"].value + 1.0) < 1e-6
    with pytest.raises(casimir.SceneError, match="number of exponents"):
        oscillator.lyapunov(count=3)


def test_states_are_those_of_an_array(oscillator: casimir.Scene, tmp_path: Path) -> None:
    states = np.array([[1.0, 0.1 + 0.2], [2.0, -1.0], [0.5, 1e-17]])
    scene = oscillator.with_(initial=states)
    run = scene.run()
    assert run.initial.tobytes() == states.tobytes()
    scene.save(tmp_path / "s.toml")
    again = casimir.Scene(tmp_path / "s.toml").run()
    assert again["q"].tobytes() == run["q"].tobytes()
    assert pickle.loads(pickle.dumps(scene)) == scene
    many = scene.with_(paths=300, tables=7).run()
    assert many.initial.tolist() == [states[i % 3].tolist() for i in range(7)]


def test_a_sweep_has_axes(oscillator: casimir.Scene) -> None:
    pytest.importorskip("xarray")
    sweep = casimir.sweep(oscillator.with_(paths=200), sigma=[0.1, 0.2], k=[1.0, 2.0, 3.0])
    run = sweep.run()
    assert run.statistics["q"].mean.shape == (2, 3, len(run.t))
    quantiles = run.statistics["q"].quantiles
    assert quantiles is not None and quantiles.shape == (2, 3, len(run.t), 5)
    alone = oscillator.run(paths=200, parameters={"sigma": 0.2, "k": 3.0})
    assert quantiles[1, 2].tobytes() == np.asarray(alone.statistics["q"].quantiles).tobytes()
    assert run.statistics["q"].mean[1, 2].tobytes() == alone.statistics["q"].mean.tobytes()
    data = run.to_xarray()
    assert data["q mean"].dims == ("sigma", "k", "t") and data.sizes["k"] == 3
    assert data.sel(sigma=0.2, k=3.0)["q mean"].values[-1] == run.statistics["q"].mean[1, 2, -1]
    frame = run.to_pandas()
    assert len(frame) == 2 * 2 * 3 * len(run.t)
    rows = frame[(frame.observable == "q") & (frame.sigma == 0.1) & (frame.k == 3.0)]
    assert np.array_equal(rows["t"], run.t) and np.array_equal(rows["mean"], run.statistics["q"].mean[0, 2])
    assert np.array_equal(rows["q0.05"], quantiles[0, 2, :, 0]) and (rows["q0.05"] <= rows["q0.95"]).all()
    other = casimir.sweep(oscillator.with_(paths=200), independent=True, sigma=[0.1, 0.2]).run()
    assert other.statistics["q"].mean[1, -1] != run.statistics["q"].mean[1, 0, -1]


def test_all_warnings_are_told(oscillator: casimir.Scene) -> None:
    run = oscillator.run(paths=200, until=40, steps=64, parameters={"sigma": 3.0}, scheme="heun")
    assert len(run.warnings) >= 2 and [w._asdict() for w in run.warnings] == run.data["warnings"]


def test_orders_and_comparisons(oscillator: casimir.Scene) -> None:
    order = oscillator.order(path_steps=3e6)
    assert order.strong == 2.0 and set(order.weak) == {"E[q]"} and set(order.figures) == {"strong", "weak"}
    compared = oscillator.compare(error=1e-2, budget=2)
    assert "sexp" in compared.text and compared.plot("compare").svg.startswith("<svg")
    assert "canonical" in repr(casimir.System(state="q p", B="canonical", H0="q"))
    assert "Casimirs" in oscillator.inspect().text and not oscillator.inspect().warnings


def test_every_result_is_pickled(oscillator: casimir.Scene) -> None:
    for result in (oscillator.run(), oscillator.expect(), oscillator.inspect()):
        again = pickle.loads(pickle.dumps(result))
        assert repr(again) == repr(result) and again.scene == result.scene
        assert json.dumps(again.data) == json.dumps(result.data)


def test_files(oscillator: casimir.Scene, tmp_path: Path) -> None:
    run = oscillator.run(paths=120)
    run.save(tmp_path / "r.npz")
    with np.load(tmp_path / "r.npz") as arrays:
        assert {key: arrays[key].tobytes() for key in arrays.files if key != "casimir"} == {
            key: array.tobytes() for key, array in run.arrays.items()
        }
    run.save(tmp_path / "r.html")
    assert "Oscillator" in (tmp_path / "r.html").read_text()
    run.plot("q").save(tmp_path / "q.svg")
    alike = oscillator.with_(observe={"q+p": "q + p", "q-p": "q - p"}).run(paths=2)
    assert "q - p" not in alike.plot("q+p").svg and alike.plot("q+p").svg != alike.plot("q-p").svg
    assert (tmp_path / "q.svg").read_text().startswith("<svg")
    with pytest.raises(casimir.SceneError, match=r"written as \.npz or \.html"):
        run.save(tmp_path / "r.csv")


def test_an_interrupted_run_has_equal_times(oscillator: casimir.Scene) -> None:
    pytest.importorskip("xarray")
    run = oscillator.run(paths=120)
    run.paths["q"] = run["q"][:, :3]
    assert run.to_xarray()["q"].shape == (3, len(run.t))


def test_matplotlib_draws_where_it_is_told(oscillator: casimir.Scene) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    assert oscillator.run(paths=120).plot("q", ax=ax) is ax and ax.get_ylabel() == "q"
    assert len(oscillator.run(paths=2).plot("q", ax=ax).lines) == 3
    sweep = casimir.sweep(oscillator.with_(paths=120), k=[2.0, 1.0]).run()
    _, ax = pyplot.subplots()
    assert sweep.plot("q", ax=ax).get_xlabel() == "k"
    assert np.array_equal(ax.lines[0].get_xdata(), [1.0, 2.0])


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_a_missing_package_is_named(
    package: str, oscillator: casimir.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    run = oscillator.run()
    with pytest.raises(ImportError, match=f"pip install {package}") as raised:
        run.to_pandas() if package == "pandas" else run.to_xarray()
    assert raised.value.name == package
