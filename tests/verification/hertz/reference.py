"""Hertz's line contact of a rigid cylinder of radius R and an elastic half plane, E* = E / (1 - nu^2).

Johnson, Contact Mechanics, 1985, eqs. (4.43) to (4.45): for the load P per unit of width

    a = sqrt(4 P R / (pi E*)),   p(x) = p0 sqrt(1 - x^2 / a^2),   p0 = 2 P / (pi a) = sqrt(P E* / (pi R)).
"""

from __future__ import annotations

import numpy as np


def half_width(load: float, radius: float, young: float, poisson: float) -> float:
    """Half-width a (mm) of the contact under ``load`` (N/mm)."""
    return float(np.sqrt(4.0 * load * radius * (1.0 - poisson**2) / (np.pi * young)))


def peak_pressure(load: float, radius: float, young: float, poisson: float) -> float:
    """Pressure p0 (MPa) in the middle."""
    return 2.0 * load / (np.pi * half_width(load, radius, young, poisson))
