"""Right solvers are confirmed, and twins with a mistake refuted."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import casimir

Array = NDArray[Any]
SPEED = np.array([0.5, 1.0, 1.5])
SIGMA, GAMMA = 0.4, 0.2


@pytest.fixture(scope="module")
def spin() -> casimir.Referee:
    """A spin with three noises, which do not commute."""
    system = casimir.System(
        state="x y z",
        B=[["-z", "y"], ["-x"]],
        H0="x^2/4 + y^2/2 + 3*z^2/4",
        H=["0.4*x", "0.4*y", "0.4*z"],
        damping=GAMMA,
    )
    scene = system.scene(initial=[0.6, 0, 0.8], until=2, steps=256, expect={"of": ["x"], "accuracy": 1e-2})
    return casimir.Referee(scene, paths=512)


@pytest.fixture(scope="module")
def kubo() -> casimir.Referee:
    return casimir.Referee(casimir.scene("kubo"), until=2, paths=1024)


def drift(y: Array) -> Array:
    return np.cross(y, SPEED * y) - GAMMA * y


def milstein(changed: Callable[[Array], Array] = lambda areas: areas) -> Callable[..., Array]:
    """Of order one with the right areas."""

    def step(y: Array, dt: float, dW: Array, areas: Array, _: Array) -> Array:
        integrals = 0.5 * dW[:, :, None] * dW[:, None, :] + changed(areas)
        end = y + drift(y) * dt + SIGMA * np.cross(y, dW)
        for i, axis in enumerate(np.eye(3)):
            end = end + SIGMA**2 * np.cross(np.cross(y, axis), integrals[:, i])
        return end

    return casimir.one_step(step)


def fresh(areas: Array) -> Array:
    """Areas of the right law that are drawn again on each grid, with a seed of their own."""
    drawn = np.random.default_rng(areas.size).permutation(areas)
    return np.asarray(drawn)


def midpoint(y: Array, dt: float, dW: Array) -> Array:
    """Keeps the length of a spin."""
    for dw in dW:
        half = np.exp(-0.5 * GAMMA * dt)
        y = end = half * y
        for _ in range(40):
            middle = 0.5 * (y + end)
            end = y + np.cross(middle, SPEED * middle * dt + SIGMA * dw)
        y = half * end
    return y


def kubo_heun(y: Array, dt: float, dW: Array, late: float = 0.0) -> Array:
    dt = dt + late * dt**1.5

    def change(y: Array, dw: Array) -> Array:
        turned = np.stack([y[:, 1], -y[:, 0]], axis=1)
        return np.asarray((turned - 0.1 * y) * dt + 0.5 * turned * dw)

    for dw in dW:
        first = change(y, dw)
        y = y + 0.5 * (first + change(y + first, dw))
    return y


def kubo_euler(correction: float, clamped: int = 1) -> Callable[..., Array]:
    """Euler and Maruyama with a part of the Itô correction; steps that are clamped to a part of their
    length keep the increment of the whole."""

    def solver(y: Array, dt: float, dW: Array) -> Array:
        for dw in np.repeat(dW, clamped, axis=0):
            turned = np.stack([y[:, 1], -y[:, 0]], axis=1)
            y = y + (turned - 0.1 * y - 0.125 * correction * y) * dt / clamped + 0.5 * turned * dw
        return y

    return solver


def test_orders_of_one_half_are_neither_a_wrong_limit_nor_one(kubo: casimir.Referee) -> None:
    """A drift for a time dt + dt^1.5 has a strong and a weak order of ½."""
    report = kubo.judge(lambda y, dt, dW: kubo_heun(y, dt, dW, 1.0), strong=0.5, weak=1)
    strong, *weak = report.verdicts.values()
    assert strong == "confirmed" and weak and "confirmed" not in weak, report


def test_right_solvers_are_confirmed(spin: casimir.Referee, kubo: casimir.Referee) -> None:
    report = spin.judge(milstein(), areas=True, strong=1, weak=1)
    assert set(report.verdicts.values()) == {"confirmed", None}, report
    assert report.strong == 1.0 and report.data["reference_error"] < 1e-3
    report = spin.judge(midpoint, strong=0.5, weak=1, keeps=True)
    assert set(report.verdicts.values()) == {"confirmed"}, report
    assert "which is rounding" in report.text and "ns per path-step" in report.text
    assert "<svg" in report.plot("strong").svg and "<table" in report._repr_html_()
    report = kubo.judge(kubo_heun, strong=1, weak=1)
    assert set(report.verdicts.values()) == {"confirmed", None}, report


def test_wrong_areas_are_refuted(spin: casimir.Referee) -> None:
    index = spin.judge(milstein(lambda areas: areas.transpose(0, 2, 1)), areas=True, strong=1)
    again = spin.judge(milstein(fresh), areas=True, strong=1)
    for report in (index, again):
        assert report.verdicts["strong order"] == "refuted" and report.strong == 0.5, report


def test_a_wrong_correction_is_named(kubo: casimir.Referee) -> None:
    for part, words in [(0.0, "in the sense of Itô, without"), (0.5, "half of the Itô correction")]:
        report = kubo.judge(kubo_euler(part), strong=0.5, weak=1)
        assert report.verdicts["strong order"] == "refuted" and words in report.text, report


def test_an_increment_that_a_clamped_step_keeps_is_refuted(kubo: casimir.Referee) -> None:
    report = kubo.judge(kubo_euler(1.0, clamped=2), strong=0.5, weak=1)
    assert set(report.verdicts.values()) == {"refuted", None}, report


def test_a_law_that_is_lost_in_the_tenth_digit_is_refuted(spin: casimir.Referee) -> None:
    report = spin.judge(lambda *level: midpoint(*level) * (1 + 1e-10), strong=0.5, keeps=True)
    assert report.verdicts["law C1"] == "refuted", report
    assert 1e-10 < report.data["laws"][0]["defect"] < 3e-10


def test_noise_of_its_own_is_named(kubo: casimir.Referee) -> None:
    random = np.random.default_rng(1)

    def solver(y: Array, dt: float, dW: Array) -> Array:
        return kubo_euler(1.0)(y, dt, random.standard_normal(dW.shape) * np.sqrt(dt))

    report = kubo.judge(solver, strong=0.5)
    assert "noise of its own" in report.text and report.verdicts["strong order"] == "refuted"


def test_noise_is_joined_from_level_to_level(spin: casimir.Referee) -> None:
    levels = [level for level in spin if level._place[0] == "level"]
    for coarse, fine in zip(levels[:-1], levels[1:], strict=True):
        if coarse._place[2] != fine._place[2]:
            continue
        a, b = fine.dW[::2], fine.dW[1::2]
        assert np.allclose(coarse.dW, a + b, rtol=0, atol=1e-14)
        chen = 0.5 * (a[..., :, None] * b[..., None, :] - b[..., :, None] * a[..., None, :])
        assert np.allclose(coarse.areas, fine.areas[::2] + fine.areas[1::2] + chen, rtol=0, atol=1e-13)
        joined = 0.5 * (fine.H[::2] + fine.H[1::2]) + 0.25 * (a - b)
        assert np.allclose(coarse.H, joined, rtol=0, atol=1e-14)
    # Variances dt, dt²/4 and dt/12; a mean of n squares of a normal has the deviation √(2/n), of an
    # area, whose fourth moment is at most 15 variances², √(14/n): five of these, nine numbers.
    last = levels[-1]
    n = last.dW[..., 0].size
    for squares, variance, fourth in [
        (last.dW**2, last.dt, 2),
        (last.H**2, last.dt / 12, 2),
        (last.areas[..., [0, 0, 1], [1, 2, 2]] ** 2, last.dt**2 / 4, 14),
    ]:
        assert (np.abs(squares.mean(axis=(0, 1)) / variance - 1) < 5 * (fourth / n) ** 0.5).all()


def test_what_is_no_answer_is_refused(kubo: casimir.Referee) -> None:
    with pytest.raises(casimir.SceneError, match="from 5 to 30, got 4"):
        casimir.Referee(casimir.scene("kubo"), levels=4)
    level = next(iter(kubo))
    with pytest.raises(casimir.SceneError, match="float32"):
        kubo.add(level, level.y0.astype(np.float32))
    with pytest.raises(casimir.SceneError, match=r"\(1024, 2\), got \(2, 1024\)"):
        kubo.add(level, level.y0.T)
    with pytest.raises(casimir.SceneError, match="one_step"):
        kubo.add(level, level.y0 + level.dW)
    with pytest.raises(casimir.SceneError, match="lack a `return`"):
        kubo.add(level, None)
    with pytest.raises(casimir.SceneError, match="no answer to Level: 16 steps of 0.125 on 1024 paths from 0"):
        kubo.report()
    kubo.add(level, np.stack([level.y0] * 17))
    with pytest.raises(casimir.SceneError, match="answered already"):
        kubo.add(level, level.y0)
    with pytest.raises(casimir.SceneError, match="not run to its end"):
        kubo.report()
    with pytest.raises(casimir.SceneError, match="no path is finite"):
        kubo.judge(lambda y, dt, dW: y * np.nan)


def test_paths_that_fail_decide_nothing(kubo: casimir.Referee) -> None:
    def explodes(y: Array, dt: float, dW: Array) -> Array:
        end = kubo_heun(y, dt, dW)
        end[::5] = np.nan if dt > 0.1 else end[::5]
        return end

    report = kubo.judge(explodes, strong=1, weak=1)
    assert report.verdicts["strong order"] == "cannot tell" and "205 of 1024 paths failed" in report.text


def walk(seed: int, paths: Array, steps: Any = (0.0, 1.0), state: Any = None) -> Array:
    def of(path: int) -> float:
        noise = np.random.default_rng([seed, path]).standard_normal(64)
        begin, end = (int(64 * part) for part in steps)
        return float(noise[begin:end].sum())

    before = np.zeros(len(paths)) if state is None else state
    return np.asarray(before + np.array([of(int(path)) for path in paths]))


def test_seeds_that_are_kept_and_lost() -> None:
    def exact(seed: int, paths: Array, threads: int = 1) -> Array:
        return np.array([np.random.default_rng([seed, int(p)]).standard_normal() for p in paths])

    good = casimir.verify_seeds(exact)
    assert good and len(good) == 6 and "no argument `state`" in repr(good)

    def one_thread_ignores(seed: int, paths: Array, threads: int = 1) -> Array:
        ends = np.zeros(len(paths))

        def work(number: int) -> None:
            for place in range(number, len(paths), threads):
                key = [0 if number == 1 else seed, int(paths[place])]
                ends[place] = np.random.default_rng(key).standard_normal()

        workers = [threading.Thread(target=work, args=(number,)) for number in range(threads)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        return ends

    def second_differs(seed: int, paths: Array, threads: int = 1) -> Array:
        return np.stack([exact(seed, paths), exact(seed, paths) + threads], axis=1)

    assert not casimir.verify_seeds(second_differs, threads=2)["1 and 2 threads"]
    wrong = casimir.verify_seeds(one_thread_ignores, threads=2)
    assert not wrong and not wrong["1 and 2 threads"] and wrong["same seed, same bits"], wrong

    def by_order(seed: int, paths: Array) -> Array:
        return np.random.default_rng(seed).standard_normal(len(paths))

    assert not casimir.verify_seeds(by_order)["chunks in another order"]
    assert not casimir.verify_seeds(lambda seed, paths: exact(1, paths))["another seed, other numbers"]
    shifted = casimir.verify_seeds(lambda seed, paths: exact(1, seed + paths))
    assert not shifted["another seed, other numbers"]
    assert not casimir.verify_seeds(lambda seed, p: exact(seed, 0 * p))["another path, other numbers"]
    with pytest.raises(casimir.SceneError, match="no row"):
        casimir.verify_seeds(lambda seed, paths: None)


def test_small_errors_and_special_steps(kubo: casimir.Referee) -> None:
    def noisier(y: Array, dt: float, dW: Array) -> Array:
        return kubo_heun(y, dt, 1.02 * dW)

    report = kubo.judge(noisier, strong=1, weak=1)
    assert report.verdicts["strong order"] == "refuted", report

    def first_step_of_euler(y: Array, dt: float, dW: Array) -> Array:
        return kubo_heun(kubo_euler(1.0)(y, dt, dW[:1]), dt, dW[1:])

    # Its order is one, and single steps have ½: they are not those of the paths.
    assert kubo.judge(first_step_of_euler, strong=1).verdicts["strong order"] != "refuted"


def test_a_restart_is_compared_to_the_bit() -> None:
    def rounded(seed: int, paths: Array, steps: Any = (0.0, 1.0), state: Any = None) -> Array:
        return walk(seed, paths, steps, state)

    # Sums in another order differ in the last bit.
    assert not casimir.verify_seeds(rounded)["restart in the middle"]

    def exact(seed: int, paths: Array, steps: Any = (0.0, 1.0), state: Any = None) -> Array:
        whole = [np.random.default_rng([seed, int(p)]).integers(0, 9, 64) for p in paths]
        begin, end = (int(64 * part) for part in steps)
        before = 0 if state is None else state
        return np.asarray(before + np.array([one[begin:end].sum() for one in whole]))

    assert casimir.verify_seeds(exact)["restart in the middle"]
