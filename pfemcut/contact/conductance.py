"""Heat through the interface of two bodies in contact (paper, section 5.2.3, eq. 29)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Conductance:
    """Conductance of an interface, h = h_0 (P_N / P_0)^n; heat flux Q = h times the jump of temperature (eq. 29).

    With n = 0 it is the paper's constant. A rough conforming contact has n = 0.95: M. G. Cooper, B. B. Mikic,
    M. M. Yovanovich, Thermal contact conductance, Int. J. Heat Mass Transfer 12, 1969, 279-300.

    Attributes
    ----------
    value
        h_0 (N/(mm s K); 1e-3 of the number in W/(m² K)); zero insulates.
    reference_pressure
        P_0 (MPa).
    exponent
        n.
    """

    value: float
    reference_pressure: float = 1.0
    exponent: float = 0.0

    def __call__(self, pressure: Array) -> Array:
        """h (N/(mm s K)) at the ``pressure`` (MPa), zero where there is none; shape (k,)."""
        touching = pressure > 0.0
        ratio = np.where(touching, pressure, self.reference_pressure) / self.reference_pressure
        return np.where(touching, self.value * ratio**self.exponent, 0.0)
