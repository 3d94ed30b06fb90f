"""A rigid cylinder on an elastic half plane, against Hertz."""

from __future__ import annotations

import pytest

from tests.verification.hertz.reference import half_width, peak_pressure
from tests.verification.hertz.verify import POISSON, RADIUS, YOUNG, pressed


def test_half_width_and_peak_pressure() -> None:
    # Ten particles over the half-width; on finer meshes both come within 0.4 %.
    history = pressed(0.01, steps=5).history
    load = history["load"][-1]
    assert history["half_width"][-1] == pytest.approx(half_width(load, RADIUS, YOUNG, POISSON), rel=0.02)
    assert history["peak"][-1] == pytest.approx(peak_pressure(load, RADIUS, YOUNG, POISSON), rel=0.02)
