"""Contact of a body with itself: uniform pressure across a slit, and a notch that closes."""

from __future__ import annotations

from tests.verification.self_contact import verify


def test_slit_passes_a_uniform_pressure_on() -> None:
    """Away from its ends to 2 %, in the mean to 0.1 %, with particles on its walls that do not match."""
    row = verify.patch_row(0.07)
    assert row["largest_error"] < 0.02
    assert abs(row["mean_error"]) < 1e-3
    assert row["force_imbalance"] < 1e-11


def test_notch_closes_and_its_walls_stay_apart() -> None:
    """A coarse one, in the first half of its way."""
    result = verify.closing_notch(0.3, **{"mesh.size": 0.1, "time.end": 1.6e-4})
    row = verify.notch_row(0.3, result)
    assert row["smallest_distance"] > 0.3
    assert row["contact_length"] > 0.1
    assert row["friction_work"] > 0.0
    assert abs(row["energy_error"]) < 0.02
    assert abs(row["heat_error"]) < 1e-3
