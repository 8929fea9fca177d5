"""The program of the wheel: `python -m casimir` and `casimir`."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import casimir

MODULE = [sys.executable, "-m", "casimir"]


def ran(*arguments: str, at: Path, code: int = 0) -> str:
    done = subprocess.run([*MODULE, *arguments], cwd=at, capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done.stdout if code == 0 else done.stderr


def test_it_is_the_program(tmp_path: Path) -> None:
    text = ran("new", "kubo", at=tmp_path)
    assert text == casimir.scene("kubo").to_toml()
    (tmp_path / "kubo.toml").write_text(text)
    assert "E[q]" in ran("expect", "kubo.toml", "--accuracy", "0.01", at=tmp_path)
    assert "unexpected argument" in ran("expect", "--accurate", at=tmp_path, code=2)
    assert "cannot read the scene" in ran("run", "nowhere.toml", at=tmp_path, code=2)
    assert casimir.__version__ in ran("--version", at=tmp_path)
    ran("plan", "kubo.toml", "--parts", "2", "--paths", "300", "--out", "big", at=tmp_path)
    script = (tmp_path / "big/job.sh").read_text()
    program = Path(sys.executable).with_name("casimir")
    if program.exists():
        assert str(program) in script
        for part in "12":
            subprocess.run(["bash", "big/job.sh", part], cwd=tmp_path, check=True, capture_output=True)
        assert "big" in ran("merge", "big", at=tmp_path)


def test_an_interrupt_ends_it(tmp_path: Path) -> None:
    (tmp_path / "kubo.toml").write_text(casimir.scene("kubo").to_toml())
    command = [*MODULE, "run", "kubo.toml", "--paths", "1e8"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        _, words = process.communicate(timeout=20)
    assert process.returncode == 130 and "Traceback" not in words, words


def test_the_doctor(capsys: pytest.CaptureFixture[str]) -> None:
    assert casimir.doctor()
    words = capsys.readouterr().out
    assert "NumPy" in words and "ok    bits of a rigid body" in words
