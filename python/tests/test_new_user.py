"""What a new user tried: wrong numbers, axes, sweeps of one value, interrupts, memory."""

import math
import os
import signal
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import casimir

NAN, INF = math.nan, math.inf
CORRELATED: dict[str, Any] = {"paths": 200, "until": 20, "steps": 640, "times": 64}
CORRELATED["statistics"] = {"autocorrelation": ["q"]}


def system(**changes: Any) -> casimir.System:
    parts: dict[str, Any] = {"state": "q p", "B": "canonical", "H0": "(p^2 + k*q^2)/2"}
    parts |= {"H": ["0.1*q"], "parameters": {"k": 1.0}, "damping": 0.1}
    return casimir.System(**{**parts, **changes})


def scene_of(**changes: Any) -> casimir.Scene:
    return system(**changes).scene(initial=[1, 0], until=1, steps=8)


def test_wrong_numbers_are_refused_with_the_name_of_their_key(oscillator: casimir.Scene) -> None:
    o = oscillator
    bath = {"friction": {"p": 0.5}, "temperature": -1.0}
    calls: list[tuple[Callable[[], object], str, str]] = [
        (lambda: o.with_(initial=[NAN, 0]), "run.initial", "finite number, got nan"),
        (lambda: o.with_(initial=np.array([0, INF])), "run.initial", "got inf"),
        (lambda: o.with_(initial=[[1], [2, 3]]), "run.initial", "path, component"),
        (lambda: o.with_(initial=[]), "run.initial", "no component"),
        (lambda: o.with_(until=np.float32(NAN)), "run.until", "finite number"),
        (lambda: o.with_(parameters={"k": INF}), "system.parameters.k", "finite number"),
        (lambda: o.with_(run={"steps": NAN}), "run.steps", "finite number"),
        (lambda: o.expect(accuracy=NAN), "expect.accuracy", "finite number"),
        (lambda: system(H0=NAN), "system.H0", "finite number"),
        (lambda: system(B=[[0, NAN], [-1, 0]]), "system.B", "finite number"),
        (lambda: system(B=None), "system.B", "missing"),
        (lambda: system(parameters={"k": NAN}), "system.parameters.k", "finite number"),
        (lambda: system(damping={"rates": {"p": NAN}}), "damping.rates.p", "finite number"),
        (lambda: scene_of(H=None, damping=None, bath=bath), "bath.temperature", "positive, got -1"),
        (lambda: o.run(seed=-1), "run.seed", "`-1` is not a seed: a whole number from 0 to 1844"),
        (lambda: o.run(seed=1.5), "run.seed", "is not a seed"),  # type: ignore[arg-type]
        (lambda: o.run(seed=2**64), "run.seed", "is not a seed"),
        (lambda: o.run(seed=True), "run.seed", "is not a seed"),
        (lambda: o.run(threads=10**6), "threads", "from 1 to 1024, got 1000000"),
        (lambda: o.run(threads=2.5), "threads", "got 2.5"),  # type: ignore[arg-type]
        (lambda: o.expect(coarsest_steps=-1), "coarsest_steps", "at least 1, got -1"),
        (lambda: o.equilibrium(chains=0), "chains", "at least 1, got 0"),
        (lambda: o.equilibrium(path_steps=NAN), "path_steps", "whole number"),
        (lambda: o.lyapunov(count=2.5), "count", "got 2.5"),  # type: ignore[arg-type]
        (lambda: o.lyapunov(accuracy=0), "accuracy", "above 0, got 0"),
        (lambda: o.order(path_steps=INF), "path_steps", "got inf"),
        (lambda: o.compare(error=NAN), "error", "above 0, got nan"),
        (lambda: casimir.sweep(o, k=[1, INF]), "k", "finite"),
        (lambda: casimir.Referee(o, levels=60), "levels", "from 5 to 30, got 60"),
        (lambda: casimir.Referee(o, paths=-5), "paths", "at least 1, got -5"),
        (lambda: casimir.Referee(o, seed=-1), "run.seed", "is not a seed"),
        (lambda: casimir.verify_seeds(lambda seed, paths: paths, paths=0), "paths", "got 0"),
    ]
    for call, key, words in calls:
        with pytest.raises(casimir.SceneError) as raised:
            call()
        assert raised.value.key == key and words in str(raised.value), (key, str(raised.value))


