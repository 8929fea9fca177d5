"""What to cite for a result."""

import subprocess
from pathlib import Path

import pytest

import casimir


def keys(text: str) -> set[str]:
    lines = (line for line in text.splitlines() if line.startswith("@"))
    return {line.split("{")[1].rstrip(",") for line in lines}


ALWAYS = {"Casimir", "BrehierCohenKomori2025"}
SOBOL = {"Sobol1967", "JoeKuo2008", "Owen1995", "Burley2020"}


def test_a_result_names_what_it_used(oscillator: casimir.Scene) -> None:
    assert keys(casimir.citation(oscillator.inspect())) == ALWAYS
    assert keys(casimir.citation(oscillator.run(scheme="heun"))) == ALWAYS | {"Ruemelin1982"}
    assert keys(casimir.citation(oscillator.expect(scheme="sexp"))) == ALWAYS | SOBOL | {"Giles2008"}
    areas = casimir.sweep(oscillator.with_(scheme="sexp-levy"), sigma=[0.1, 0.2]).run()
    assert keys(casimir.citation(areas)) == ALWAYS | {"MrongowiusRoessler2022"}
    body = casimir.scene("rigid-body")
    order = body.order(path_steps=10**6, scheme="nv")
    assert keys(casimir.citation(order)) == ALWAYS | {"NinomiyaVictoir2008"}
    compared = keys(casimir.citation(body.compare(error=0.1, budget=0.5)))
    assert compared > ALWAYS | {"BrehierCohenJahnke2023", "NinomiyaVictoir2008", "Maruyama1955"}
    assert not compared & SOBOL
    found = casimir.scene("langevin").equilibrium(accuracy=0.05, scheme="midpoint")
    assert keys(casimir.citation(found)) == ALWAYS | {"MilsteinRepinTretyakov2002"}


def test_all_is_what_the_program_prints(program: Path) -> None:
    said = subprocess.run([program, "--citation"], capture_output=True, text=True, check=True)
    assert casimir.citation() == said.stdout and len(keys(said.stdout)) > 10


def test_other_things_are_refused(oscillator: casimir.Scene) -> None:
    with pytest.raises(TypeError, match="of results, not of Scene"):
        casimir.citation(oscillator)  # type: ignore[arg-type]
