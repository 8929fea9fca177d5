"""Tables, datasets, files and axes of all that a result has."""

import inspect
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import casimir

CORRELATED: dict[str, Any] = {"paths": 200, "until": 20, "steps": 640, "times": 64}
CORRELATED["statistics"] = {"autocorrelation": ["q"], "pairs": [["q", "p"]]}


@pytest.fixture
def pyplot() -> Any:
    pytest.importorskip("matplotlib").use("Agg")
    from matplotlib import pyplot

    return pyplot


def test_tables_have_one_shape(oscillator: casimir.Scene) -> None:
    pytest.importorskip("pandas")
    few, many = (oscillator.run(paths=paths).to_pandas() for paths in (3, 200))
    assert list(few.columns) == list(many.columns) and len(few) == len(many)
    run = oscillator.run(paths=3)
    rows = few[few.observable == "p"]
    assert np.allclose(rows["mean"], run["p"].mean(axis=0)) and rows["lo"].isna().all()
    assert np.allclose(rows["deviation"], run["p"].std(axis=0, ddof=1))
    paths = run.to_pandas("path")
    assert paths.index.names == ["path", "t"] and np.array_equal(paths["q"], run["q"].ravel())
    assert np.array_equal(run.ends["q"], run["q"][:, -1])
    assert len(oscillator.run(paths=200).to_pandas("path")) == 3 * len(run.t)


def test_histograms_and_variances(oscillator: casimir.Scene) -> None:
    short = oscillator.with_(steps=32, times=4)
    run = short.run(paths=20_000)
    counts, edges = run.histograms["q"]
    assert len(edges) == len(counts) + 1 and 0.99 * 20_000 < counts.sum() <= 20_000
    middle, law = (edges[1:] + edges[:-1]) / 2, run.statistics["q"]
    assert abs((counts * middle).sum() / counts.sum() - law.mean[-1]) < 0.02 * law.deviation[-1]
    # Five standard errors of 20 000 paths; those of 100 000 of another seed are half as large.
    other = short.run(paths=100_000, seed=2).statistics["q"].variance[-1]
    width = law.variance_hi[-1] - law.variance_lo[-1]
    assert law.variance_lo[-1] < law.variance[-1] < law.variance_hi[-1] and width < 0.1 * other
    assert abs(law.variance[-1] - other) < 1.5 * width
    assert oscillator.run(paths=2).histograms == {}


