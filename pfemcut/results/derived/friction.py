"""Apparent friction coefficient: tangential over normal force on the rake face, from the two measured forces."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def apparent_friction(cutting_force: Array, thrust_force: Array, rake: float) -> Array:
    """Return (F_t cos γ + F_c sin γ) / (F_c cos γ − F_t sin γ).

    The forces of the tip and the flank are included, as they are in an experiment, so this is larger than the
    coefficient of the contact law.

    Parameters
    ----------
    cutting_force, thrust_force
        Forces on the tool (N/mm), any shape.
    rake
        Rake angle γ (degrees).
    """
    cosine, sine = math.cos(math.radians(rake)), math.sin(math.radians(rake))
    tangential = thrust_force * cosine + cutting_force * sine
    normal = cutting_force * cosine - thrust_force * sine
    return np.asarray(tangential / np.where(normal == 0.0, np.nan, normal))
