"""A flat tool on a flat block presses uniformly whatever the spacing."""

from __future__ import annotations

import pytest

from tests.verification.contact_patch.reference import contact_pressure
from tests.verification.contact_patch.verify import HEIGHT, POISSON, STEPS, TRAVEL, YOUNG, pressed


@pytest.mark.parametrize("penalty", [4e5, 4e7])
def test_uniform_pressure(penalty: float) -> None:
    result = pressed(0.2, 0.02, penalty)
    pressure = result.method.frame().contact.pressure
    force, expected = contact_pressure(TRAVEL, STEPS, HEIGHT, penalty, YOUNG, POISSON)
    assert pressure == pytest.approx(expected, rel=1e-8)
    assert result.history["thrust_force"][-1] == pytest.approx(force, rel=1e-8)
