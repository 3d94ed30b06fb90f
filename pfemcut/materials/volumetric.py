"""Volumetric thermo-elastic law (paper, eq. 7) and its inverse.

U(J) = kappa/2 ln² J and M(theta, J) = -3 alpha kappa (ln J / J)(theta - theta_0) give the Cauchy pressure

    p / kappa = ln J / J - e (1 - ln J) / J²,   e = 3 alpha (theta - theta_0)

(the paper's Box 2 prints J p without its factor).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ITERATIONS = 30


def dilation(volume_ratio: Array, thermal_strain: Array) -> Array:
    """p / kappa for the volume ratio J and the thermal strain e; any common shape."""
    log = np.log(volume_ratio)
    return log / volume_ratio - thermal_strain * (1.0 - log) / volume_ratio**2


def volume_ratio_from_pressure(pressure_ratio: Array, thermal_strain: Array) -> Array:
    """J that gives p / kappa = ``pressure_ratio`` at the thermal strain e (Newton's method); any common shape."""
    ratio = 1.0 + pressure_ratio + thermal_strain
    for _ in range(_ITERATIONS):
        log = np.log(ratio)
        slope = (1.0 - log) / ratio**2 + thermal_strain * (3.0 - 2.0 * log) / ratio**3
        change = (pressure_ratio - dilation(ratio, thermal_strain)) / slope
        ratio = np.clip(ratio + change, 0.5, 2.0)
        if np.max(np.abs(change), initial=0.0) < 1e-14:
            break
    return ratio


def free_expansion(volume_ratio: Array, thermal_strain: Array) -> Array:
    """d ln J / d e at constant pressure, which is 1 in a small deformation; any common shape."""
    log = np.log(volume_ratio)
    return (1.0 - log) / (volume_ratio * (1.0 - log) + thermal_strain * (3.0 - 2.0 * log))
