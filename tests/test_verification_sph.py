"""Coarse versions of SPH's verification problems; those of waves, tension and heat are in the methods' own tests."""

from __future__ import annotations

import pytest

from tests.verification.sph_exactness.verify import gradient_error, rotated
from tests.verification.sph_plate.reference import ritz, thin_plate
from tests.verification.sph_plate.verify import PLATE, linear_error, stepped_period
from tests.verification.sph_point.verify import errors
from tests.verification.sph_waves.integrators import change
from tests.verification.sph_waves.verify import PERIOD, bar


@pytest.mark.parametrize("method", ["tlsph", "esph"])
def test_linear_fields_and_rotations_are_exact(method: str) -> None:
    """Gradients to 1e-13; a turn in ten steps leaves 1e-8 MPa, and the density to 1e-12."""
    assert gradient_error(method, 3, corrected=True) < 1e-13
    turned = rotated(method, 2, steps=10)
    assert turned["von_mises_MPa"] < 1e-8
    assert turned["volume"] < 1e-12


@pytest.mark.parametrize("method", ["tlsph", "esph"])
def test_shear_is_that_of_the_one_point_integration(method: str) -> None:
    """In 50 steps stress to 0.3 %, plastic strain to 0.02 %, warming (first order) to 0.6 %; all particles alike."""
    found = errors(method, 50, renew=0.5)
    assert abs(found["stress_error_%"]) < 0.3
    assert abs(found["eqps_error_%"]) < 0.02
    assert abs(found["warming_error_%"]) < 0.6
    assert found["spread_MPa"] < 1e-9


def test_a_thin_plate_is_one_in_plane_elasticity() -> None:
    """Ten times as long as thick: thin-plate theory is 0.4 % too fast; with forty times, within 0.1 %."""
    assert thin_plate(*PLATE) / ritz(*PLATE) == pytest.approx(1.004, abs=0.002)
    thin = (40.0, *PLATE[1:])
    assert thin_plate(*thin) / ritz(*thin) == pytest.approx(1.0, abs=0.002)


def test_a_plate_is_too_slow_by_an_error_of_second_order() -> None:
    """20 % with 6 particles across, and a third of that with 12; in time as in the linear equations, to 1 %."""
    six, twelve = linear_error(6), linear_error(12)
    assert 0.18 < six < 0.22
    assert 3.0 < six / twelve < 4.5


@pytest.mark.slow
def test_a_plate_in_time_is_as_slow_as_the_linear_equations_say() -> None:
    found = stepped_period(6) / (6.283185307179586 / ritz(*PLATE)) - 1.0
    assert found == pytest.approx(linear_error(6), abs=0.01)


def test_leapfrog_keeps_energy_better_than_a_predictor_corrector_of_the_same_cost() -> None:
    """Over two periods of a bar: ten times better, at the same number of evaluations."""

    def energy(scheme: str, courant: float) -> float:
        problem = bar(10, method="tlsph", zero_energy=0.0, courant=courant)
        return abs(change(problem, scheme, 2.0 * PERIOD))

    assert energy("leapfrog", 0.3) < 0.1 * energy("predictor-corrector, PECE", 0.6)
