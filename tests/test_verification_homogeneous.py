"""Verification: homogeneous tension and shear against a one-point integration, and objectivity (coarse version)."""

from __future__ import annotations

import pytest

from tests.verification.homogeneous import verify


@pytest.mark.parametrize("name", ["tension", "shear"])
@pytest.mark.parametrize("adiabatic", [False, True])
def test_the_block_follows_the_one_point_integration(name: str, adiabatic: bool) -> None:
    coarse, fine = (verify.figures(name, steps, adiabatic) for steps in (25, 50))
    assert fine["stress_end_%"] < 0.25
    assert fine["eqps_end_%"] < 0.02
    assert fine["spread_MPa"] < 1e-3
    if adiabatic:
        assert fine["warming_end_%"] < 0.6
        # Backward Euler, staggered with the temperature: order one.
        assert fine["warming_end_%"] < 0.6 * coarse["warming_end_%"]


@pytest.mark.parametrize("integrator", ["implicit", "impl-ex"])
def test_a_superposed_rotation_changes_nothing(integrator: str) -> None:
    differences = verify.objectivity(integrator, 30)
    # A halved step would go through a point of the boundary's path that is no rotation.
    assert differences["step_cuts"] == 0
    assert differences["largest_eqps"] > 0.4
    assert differences["position_mm"] < 1e-9
    assert differences["stress_MPa"] < 1e-4
    assert differences["eqps"] < 1e-9
    assert differences["temperature_K"] < 1e-7
