"""Hertz's line contact of an elastic cylinder of radius R and an elastic half plane.

Johnson, Contact Mechanics, 1985, eqs. (4.43) to (4.45), with 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2: for the
load P per unit of width

    a = sqrt(4 P R / (pi E*)),   p(x) = p0 sqrt(1 - x^2 / a^2),   p0 = 2 P / (pi a).
"""

from __future__ import annotations

import numpy as np


def effective_modulus(one: tuple[float, float], two: tuple[float, float]) -> float:
    """E* (MPa) of two bodies with Young's modulus and Poisson's ratio."""
    return 1.0 / sum((1.0 - poisson**2) / young for young, poisson in (one, two))


def half_width(load: float, radius: float, one: tuple[float, float], two: tuple[float, float]) -> float:
    """Half-width a (mm) of the contact under ``load`` (N/mm)."""
    return float(np.sqrt(4.0 * load * radius / (np.pi * effective_modulus(one, two))))


def peak_pressure(load: float, radius: float, one: tuple[float, float], two: tuple[float, float]) -> float:
    """Pressure p0 (MPa) in the middle."""
    return 2.0 * load / (np.pi * half_width(load, radius, one, two))
