"""Specific cutting energy (MPa = N/mm² = J/cm³): tool work per volume cut, at the present force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def specific_energy(cutting_force: Array, depth: float) -> Array:
    """Return cutting force (N/mm) over depth of cut (mm)."""
    return cutting_force / depth
