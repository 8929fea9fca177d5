"""Runs that ask for a graphics card."""

import casimir
import pytest


def test_without_a_card_the_reason_is_named() -> None:
    scene = casimir.scene("kubo")
    with pytest.raises(casimir.SceneError, match="'cpu' or 'gpu', got 'tpu'"):
        scene.run(on="tpu")  # type: ignore[arg-type]
    try:
        run = scene.run(on="gpu", paths=128, steps=10)
    except casimir.RunError as error:
        assert "no graphics card can be used" in str(error)
    else:
        assert run.to_pandas().equals(scene.run(paths=128, steps=10).to_pandas())
