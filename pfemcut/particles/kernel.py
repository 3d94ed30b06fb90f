"""The cubic B-spline kernel (Monaghan and Lattanzio 1985, Astron. Astrophys. 149, 135) and its slope.

W(r) = a w(r/h) with w = 1 - 1.5 q² + 0.75 q³ for q < 1 and 0.25 (2 - q)³ for 1 <= q < 2; its support is 2h.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

SUPPORT = 2.0
"""Radius of the support over the smoothing length."""


def normalisation(smoothing_length: float, dimension: int) -> float:
    """The factor a (1/mm^d) that makes the integral of W one."""
    h = smoothing_length
    return {1: 2.0 / (3.0 * h), 2: 10.0 / (7.0 * math.pi * h**2), 3: 1.0 / (math.pi * h**3)}[dimension]


def weights(distance: Array, smoothing_length: float, dimension: int) -> Array:
    """W (1/mm^d) at each ``distance`` (mm); same shape."""
    q = distance / smoothing_length
    inner = 1.0 - 1.5 * q**2 + 0.75 * q**3
    outer = 0.25 * np.maximum(SUPPORT - q, 0.0) ** 3
    return normalisation(smoothing_length, dimension) * np.where(q < 1.0, inner, outer)


def slopes(distance: Array, smoothing_length: float, dimension: int) -> Array:
    """dW/dr (1/mm^(d+1)), never positive, at each ``distance`` (mm); same shape."""
    q = distance / smoothing_length
    inner = -3.0 * q + 2.25 * q**2
    outer = -0.75 * np.maximum(SUPPORT - q, 0.0) ** 2
    return normalisation(smoothing_length, dimension) / smoothing_length * np.where(q < 1.0, inner, outer)


@njit(inline="always")
def shape(q):  # type: ignore[no-untyped-def]
    """The function w of one q."""
    if q < 1.0:
        return 1.0 - 1.5 * q * q + 0.75 * q * q * q
    return 0.25 * (2.0 - q) ** 3 if q < 2.0 else 0.0


@njit(inline="always")
def shape_slope(q):  # type: ignore[no-untyped-def]
    """Its derivative dw/dq."""
    if q < 1.0:
        return -3.0 * q + 2.25 * q * q
    return -0.75 * (2.0 - q) ** 2 if q < 2.0 else 0.0
