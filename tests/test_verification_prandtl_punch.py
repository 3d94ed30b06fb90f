"""Verification: limit load of Prandtl's punch (coarse version)."""

from __future__ import annotations

import pytest

from tests.verification.prandtl_punch import verify


# The overshoot found is 0.43 to 0.52 times the spacing over the half-width; twice that would be another method.
@pytest.mark.parametrize(("size", "largest_overshoot"), [(0.2, 0.12), (0.1, 0.06)])
def test_the_limit_load_is_met_from_above(size: float, largest_overshoot: float) -> None:
    pressure = verify.mean_pressure(verify.punch(size))
    assert 0.0 < pressure.max() / verify.LIMIT - 1.0 < largest_overshoot
    # The load levels off: no locking.
    assert pressure[-1] - pressure[-9] < 5e-3 * verify.LIMIT
