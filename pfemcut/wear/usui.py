r"""Usui's adhesive wear: the depth that a tool loses in a second where a chip or a workpiece slides along it.

.. math:: \frac{dW}{dt} = A \sigma_n v_s \exp(-B/T)

with the normal pressure σ_n, the sliding speed v_s and the absolute temperature T of the interface. E. Usui,
T. Shirakashi, T. Kitagawa, "Analytical prediction of three dimensional cutting process, part 3: cutting temperature
and crater wear of carbide tool", J. Eng. Ind. 100 (1978) 236-243; by the same, "Analytical prediction of cutting tool
wear", Wear 100 (1984) 129-151, for flank wear too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Constants:
    """A (1/MPa) and B (K), at and above a temperature (K)."""

    temperature: float
    A: float
    B: float


@dataclass(frozen=True)
class UsuiWear:
    """Usui's law for a pair of tool and workpiece.

    Attributes
    ----------
    name
        Of the pair.
    ranges
        Constants by temperature, rising, the first from 0 K.
    source, checked
        Where the constants come from, and against what they were checked.
    """

    name: str
    ranges: tuple[Constants, ...]
    source: str
    checked: str

    def __call__(self, pressure: Array, sliding_speed: Array, temperature: Array) -> Array:
        """Depth worn off in a second (mm/s).

        Parameters
        ----------
        pressure
            Normal pressure (MPa), any shape.
        sliding_speed
            Sliding speed (mm/s), either sign, of the same shape.
        temperature
            Of the interface (K), of the same shape.
        """
        factors = np.array([each.A for each in self.ranges])
        activations = np.array([each.B for each in self.ranges])
        borders = np.array([each.temperature for each in self.ranges[1:]])
        at = np.searchsorted(borders, temperature, side="right")
        return np.asarray(
            factors[at] * pressure * np.abs(sliding_speed) * np.exp(-activations[at] / temperature)
        )
