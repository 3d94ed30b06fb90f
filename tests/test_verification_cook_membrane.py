"""Verification: Cook's membrane against Taylor-Hood elements (coarse version)."""

from __future__ import annotations

import pytest

from tests.verification.cook_membrane import verify


def test_small_strain_tip() -> None:
    assert verify.tip(verify.elastic(1.5, 0.1, 1)) == pytest.approx(verify.SMALL_STRAIN, rel=0.015)


def test_finite_strain_tip_and_a_smooth_pressure() -> None:
    found = verify.elastic(1.5)
    assert verify.tip(found) == pytest.approx(
        verify.taylor_hood("neo_hookean.csv", force="100.0")[-1], rel=0.01
    )
    pressure = verify.pressure_figures(found)
    assert pressure["pressure_error_%"] < 5.0
    # Without stabilisation the pressure of a particle is off its neighbours' by 60 % of the field.
    assert pressure["roughness_%"] < 1.5


def test_plastic_tip() -> None:
    exact = verify.taylor_hood("plastic.csv", steps="50", load_spread_over="initial length")[-1]
    assert verify.tip(verify.plastic(3.0, 20)) == pytest.approx(exact, rel=0.06)


def test_taylor_hood_in_numpy_and_in_dolfinx_agree() -> None:
    from tests.verification.cook_membrane import taylor_hood_plastic as numpy_elements

    rubber = numpy_elements.Metal(240.565 / 2.9998, 240.565 / 0.0006, numpy_elements.np.inf)
    _, uy, _ = numpy_elements.tip_displacement(8, 100.0, 4, rubber)
    assert uy == pytest.approx(verify.taylor_hood("neo_hookean.csv", force="100.0")[0], rel=1e-5)