def test_things_of_another_kind_are_refused(oscillator: casimir.Scene) -> None:
    calls: list[Callable[[], object]] = [
        lambda: casimir.Referee("scene"),  # type: ignore[arg-type]
        lambda: casimir.sweep("scene", k=[1]),  # type: ignore[arg-type]
        lambda: casimir.scene(3),  # type: ignore[arg-type]
        lambda: casimir.Scene.from_toml(3),  # type: ignore[arg-type]
        lambda: oscillator.with_(observe={"energy": lambda y: y}),
    ]
    for call in calls:
        with pytest.raises(casimir.SceneError):
            call()


def test_seeds_have_64_bits(oscillator: casimir.Scene) -> None:
    runs = {seed: oscillator.run(seed=seed) for seed in (0, 2**63 - 1, 2**63, 2**64 - 1)}
    assert all(run.seed == run.data["seed"] == seed for seed, run in runs.items())
    assert len({run["q"].tobytes() for run in runs.values()}) == 4
    again = casimir.Scene(oscillator.with_(seed=2**64 - 1).to_dict())
    assert again.run()["q"].tobytes() == runs[2**64 - 1]["q"].tobytes()


def test_spectra_have_their_axes(oscillator: casimir.Scene) -> None:
    run = oscillator.run(**CORRELATED)
    law, spectrum = (run.statistics[f"{of}(q)"] for of in ("autocorrelation", "spectrum"))
    assert law.mean.shape == run.lag.shape and run.lag[1] == run.t[1] - run.t[0]
    assert spectrum.mean.shape == run.omega.shape and run.omega[0] == 0 and law.mean[0] == 1
    assert run.axis("q") == "t" and run.axis("spectrum(q)") == "omega"
    swept = casimir.sweep(oscillator, k=[1.0, 2.0]).run(**CORRELATED)
    assert np.array_equal(swept.statistics["spectrum(q)"].mean[0], spectrum.mean)
    assert swept.lag.tobytes() == run.lag.tobytes()

    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    run.plot("autocorrelation(q)", ax=ax)
    assert ax.get_xlabel() == "lag" and np.array_equal(ax.lines[0].get_xdata(), run.lag)
    _, ax = pyplot.subplots()
    swept.plot("spectrum(q)", ax=ax)
    assert [line.get_label() for line in ax.lines] == ["k = 1", "k = 2"]

    table = pytest.importorskip("pandas") and swept.to_pandas("omega")
    assert set(table.observable) == {"spectrum(q)"} and len(table) == 2 * len(run.omega)
    assert set(swept.to_pandas().observable) == {"q", "p"}
    with pytest.raises(casimir.SceneError, match="autocorrelation"):
        oscillator.run(paths=120).to_pandas("lag")
    data = pytest.importorskip("xarray") and swept.to_xarray()
    assert data["spectrum(q) mean"].dims == ("k", "omega")
    assert data["autocorrelation(q) lo"].dims == ("k", "lag")
    assert np.array_equal(data["omega"], run.omega)


def test_spins_are_in_tables_of_pandas() -> None:
    pytest.importorskip("pandas")
    lattice = casimir.scene("spin-lattice")
    run = lattice.run(paths=2, until=0.01, steps=2, times=2, columns=["components"])
    column = run.to_pandas("path")[run.scene.components[4]]
    assert np.array_equal(column.to_numpy().reshape(2, 3), run["spins"][:, :, 1, 1])


