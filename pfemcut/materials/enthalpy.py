"""Specific enthalpy of a material whose specific heat is a table in temperature, and its inverse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pfemcut.materials.material import Property

Array = NDArray[np.float64]

_NEWTON_STEPS = 6  # quadratic from a guess nearby; one is exact where the specific heat is constant


def specific_enthalpy(capacity: Property, temperature: Array, start: float) -> Array:
    """int c dtheta (mm²/s²) from ``start`` to ``temperature`` (K), exact for the piecewise linear c; same shape."""
    if len(capacity.temperatures) == 1:
        return capacity.values[0] * (temperature - start)
    knots = np.unique(np.concatenate([[start], capacity.temperatures, [0.0, 1e4]]))
    values = capacity(knots)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(knots))])

    def primitive(at: Array) -> Array:
        piece = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
        return integral[piece] + 0.5 * (values[piece] + capacity(at)) * (at - knots[piece])

    return primitive(temperature) - primitive(np.array([start]))


def temperature_at(capacity: Property, enthalpy: Array, start: float, guess: Array) -> Array:
    """Temperature (K) of the specific ``enthalpy``, by Newton's method from a ``guess`` (K) nearby; same shape."""
    if len(capacity.temperatures) == 1:
        return start + enthalpy / capacity.values[0]
    temperature = guess
    for _ in range(_NEWTON_STEPS):
        missing = enthalpy - specific_enthalpy(capacity, temperature, start)
        temperature = temperature + missing / capacity(temperature)
        if np.max(np.abs(missing), initial=0.0) <= 1e-14 * np.max(np.abs(enthalpy), initial=0.0):
            break
    return temperature
