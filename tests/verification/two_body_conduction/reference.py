"""Two half spaces brought into contact, of effusivities b = sqrt(k rho c).

Carslaw and Jaeger, Conduction of Heat in Solids, 1959, section 2.15: perfect contact gives at once the interface
temperature (b_1 theta_1 + b_2 theta_2) / (b_1 + b_2), and error functions on either side. With the conductance h the
jump decays as exp(s^2) erfc(s), s = h sqrt(t) (1/b_1 + 1/b_2). A constant power of friction q in a perfect contact
warms it by 2 q sqrt(t / pi) / (b_1 + b_2), however q is shared out (section 2.9, both surfaces having one temperature).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf, erfcx

Array = NDArray[np.float64]


def interface_temperature(first: float, second: float, b_first: float, b_second: float) -> float:
    """Temperature (K) of the interface in perfect contact."""
    return (b_first * first + b_second * second) / (b_first + b_second)


def profile(depth: Array, time: float, surface: float, far: float, diffusivity: float) -> Array:
    """Temperature (K) at ``depth`` (mm) below the interface."""
    return surface + (far - surface) * erf(depth / np.sqrt(4.0 * diffusivity * time))


def jump(time: Array, start: float, conductance: float, b_first: float, b_second: float) -> Array:
    """Jump of temperature (K) over an interface with ``conductance`` (N/(mm s K)), ``start`` at time zero."""
    return start * erfcx(conductance * np.sqrt(time) * (1.0 / b_first + 1.0 / b_second))


def heat(time: Array, start: float, conductance: float, b_first: float, b_second: float) -> Array:
    """Heat per area (mJ/mm²) through that interface until ``time`` (s)."""
    rate = conductance * (1.0 / b_first + 1.0 / b_second)
    s = rate * np.sqrt(time)
    return conductance * start / rate**2 * (erfcx(s) - 1.0 + 2.0 * s / np.sqrt(np.pi))


def friction_rise(time: Array, power: float, b_first: float, b_second: float) -> Array:
    """Rise of the interface (K) under ``power`` (N/(mm s)) of friction in perfect contact."""
    return 2.0 * power * np.sqrt(time / np.pi) / (b_first + b_second)
