"""Ctrl-C, threads, forks, progress."""

import functools
import multiprocessing
import os
import random
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import casimir


def interrupt_after(seconds: float) -> threading.Timer:
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


@pytest.mark.parametrize("seed", range(20))
def test_interrupts_give_what_is_complete(seed: int, oscillator: casimir.Scene) -> None:
    scene = oscillator.with_(paths=50_000_000, steps=256)
    delay = random.Random(seed).uniform(0.02, 0.6)
    start = time.monotonic()
    timer = interrupt_after(delay)
    try:
        run = scene.run(progress=False)
    except KeyboardInterrupt:
        run = None  # before the first path
    late = time.monotonic() - start - delay
    timer.join()
    assert late < 0.2 + 0.1 * (os.cpu_count() == 1), late
    if run is not None:
        assert run.interrupted and run.data["paths"] % 32 == 0
        law = run.statistics["q"]
        assert np.isfinite(law.mean).all() and law.lo[-1] < law.mean[-1] < law.hi[-1]
    # No broken state.
    assert not oscillator.run(paths=200).interrupted


def test_an_interrupt_raises_if_that_is_wanted(oscillator: casimir.Scene) -> None:
    interrupt_after(0.3)
    with pytest.raises(KeyboardInterrupt):
        oscillator.run(paths=50_000_000, raises=True)
    interrupt_after(0.8)
    found = oscillator.expect(accuracy=1e-9)
    assert found.interrupted and not found.reached and found["q"].half_width < 1


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_an_interrupt_while_progress_is_shown(
    error: type[BaseException], oscillator: casimir.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    from casimir import _progress

    raised = threading.Event()

    def show(words: str) -> None:
        if "% paths" in words and " 0 %" not in words and not raised.is_set():
            raised.set()
            raise error

    monkeypatch.setattr(_progress, "_shown", lambda: show)
    if error is KeyboardInterrupt:
        run = oscillator.run(paths=5_000_000)
        assert run.interrupted and 0 < run.data["paths"] < 5_000_000
    else:
        with pytest.raises(error):
            oscillator.run(paths=5_000_000)


def test_two_threads_run_at_once(oscillator: casimir.Scene) -> None:
    expected = oscillator.run(paths=20_000).arrays["q mean"].tobytes()
    with ThreadPoolExecutor(2) as pool:
        both = pool.map(lambda _: oscillator.run(paths=20_000), range(4))
        assert {run.arrays["q mean"].tobytes() for run in both} == {expected}


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_after_use(method: str, oscillator: casimir.Scene) -> None:
    work = functools.partial(casimir.Scene.run, paths=2000)
    expected = work(oscillator)["q"].tobytes()
    with multiprocessing.get_context(method).Pool(2) as pool:
        found = pool.map_async(work, [oscillator] * 4).get(timeout=60)
    assert {run["q"].tobytes() for run in found} == {expected}


def test_interrupts_of_a_notebook(oscillator: casimir.Scene, tmp_path: Path) -> None:
    jupyter_client = pytest.importorskip("jupyter_client")
    pytest.importorskip("ipykernel")
    manager, client = jupyter_client.manager.start_new_kernel(cwd=str(tmp_path))
    outputs: list[dict[str, object]] = []
    try:

        def run(code: str) -> dict[str, object]:
            reply: dict[str, object] = client.execute_interactive(
                code, output_hook=outputs.append, timeout=60
            )["content"]
            return reply

        text = oscillator.to_toml()
        assert run(f"import casimir\nscene = casimir.Scene.from_toml({text!r})")["status"] == "ok"
        # Before the first paths are complete there is nothing to give; then progress is drawn too.
        for delay in (0.7, 1.1, 1.5):
            timer = threading.Timer(delay, manager.interrupt_kernel)
            timer.start()
            start = time.monotonic()
            code = "run = scene.run(paths=50_000_000)\nassert run.interrupted"
            assert run(code)["status"] == "ok"
            # The messages of the client take some of the time.
            assert time.monotonic() - start - delay < 0.5
            timer.join()
        assert run("run = scene.run(paths=200)\nassert not run.interrupted")["status"] == "ok"
        assert any("% paths" in str(message["content"]) for message in outputs)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def test_the_lock_of_the_interpreter_is_free(oscillator: casimir.Scene) -> None:
    ticks = 0
    done = threading.Event()

    def work() -> None:
        oscillator.run(paths=400_000, threads=1)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.005):
        ticks += 1
    thread.join()
    assert ticks > 10


def test_progress_is_shown_by_the_thread_that_waits(
    oscillator: casimir.Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    from casimir import _progress

    shown: list[tuple[str, int]] = []
    record = lambda words: shown.append((words, threading.get_ident()))  # noqa: E731
    monkeypatch.setattr(_progress, "_shown", lambda: record)
    interrupt_after(1.0)
    oscillator.run(paths=50_000_000)
    assert {thread for _, thread in shown} == {threading.get_ident()}
    assert any("% paths" in words for words, _ in shown) and shown[-1][0] == ""


@pytest.mark.parametrize("verb", ["order", "compare"])
def test_measurements_end_with_their_interrupt(verb: str, oscillator: casimir.Scene) -> None:
    scene = oscillator.with_(scheme="em", until=200)

    def measure() -> object:
        if verb == "order":
            return scene.order(path_steps=1e12, progress=False)
        return scene.compare(error=1e-9, budget=600, progress=False)

    for delay in (0.1, 0.8, 2.0):
        timer, start = interrupt_after(delay), time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            measure()
        assert time.monotonic() - start - delay < 0.3
        timer.join()
        # Nothing goes on in the background.
        time.sleep(0.5)
        used = time.process_time()
        time.sleep(0.5)
        assert time.process_time() - used < 0.1
