"""Parameters from data."""

import math
import random
from pathlib import Path
from typing import Any

import pytest

import casimir


def samples(number: int) -> dict[str, list[float]]:
    """Kubo's oscillator by its exact law, with sigma = 0.5 and the damping 0.1."""
    draw, columns = random.Random(5), dict[str, list[float]](t=[], q=[], p=[])
    for t in (0.5, 1.0, 1.5, 2.0):
        for _ in range(number):
            angle = t + 0.5 * math.sqrt(t) * draw.gauss(0, 1)
            columns["t"].append(t)
            columns["q"].append(math.exp(-0.1 * t) * math.cos(angle))
            columns["p"].append(-math.exp(-0.1 * t) * math.sin(angle))
    return columns


def test_parameters_are_those_of_the_samples(tmp_path: Path) -> None:
    scene, data = casimir.scene("kubo"), samples(250)
    found = scene.fit(data, "sigma", seed=3)
    sigma = found.parameters["sigma"]
    # Four half-widths: 1e-14 for a normal error.
    assert abs(sigma.value - 0.5) < 2 * sigma.half_width < 0.1
    assert found.reached and found.degrees == 11 and 1e-4 < (found.probability or 0) <= 1
    assert set(found.figures) >= {"fit-q-mean", "fit-p-variance"}
    assert found.covariance.shape == (1, 1) and not found.warnings
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(data)
    for same in (frame, frame.set_index("t")):
        assert scene.fit(same, ["sigma"], seed=3).parameters == found.parameters
    file = tmp_path / "data.csv"
    frame.to_csv(file, index=False)
    assert scene.fit(file, ["sigma"], seed=3).parameters == found.parameters
    kept = scene.fit(data, ["sigma"], seed=3, resume=tmp_path / "kept")
    assert kept.parameters == found.parameters and not list(tmp_path.glob("kept/*"))
    assert len(found.to_pandas()) == 16


def test_wrong_data_are_refused() -> None:
    scene, data = casimir.scene("kubo"), samples(40)
    calls: list[tuple[Any, Any, str]] = [
        (data, "s", "no parameter `s` to fit; there are sigma"),
        ({**data, "x": data["q"]}, "sigma", "no observable `x`; there are p, q"),
        ({"t": data["t"], "q": [math.nan, *data["q"][1:]]}, "sigma", "`nan` in the column `q`"),
        (3, "sigma", "got int"),
        ("none.csv", "sigma", "cannot read the data none.csv"),
    ]
    for table, parameters, words in calls:
        with pytest.raises(casimir.SceneError, match=words.replace("(", ".")):
            scene.fit(table, parameters)