def test_all_is_in_datasets(oscillator: casimir.Scene, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    run = oscillator.run(**CORRELATED)
    data = run.to_xarray()
    name = "joint(q, p)"
    assert data[name].dims == (f"{name} x", f"{name} y") and data["q histogram"].dims == ("q bin",)
    assert np.array_equal(data[name], run.joint[name]) and data["spectrum(q) mean"].dims == ("omega",)
    swept = casimir.sweep(oscillator, k=[2.0], sigma=[0.1, 0.2]).run(**CORRELATED)
    assert swept.to_xarray()["q edges"].dims == ("k", "sigma", "q edge")
    assert swept.to_xarray()["autocorrelation(q) mean"].dims == ("k", "sigma", "lag")
    pytest.importorskip("netCDF4")
    data.to_netcdf(tmp_path / "r.nc")
    with xarray.open_dataset(tmp_path / "r.nc") as again:
        assert again.identical(data) and again.attrs["seed"] == "1"


def test_tables_of_laws(oscillator: casimir.Scene) -> None:
    pytest.importorskip("pandas")
    run = oscillator.run(**CORRELATED)
    joint = run.to_pandas("joint(q, p)")
    assert joint["count"].sum() == run.joint["joint(q, p)"].sum() and (joint["x lo"] < joint["x hi"]).all()
    ends = run.to_pandas("end")
    assert ends[ends.observable == "q"]["count"].sum() == run.histograms["q"].counts.sum()
    assert set(run.to_pandas("lag").observable) == {"autocorrelation(q)"}
    with pytest.raises(casimir.SceneError, match=r"'t', 'end', 'lag', 'omega', 'path', 'joint\(q, p\)'"):
        run.to_pandas("time")


def test_a_result_is_loaded_from_its_file(oscillator: casimir.Scene, tmp_path: Path) -> None:
    states = np.array([[1.0, 0.1 + 0.2], [2.0, -1.0]])
    for scene in (oscillator.with_(paths=120), oscillator.with_(initial=states)):
        run = scene.run()
        run.save(tmp_path / "r.npz")
        again = casimir.load(tmp_path / "r.npz")
        assert again.arrays.keys() == run.arrays.keys() and again.scene == run.scene
        assert all(again.arrays[key].tobytes() == run.arrays[key].tobytes() for key in run.arrays)
        assert repr(again) == repr(run) and again.data == run.data and again.page == run.page
        assert again.figures["time-q"].svg == run.figures["time-q"].svg
        assert pickle.loads(pickle.dumps(again)).statistics.keys() == run.statistics.keys()
    swept = casimir.sweep(oscillator.with_(paths=120), k=[1.0, 2.0]).run()
    swept.save(tmp_path / "s.npz")
    assert casimir.load(tmp_path / "s.npz").parameters["k"].tolist() == [1.0, 2.0]
    np.savez(tmp_path / "n.npz", a=np.zeros(3))
    with pytest.raises(casimir.SceneError, match="arrays without their scene"):
        casimir.load(tmp_path / "n.npz")
    for name, content in [("none.npz", None), ("text.npz", "nothing")]:
        if content is not None:
            (tmp_path / name).write_text(content)
        with pytest.raises(casimir.SceneError, match="cannot read the result"):
            casimir.load(tmp_path / name)


def test_a_sweep_of_expectations(oscillator: casimir.Scene, pyplot: Any) -> None:
    sweep = casimir.sweep(oscillator, k=[1.0], sigma=[0.2, 0.1, 0.3])
    found = sweep.expect(of=["q", "q^2"], accuracy=5e-3)
    assert found.reached and list(found) == ["q", "q^2"] and found["q"].value.shape == (1, 3)
    alone = oscillator.with_(parameters={"sigma": 0.1}).expect(of=["q", "q^2"], accuracy=5e-3)
    assert found["q^2"].value[0, 1] == alone["q^2"].value and found["q"].lo[0, 1] == alone["q"].lo
    assert len(found.to_pandas()) == 6 and found.to_xarray()["q lo"].dims == ("k", "sigma")
    ax = found.plot("q", ax=pyplot.figure().gca())
    assert ax.get_xlabel() == "sigma" and ax.lines[0].get_xdata().tolist() == [0.1, 0.2, 0.3]
    assert "sigma" in repr(found) and "<table>" in found._repr_html_()
    apart = casimir.sweep(oscillator, independent=True, sigma=[0.1]).expect(accuracy=5e-3)
    assert apart["q"].value[0] != alone["q"].value


def test_orders_and_comparisons_are_drawn_and_tabled(oscillator: casimir.Scene, pyplot: Any) -> None:
    order = oscillator.order(path_steps=3e6)
    rows = order.to_pandas()
    assert set(rows.kind) == {"strong", "weak"} and (rows.lo <= rows.difference).all()
    assert len(order.plot(ax=pyplot.figure().gca()).lines) == 2
    compared = oscillator.compare(error=1e-2, budget=2)
    assert {"heun", "sexp"} <= set(compared.to_pandas().scheme)
    assert len(compared.plot("heun", ax=pyplot.figure().gca()).lines) == 1
    assert oscillator.expect().plot(ax=pyplot.figure().gca()).has_data()
    run = oscillator.run(**CORRELATED)
    assert run.plot("joint(q, p)", ax=pyplot.figure().gca()).get_title() == "joint(q, p)"
    many = casimir.sweep(oscillator.with_(paths=120), k=[1.0, 2.0, 3.0], sigma=[0.1, 0.2]).run()
    assert len(many.plot("q", ax=pyplot.figure().gca()).lines) == 2


def test_notebooks_show_what_things_are(oscillator: casimir.Scene) -> None:
    system = casimir.System(state="q p", B="canonical", H0="p^2/2 < q", H=["q"], parameters={"k": 1.0})
    assert "<th>H0</th><td>p^2/2 &lt; q</td>" in system._repr_html_()
    assert "[system]" in oscillator._repr_html_() and "steps" in oscillator._repr_html_()
    assert "<th>k</th><td>1, 2</td>" in casimir.sweep(oscillator, k=[1, 2])._repr_html_()


def test_signatures_have_all_keys_of_scenes(oscillator: casimir.Scene) -> None:
    from casimir._changes import OPTIONS, HowArguments
    from casimir._scene import _keys

    keys, tables = _keys()
    for method in (casimir.Scene.run, casimir.Scene.with_, casimir.Sweep.expect, casimir.Scene.lyapunov):
        assert {*keys, *tables} <= inspect.signature(method).parameters.keys(), method
    for verb, options in OPTIONS.items():
        signature = inspect.signature(getattr(casimir.Scene, verb))
        how = {"self", "on", *HowArguments.__annotations__.keys()}
        own = signature.parameters.keys() - {*keys, *tables, *how}
        assert own == options - {"accuracy"}
    # Mypy refuses them, too: an ignore that is not needed is an error.
    wrong: list[Any] = [
        lambda: oscillator.run(pathz=3),  # type: ignore[call-arg]
        lambda: oscillator.expect(stepps=3),  # type: ignore[call-arg]
        lambda: casimir.sweep(oscillator, k=[1]).expect(pathz=3),  # type: ignore[call-arg]
        lambda: oscillator.run(paths="three"),  # type: ignore[arg-type]
    ]
    for call in wrong:
        with pytest.raises(casimir.SceneError):
            call()
