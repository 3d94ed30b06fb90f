"""Friction laws: shear traction over normal traction as a function of slip speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrictionRatio:
    """Shear over normal traction and its derivative by the slip speed (s/mm); shape (k,) each."""

    value: Array
    by_speed: Array


def regularised_coulomb(slip_speed: Array, coefficient: float, reference_speed: float) -> FrictionRatio:
    """mu tanh(v / V_ref) (paper, eq. 26) for the slip speed v (mm/s); shape (k,)."""
    ratio = np.tanh(slip_speed / reference_speed)
    return FrictionRatio(coefficient * ratio, coefficient * (1.0 - ratio**2) / reference_speed)
