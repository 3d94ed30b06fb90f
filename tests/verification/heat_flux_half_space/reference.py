"""Half space with constant heat flux: exact, and exact in space with backward Euler in time.

Carslaw and Jaeger, Conduction of Heat in Solids, 2nd ed. 1959, section 2.9, eq. (7): with the diffusivity
a = k/(rho c) and the flux q from time zero on, at depth z

    T(z, t) = 2 q/k [ sqrt(a t/pi) exp(-z^2/(4 a t)) - z/2 erfc(z/(2 sqrt(a t))) ].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfc
from scipy.stats import gamma

Array = NDArray[np.float64]


def exact(depth: Array, time: float, flux: float, conductivity: float, diffusivity: float) -> Array:
    """Temperature rise (K) at ``depth`` (mm)."""
    root = np.sqrt(diffusivity * time)
    return (
        2.0
        * flux
        / conductivity
        * (
            root / np.sqrt(np.pi) * np.exp(-((depth / (2.0 * root)) ** 2))
            - 0.5 * depth * erfc(depth / (2.0 * root))
        )
    )


def backward_euler(
    depth: Array, steps: int, step: float, flux: float, conductivity: float, diffusivity: float
) -> Array:
    """Temperature rise (K) after ``steps`` of backward Euler, exact in space.

    k backward-Euler steps of the heat equation spread a point source like the heat kernel averaged over a
    gamma-distributed time with shape k and scale dt; the sum over k of the densities is 1/dt up to the last step.
    """
    # T_N = integral over s of sum_k gamma(s; k, dt) dt g(s), g = dT/dt the answer to a unit of heat, so that
    # T_N = integral of T(s) times minus the derivative of the weight, which is the density of gamma(N, dt).
    u = (np.arange(4000) + 0.5) / 4000.0
    times = gamma.ppf(u, steps, scale=step)
    return np.mean([exact(depth, s, flux, conductivity, diffusivity) for s in times], axis=0)
