"""Parts: the bits of one run on any executor, and intervals over replicates."""

import os
import pickle
import signal
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest

import casimir


def same_bits(one: casimir.Run, other: casimir.Run) -> bool:
    assert one.arrays.keys() == other.arrays.keys()
    return all(one.arrays[key].tobytes() == array.tobytes() for key, array in other.arrays.items())


def test_processes_merge_to_the_bits_of_one_run(oscillator: casimir.Scene) -> None:
    scene = oscillator.with_(statistics={"autocorrelation": ["q"], "pairs": [["q", "p"]]}, until=4)
    parts = scene.parts(5, paths=1000, times=8)
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        results = list(pool.map(casimir.Part.run, reversed(parts)))
    merged = casimir.merge([*results, results[2]])  # one came twice
    whole = scene.run(paths=1000, times=8)
    assert same_bits(merged, whole) and merged.scene == whole.scene and merged.seed == 1
    assert {**merged.data, "seconds": 0} == {**whole.data, "seconds": 0}
    # The twin: a part of another seed is seen.
    assert not same_bits(scene.run(paths=1000, times=8, seed=2), whole)


def test_a_sweep_in_parts(oscillator: casimir.Scene) -> None:
    sweep = casimir.sweep(oscillator.with_(paths=300), independent=True, k=[1.0, 2.0])
    merged = casimir.merge(part.run() for part in sweep.parts(2))
    assert same_bits(merged, sweep.run()) and merged.statistics["q"].mean.shape == (2, len(merged.t))


def test_states_of_an_array_in_parts(oscillator: casimir.Scene) -> None:
    states = np.random.default_rng(1).normal(size=(300, 2))
    scene = oscillator.with_(initial=states)
    results = [part.run() for part in pickle.loads(pickle.dumps(scene.parts(3)))]
    assert same_bits(casimir.merge(pickle.loads(pickle.dumps(results))), scene.run())


def test_parts_that_do_not_belong_together_are_refused(oscillator: casimir.Scene) -> None:
    parts = oscillator.parts(3, paths=400)
    some = [part.run() for part in parts]
    other = oscillator.parts(3, paths=400, seed=2)[0].run()
    refused: list[tuple[Any, str]] = [
        (some[:1], "of 3 parts these are missing: 2, 3"),
        ([*some, other], "different computations"),
        ([], "no results"),
        (parts, "what part.run"),
        (some[0], "results of all parts"),
    ]
    for results, words in refused:
        with pytest.raises(casimir.SceneError, match=words):
            casimir.merge(results)
    with pytest.raises(casimir.SceneError, match="at least 100 `paths`"):
        oscillator.parts(3)
    with pytest.raises(casimir.SceneError, match="parts are of run, expect"):
        oscillator.parts(3, "order")  # type: ignore[call-overload]
    with pytest.raises(casimir.SceneError, match="at least four parts"):
        oscillator.parts(3, "expect")
    with pytest.raises(casimir.SceneError, match="unknown key `path`"):
        oscillator.parts(3, path=5)  # type: ignore[call-overload]


def test_intervals_over_parts_cover(oscillator: casimir.Scene) -> None:
    exact = np.exp(-0.2) * np.cos(2.0)

    def found(seed: int) -> casimir.Estimate:
        # The bound of the bias is in the interval, so that it covers more often than 95 %.
        parts = oscillator.parts(4, "expect", accuracy=5e-3, seed=seed)
        merged = casimir.merge(part.run() for part in parts)
        assert merged.reached and merged.data["parts"] == 4 and merged.data["accuracy"] == 5e-3
        return merged["q"]

    estimates = [found(seed) for seed in range(16)]
    # Of 16 intervals of 95 % five or more miss with 9e-4.
    assert sum(not one.lo <= exact <= one.hi for one in estimates) < 5
    # The twin: the value with another rate is missed.
    assert sum(not one.lo <= exact * np.exp(-0.1) <= one.hi for one in estimates) == 16
    assert len({one.value for one in estimates}) == 16


def test_averages_and_exponents_in_parts() -> None:
    well = casimir.scene("langevin").with_(parameters={"kT": 1.0})
    parts = well.parts(4, "equilibrium", accuracy=0.05, chains=64)
    average = casimir.merge(part.run() for part in parts)
    # <p²/2m> = kT/2; four half-widths are missed once in 10^5 by Student's law of four parts.
    assert average.reached and abs(average["kinetic"].value - 0.5) < 4 * average["kinetic"].half_width
    exponents = casimir.merge(p.run() for p in well.parts(4, "lyapunov", accuracy=0.1, count=2))
    assert abs(exponents["their sum"].value + 1.0) < 1e-6 and "4 parts of" in repr(exponents)


def killed(workers: Iterable[int]) -> None:
    for pid in workers:
        os.kill(pid, signal.SIGKILL)


def test_dask_with_two_workers_killed(oscillator: casimir.Scene) -> None:
    distributed = pytest.importorskip("distributed")
    scene = oscillator.with_(paths=64 * 256, steps=256)
    settings = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**settings) as cluster, distributed.Client(cluster) as client:
        futures = client.map(casimir.Part.run, scene.parts(64), retries=5)
        for _ in range(2):
            while not any(client.processing().values()):
                time.sleep(0.01)
            time.sleep(0.3)
            workers = client.run(os.getpid)
            killed(list(workers.values())[:1])
        merged = casimir.merge(client.gather(futures))
    assert same_bits(merged, scene.run())
