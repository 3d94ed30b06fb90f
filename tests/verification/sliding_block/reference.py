"""A rigid block on a flat face with regularised Coulomb friction mu tanh(v / V_ref), normal force N, mass m.

Sliding at a prescribed speed: force mu N tanh(v / V_ref), heat force times v t. Sticking under a drag D < mu N: the
regularisation lets it creep at V_ref atanh(D / (mu N)). Coasting, m v' = -mu N tanh(v / V_ref) is integrated by
sinh(v / V_ref) = sinh(v_0 / V_ref) exp(-mu N t / (m V_ref)): but for the last V_ref it decelerates at mu N / m, stops
after m v_0 / (mu N), and all of m v_0^2 / 2 becomes heat.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def creep_speed(ratio: float, reference_speed: float) -> float:
    """Speed (mm/s) at which friction carries ``ratio`` of mu N."""
    return reference_speed * float(np.arctanh(ratio))


def coasting_speed(time: Array, start: float, deceleration: float, reference_speed: float) -> Array:
    """Speed (mm/s) after ``time`` (s) from ``start`` (mm/s)."""
    # log(sinh(x)) = x + log((1 - exp(-2 x)) / 2), to avoid overflow
    x = start / reference_speed
    log = x + np.log(0.5 * (1.0 - np.exp(-2.0 * x))) - deceleration * time / reference_speed
    large = log > 20.0
    return reference_speed * np.where(large, log + np.log(2.0), np.arcsinh(np.exp(np.minimum(log, 20.0))))
