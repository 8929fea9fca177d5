"""Work that is killed goes on to the bits of an undisturbed run."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import casimir

CALL = """
import sys, casimir
scene = casimir.Scene.from_toml(sys.stdin.read())
getattr(scene, sys.argv[1])(resume=sys.argv[2], threads=1, progress=False, **eval(sys.argv[3]))
"""


def kill_in_the_middle(scene: casimir.Scene, verb: str, folder: Path, options: dict[str, Any]) -> None:
    """Starts a call in another process, and kills it after its first checkpoint."""
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
    assert process.returncode == -signal.SIGKILL, "it ended before its first checkpoint"


def of(found: casimir.Run | casimir.Expectation) -> str:
    """What must be the same."""
    if isinstance(found, casimir.Run):
        return repr({key: array.tobytes() for key, array in found.arrays.items()})
    return json.dumps(found.data["estimates"])


WORK = [
    ("run", {"paths": 600_000, "steps": 1024}),
    ("equilibrium", {"of": ["q^2"], "accuracy": 7e-4, "scheme": "baoab", "chains": 64}),
]


@pytest.mark.parametrize(("verb", "options"), WORK)
def test_after_a_kill(verb: str, options: dict[str, Any], tmp_path: Path) -> None:
    name = "langevin" if verb == "equilibrium" else "kubo"
    scene, folder = casimir.scene(name), tmp_path / "kept"
    if verb == "run":
        scene = scene.with_(until=2, statistics=None)
    kill_in_the_middle(scene, verb, folder, options)
    begun = time.monotonic()
    found = getattr(scene, verb)(**options, resume=folder)
    resumed = time.monotonic() - begun
    begun = time.monotonic()
    assert of(found) == of(getattr(scene, verb)(**options)) and not list(folder.glob("*.bin"))
    # The twin: another seed has other bits.
    print(f"resumed in {resumed:.1f} s, undisturbed in {time.monotonic() - begun:.1f} s")


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
