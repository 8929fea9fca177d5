"""Work that is killed goes on to the bits of an undisturbed run."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import casimir

CALL = """
import sys, casimir
scene = casimir.Scene.from_toml(sys.stdin.read())
getattr(scene, sys.argv[1])(resume=sys.argv[2], threads=1, progress=False, **eval(sys.argv[3]))
"""


def killed_in_the_middle(scene: casimir.Scene, verb: str, folder: Path, options: dict[str, Any]) -> bool:
    """Starts a call in another process, and kills it after its first checkpoint, if it has one."""
    command = [sys.executable, "-c", CALL, verb, str(folder), repr(options)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        process.stdin.write(scene.to_toml())
        process.stdin.close()
        first: dict[Path, int] = {}
        while process.poll() is None:
            times = {file: file.stat().st_mtime_ns for file in folder.glob("*.bin")}
            first = first or times
            # The first file of a run says that the folder can be written.
            if times != first or (times and verb != "run"):
                process.send_signal(signal.SIGKILL)
                break
            time.sleep(0.02)
    return process.returncode == -signal.SIGKILL


def of(found: casimir.Run | casimir.Expectation) -> str:
    """What must be the same."""
    if isinstance(found, casimir.Run):
        return repr({key: array.tobytes() for key, array in found.arrays.items()})
    return json.dumps(found.data["estimates"])


@pytest.mark.parametrize("verb", ["run", "equilibrium"])
def test_after_a_kill(verb: str, tmp_path: Path) -> None:
    scene, options = casimir.scene("langevin"), dict[str, Any](steps=64, times=4, paths=60_000)
    if verb == "equilibrium":
        options = {"of": ["q^2"], "accuracy": 7e-4, "scheme": "baoab", "chains": 64}
    folder = tmp_path / "kept"
    # A fast machine needs more work to be killed at.
    while not killed_in_the_middle(scene, verb, folder, options):
        options |= {"paths": 4 * options["paths"]} if verb == "run" else {"accuracy": options["accuracy"] / 2}
    work = getattr(scene, verb)
    assert of(work(**options, resume=folder)) == of(work(**options)) and not list(folder.glob("*.bin"))


def test_an_interrupted_measurement_goes_on(oscillator: casimir.Scene, tmp_path: Path) -> None:
    order = oscillator.order(path_steps=3e6, resume=tmp_path / "o")
    assert order.data["strong"] == oscillator.order(path_steps=3e6).data["strong"]
    assert not list((tmp_path / "o").glob("*.bin"))


def test_a_folder_of_other_work_is_refused(oscillator: casimir.Scene, tmp_path: Path) -> None:
    part = oscillator.parts(2, paths=256)[0]
    assert part.run(resume=tmp_path).found == part.run(resume=tmp_path).found == part.run().found
    with pytest.raises(casimir.RunError, match="part-1-of-2.bin"):
        oscillator.parts(2, paths=256, seed=2)[0].run(resume=tmp_path)
    (tmp_path / "file").write_text("no folder")
    for verb in ("run", "expect", "order"):
        with pytest.raises((casimir.RunError, casimir.SceneError), match="file"):
            getattr(oscillator, verb)(resume=tmp_path / "file")
    with pytest.raises(casimir.SceneError, match="`resume` is the name of a folder"):
        oscillator.run(resume=3)  # type: ignore[arg-type]


def test_snapshots_of_a_large_lattice(tmp_path: Path) -> None:
    # A field turns the spins, which are parallel.
    scene = casimir.Scene.from_toml("""
        [system]
        name = "spin-lattice"
        parameters = { sizes = [32, 64, 16], exchange = 1, field = [0, 0, 1.5] }
        [run]
        initial = [0.6, 0, 0.8]
        until = 1
        steps = 400
        times = 4
        snapshots = 2
    """)
    with pytest.raises(casimir.SceneError, match="resume='folder'"):
        scene.run().snapshots  # noqa: B018
    run = scene.run(resume=tmp_path)
    assert list(run.snapshots) == [(0, 0.0), (0, 0.5), (0, 1.0)]
    for (_, t), spins in run.snapshots.items():
        assert spins.shape == (16, 64, 1, 32, 3)
        assert np.abs(spins - [0.6 * np.cos(1.5 * t), 0.6 * np.sin(1.5 * t), 0.8]).max() < 1e-4
    with pytest.raises(KeyError, match="no snapshot"):
        run.snapshots[0, 0.3]
