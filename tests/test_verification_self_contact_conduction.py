"""Heat across the contact of a body with itself: coarse versions of the verification."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.self_contact_conduction import verify
from tests.verification.two_body_conduction.reference import jump


def test_perfect_contact_is_as_no_slit() -> None:
    """No jump beside 500 K, temperatures to 0.5 %, and no heat lost."""
    method, drift = verify.conducted()
    lower, upper = verify.walls(method)
    assert abs(upper - lower) < 0.5
    assert verify.profile_error(method) < 0.005
    assert abs(drift) < 1e-9


def test_a_conductance_leaves_a_jump() -> None:
    """To 1 %."""
    method, drift = verify.conducted(conductance=50.0)
    lower, upper = verify.walls(method)
    b = verify.EFFUSIVITY
    wanted = float(jump(np.array([verify.END]), verify.HOT - verify.COLD, 50.0, b, b)[0])
    assert upper - lower == pytest.approx(wanted, rel=0.01)
    assert abs(drift) < 1e-9


def test_no_conductance_insulates() -> None:
    method, _ = verify.conducted(conductance=0.0)
    lower, upper = verify.walls(method)
    assert upper - lower > 499.0