def test_a_sweep_of_one_value_keeps_its_axis(oscillator: casimir.Scene) -> None:
    short = oscillator.with_(paths=120, until=0.7, steps=70)
    sweep = casimir.sweep(short, k=[2.0]).run()
    assert sweep.statistics["q"].mean.shape == (1, 71) and not sweep.paths
    mixed = casimir.sweep(short, k=[2.0], sigma=[0.1, 0.2]).run()
    assert mixed.statistics["q"].mean.shape == (1, 2, 71)
    # Times of a sweep are to the bit those of a run.
    assert sweep.t.tobytes() == short.run().t.tobytes()
    # What the scene varies itself is an axis, too, and the scene of the result has both.
    own = casimir.sweep(short.with_(sweep={"sigma": [0.1, 0.2]}), k=[1.0, 2.0]).run()
    assert list(own.parameters) == ["sigma", "k"]
    assert own.scene.run().arrays["q mean"].tobytes() == own.arrays["q mean"].tobytes()

    pytest.importorskip("matplotlib").use("Agg")
    from matplotlib import pyplot

    _, ax = pyplot.subplots()
    assert sweep.plot("q", ax=ax).get_xlabel() == "k"
    pytest.importorskip("xarray")
    assert sweep.to_xarray()["q mean"].dims == ("k", "t")


def interrupted(work: Callable[[], Any], delay: float) -> tuple[Any, float]:
    """What a call gives that is interrupted after a while, and how much later it does."""
    timer = threading.Timer(delay, os.kill, (os.getpid(), signal.SIGINT))
    start = time.monotonic()
    timer.start()
    try:
        return work(), time.monotonic() - start - delay
    except KeyboardInterrupt:
        return None, time.monotonic() - start - delay
    finally:
        timer.join()


def test_an_interrupt_says_nothing_of_tables_that_were_not_begun(oscillator: casimir.Scene) -> None:
    run, _ = interrupted(lambda: oscillator.run(paths=50_000_000, steps=256, progress=False), 0.7)
    assert run is not None and run.interrupted and run.data["halted"] == []
    assert not [line for line in run.warnings if str(line).startswith("path ")], run.warnings
    assert any("stopped after" in str(line) for line in run.warnings)
    crowd = oscillator.with_(paths=50_000_000, steps=256)
    _, late = interrupted(lambda: crowd.run(threads=1024, progress=False), 0.3)
    assert late < 1.0, late
    few, _ = interrupted(lambda: oscillator.run(paths=2, steps=10**9, progress=False), 0.3)
    assert few is None or [one["path"] for one in few.data["halted"]] == [0, 1]


def test_an_interrupt_ends_the_pilot_of_many_times(oscillator: casimir.Scene) -> None:
    many = oscillator.with_(steps=10**5, times=10**5, paths=50_000_000)
    _, late = interrupted(lambda: many.run(progress=False, threads=1), 0.4)
    assert late < 1.0, late


def test_memory_is_estimated_before_it_is_taken(oscillator: casimir.Scene) -> None:
    calls: list[tuple[Callable[[], object], str]] = [
        (lambda: oscillator.run(paths=200, steps=10**10, times=10**10), "tables of 3 paths"),
        (lambda: oscillator.run(paths=10**9, tables=10**9), "tables of 1000000000 paths"),
        (lambda: oscillator.run(steps=10**10, times=10**10), "tables of 1 paths"),
        (lambda: next(iter(casimir.Referee(oscillator, paths=10**6, chunk=10**6, levels=9))), "noise of 10"),
        (lambda: next(iter(casimir.Referee(oscillator, paths=10**12))), "states of 10"),
        (lambda: next(iter(casimir.Referee(oscillator, levels=30))), "noise of 1024 paths"),
    ]
    for call, words in calls:
        with pytest.raises(casimir.SceneError, match=f"{words}.* GB of memory, and .* GB is free"):
            call()
