"""What several tests need."""

import os
from pathlib import Path

import pytest

import casimir

ROOT = Path(__file__).parents[2]


@pytest.fixture
def oscillator() -> casimir.Scene:
    system = casimir.System(
        state="q p",
        B="canonical",
        H0="(p^2 + k*q^2)/2",
        H=["sigma*q"],
        parameters={"k": 1.0, "sigma": 0.3},
        damping=0.1,
        title="Oscillator",
    )
    return system.scene(initial=[1, 0], until=2, steps=128, expect={"of": ["q"], "accuracy": 1e-2})


@pytest.fixture(scope="session")
def program() -> Path:
    """The program, built by `cargo build` or `cargo test`, or named by CASIMIR_PROGRAM."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    named = os.environ.get("CASIMIR_PROGRAM")
    places = [Path(named)] if named else [target / kind / "casimir" for kind in ("release", "debug")]
    for place in places:
        if place.exists():
            return place
    missing = "no program casimir: cargo build --release -p casimir-cli"
    if "CASIMIR_NEEDS_PYTHON" in os.environ:
        raise FileNotFoundError(missing)  # The gate has built it.
    pytest.skip(missing)
