"""Slip-line fields of a curled chip on a frictionless tool: balances that their construction does not use."""

from __future__ import annotations

import math

import pytest

from tests.verification.cutting_limits.slip_lines import curled_chip


@pytest.mark.parametrize("fan", [5.0, 15.0])
def test_power_and_volume_are_balanced(fan: float) -> None:
    """Plastic power is the tool's to 1e-5 (chords of half a degree), and the chip takes what the cut gives."""
    found = curled_chip(math.radians(fan))
    assert abs(found.power_error) < 1e-5
    assert abs(found.flux_error) < 1e-12
    assert found.tip_pressure > found.end_pressure


def test_straight_chip_of_lee_and_shaffer_is_the_limit() -> None:
    """With the fan vanish curvature, the excess of force (as its square) and of thickness."""
    found = curled_chip(math.radians(2.5), turns=10, fan=6)
    assert found.cutting_force == pytest.approx(1.0, abs=0.005)
    assert found.contact_length == pytest.approx(1.0, abs=0.005)
    assert found.primary_angle == pytest.approx(45.0 - 2.5, abs=0.3)
    assert found.curvature < 0.015


def test_figures_converge_with_the_chords() -> None:
    coarse, fine = (curled_chip(math.radians(10.0), n, n) for n in (6, 12))
    assert coarse.cutting_force == pytest.approx(fine.cutting_force, rel=1e-4)
    assert coarse.thickness == pytest.approx(fine.thickness, rel=2e-4)
