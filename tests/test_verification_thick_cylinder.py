"""Verification: thick-walled cylinder of perfectly plastic metal under internal pressure (coarse version)."""

from __future__ import annotations

import pytest

from tests.verification.thick_cylinder import reference as exact
from tests.verification.thick_cylinder import verify


def test_limit_pressure_and_curve_at_small_strain() -> None:
    figures = verify.figures(verify.cylinder(12.5, verify.STIFF), verify.STIFF)
    assert figures["largest_pressure"] == pytest.approx(192.09, rel=0.01)
    assert figures["pressure_from_radial_%"] < 1.0
    assert figures["outer_from_radial_%"] < 1.0


def test_finite_strain_lowers_the_limit_as_a_rigid_plastic_cylinder() -> None:
    found = verify.cylinder(12.5)
    figures = verify.figures(found, 1.0)
    assert -1.0 < figures["limit_difference_%"] < -0.4
    assert abs(figures["last_over_finite_strain_limit_%"]) < 0.2
    # The work of the gradient motion is in the ledger.
    assert abs(found.history["energy_error"][-1]) < 2e-3


def test_the_radial_solution_reaches_the_exact_limit() -> None:
    pressure, _ = exact.radial_solution(exact.np.linspace(0.01, 1.0, 50), elements=100)
    assert pressure.max() == pytest.approx(exact.LIMIT_PRESSURE, rel=5e-4)
