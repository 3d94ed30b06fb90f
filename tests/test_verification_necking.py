"""Necking of a plane-strain strip on a coarse mesh agrees with an independent F-bar solution, remeshed or not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.verification.necking.reference import considere_force, read_curve, solve
from tests.verification.necking.verify import curve, difference, value

FOLDER = Path(__file__).parent / "verification"


@pytest.fixture(scope="module")
def isothermal() -> dict[bool, dict[str, np.ndarray]]:
    return {remesh: curve(1.6, "isothermal", remesh, step=0.02) for remesh in (False, True)}


def test_the_force_until_8_mm_is_the_reference_s(isothermal) -> None:
    reference = read_curve(FOLDER / "necking" / "reference_isothermal.csv")
    for remesh in (False, True):
        assert difference(isothermal[remesh], reference, "force", 5.0) < 0.001
        assert (
            difference(isothermal[remesh], reference, "force", 8.0) < 0.015
        )  # four elements across the neck
        assert isothermal[remesh]["force"].max() == pytest.approx(reference["force"].max(), rel=1e-3)


def test_remeshing_every_step_changes_the_force_by_less_than_a_percent(isothermal) -> None:
    assert difference(isothermal[True], isothermal[False], "force", 8.0) < 0.01


def test_the_largest_force_is_considere_s(isothermal) -> None:
    # The lateral stress in the neck, which the one-dimensional theory leaves out, adds 0.2 %.
    assert isothermal[True]["force"].max() == pytest.approx(considere_force(), rel=4e-3)


def test_heat_softens_as_in_the_reference() -> None:
    reference = read_curve(FOLDER / "necking" / "reference_adiabatic.csv")
    found = curve(1.6, "adiabatic", True, step=0.02)
    assert difference(found, reference, "force", 6.0) < 0.005
    assert value(found, "warming", 5.0) == pytest.approx(value(reference, "warming", 5.0), rel=0.05)


def test_the_stored_reference_is_what_its_code_gives() -> None:
    reference = read_curve(FOLDER / "necking" / "reference_isothermal.csv")
    assert difference(solve(16, 5, 6.0, 40, False), reference, "force", 6.0) < 1e-3
