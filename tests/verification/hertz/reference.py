"""Hertz's line contact of a rigid cylinder of radius R and an elastic half plane, E* = E / (1 - nu^2).

Johnson, Contact Mechanics, 1985, eqs. (4.43) to (4.45): for the load P per unit of width

    a = sqrt(4 P R / (pi E*)),   p(x) = p0 sqrt(1 - x^2 / a^2),   p0 = 2 P / (pi a) = sqrt(P E* / (pi R)).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def half_width(load: float, radius: float, young: float, poisson: float) -> float:
    """Half-width a (mm) of the contact under ``load`` (N/mm)."""
    return float(np.sqrt(4.0 * load * radius * (1.0 - poisson**2) / (np.pi * young)))


def peak_pressure(load: float, radius: float, young: float, poisson: float) -> float:
    """Pressure p0 (MPa) in the middle."""
    return 2.0 * load / (np.pi * half_width(load, radius, young, poisson))


def beside_hertz(history: Mapping[str, NDArray[np.float64]], a: float, p0: float) -> dict[str, Any]:
    """Load, half-width and peak pressure at the end of a run, beside Hertz's ``a`` and ``p0`` at that load."""
    return {
        "load": float(history["load"][-1]),
        "a": float(history["half_width"][-1]),
        "a_hertz": a,
        "a_difference": float(history["half_width"][-1]) / a - 1.0,
        "last_loaded": float(history["last_loaded"][-1]),
        "p0": float(history["peak"][-1]),
        "p0_hertz": p0,
        "p0_difference": float(history["peak"][-1]) / p0 - 1.0,
    }
