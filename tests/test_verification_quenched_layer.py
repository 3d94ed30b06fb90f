"""Verification: a layer heated until it yields and cooled between rigid walls, which then let go (coarse version)."""

from __future__ import annotations

from functools import cache

from tests.verification.quenched_layer import verify


@cache
def clamped() -> verify.Quench:
    return verify.layer(0.04)


def test_the_layer_keeps_the_exact_residual_stress() -> None:
    figures = verify.figures(clamped())
    # In percent of the yield stress; a layer without residual stress would have 30.
    assert figures["xx_rms_%"] < 3.0
    assert figures["zz_rms_%"] < 3.0
    assert figures["yy_largest_%"] < 3.0
    assert figures["plastic_strain_largest_%"] < 20.0
    assert abs(figures["force"] / figures["exact_force"] - 1.0) < 0.05


def test_cooling_ends_at_the_temperature_of_the_surroundings() -> None:
    temperature = clamped().method.current.fields.temperature
    assert abs(temperature - 293.15).max() < 1e-3


def test_released_walls_carry_nothing_and_the_section_balances() -> None:
    free = verify.layer(0.08, verify.STIFF, verify.LONG, release=True)
    figures = verify.released_figures(clamped(), free)
    assert figures["reaction"] < 1e-3  # N/mm; the walls held 40
    assert abs(figures["force_over_its_size_%"]) < 2.0
    assert figures["xx_rms_%"] < 5.0
    assert figures["zz_rms_%"] < 5.0
