"""Arrays are those of the program, to the bit."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import casimir


def short(scene: casimir.Scene) -> casimir.Scene:
    """At most 128 paths, and a fiftieth of the time: the same code in less time."""
    about = scene._check()
    paths = min(int(about["paths"]), 128)
    if "statistics" in scene.to_dict():
        # They have times of their own.
        return scene.with_(paths=paths)
    return scene.with_(paths=paths, steps=64, times=16, until=float(about["until"]) / 50)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("name", casimir.scenes())
def test_every_scene(name: str, threads: int, program: Path, tmp_path: Path) -> None:
    scene = short(casimir.scene(name))
    (tmp_path / "s.toml").write_text(scene.to_toml(), encoding="utf-8")
    command = [str(program), "run", "s.toml", "--write", "npz", "--out", "out", "--threads", "1"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    run = scene.run(threads=threads)
    expected: dict[str, np.ndarray] = {}
    for file in (tmp_path / "out").glob("*.npz"):
        with np.load(file) as arrays:
            expected |= {key: arrays[key] for key in arrays.files}
    assert expected.keys() == run.arrays.keys()
    for key, array in expected.items():
        assert array.shape == run.arrays[key].shape, key
        assert array.tobytes() == run.arrays[key].tobytes(), key


def test_another_seed_has_other_bits(oscillator: casimir.Scene) -> None:
    one, other = (oscillator.run(seed=seed)["q"] for seed in (1, 2))
    assert not np.array_equal(one, other)


def test_expectations_have_the_same_bits(oscillator: casimir.Scene) -> None:
    one, two = (oscillator.expect(threads=threads) for threads in (1, 2))
    assert one["q"] == two["q"]
