r"""Elastic, perfectly plastic layer between rigid walls, heated and cooled, plane strain.

With eps_xx = eps_zz = 0 and a free surface (sigma_yy = 0) every depth is alone: the stress is equibiaxial, von Mises'
is its size, and elastically d sigma = -E alpha / (1 - nu) d theta (Timoshenko and Goodier, Theory of Elasticity, 3rd
ed., 1970, art. 149, for the constrained plate). A depth that was heated by no more than its yield temperature
theta_y = sigma_y (1 - nu) / (E alpha) is without stress afterwards; one that yielded in compression
keeps what the cooling takes back too much,

    sigma_xx = sigma_zz = min(E alpha dtheta / (1 - nu) - sigma_y, sigma_y),

where the bound is yield in tension, from 2 theta_y on. dtheta is the largest heating of that depth.

Released walls: as long as the layer stays elastic and is long, sections stay plane and it takes back force and moment,

    sigma_xx -> sigma_xx - (a + b y),   sigma_zz -> sigma_zz - nu (a + b y),

with a + b y the straight line that has the force and moment of sigma_xx (ibid., art. 150).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

Array = NDArray[np.float64]

YIELD_STRESS = 600.0
POISSON_RATIO = 0.3
STRESS_PER_KELVIN = 210e3 * 1.2e-5 / (1.0 - POISSON_RATIO)
YIELD_HEATING = YIELD_STRESS / STRESS_PER_KELVIN


def residual_stress(heating: Array) -> Array:
    """sigma_xx = sigma_zz (MPa) after cooling, by the largest heating (K) of each depth."""
    return np.clip(STRESS_PER_KELVIN * heating - YIELD_STRESS, 0.0, YIELD_STRESS)


def plastic_strain(heating: Array) -> Array:
    """Equivalent plastic strain: forward, and backward where it yields in tension. Small strain."""
    too_much = np.maximum(heating - YIELD_HEATING, 0.0)
    back = np.maximum(heating - 2.0 * YIELD_HEATING, 0.0)
    # Equibiaxial flow: eps_zz = eps_xx = -alpha dtheta, eps_yy = 2 alpha dtheta, so eps_eq = 2 |eps_xx|.
    return 2.0 * 1.2e-5 * (too_much + back)


def released(depth: Array, stress: Array) -> tuple[Array, Array]:
    """sigma_xx and sigma_zz (MPa) after the walls let go, from ``stress`` at ``depth`` (mm) down to the bottom."""
    one = np.ones_like(depth)
    basis = np.column_stack([one, depth])
    # The line with the same force and moment, integrals by the trapezoidal rule.
    gram = trapezoid(basis[:, :, None] * basis[:, None, :], depth, axis=0)
    line = basis @ np.linalg.solve(gram, trapezoid(basis * stress[:, None], depth, axis=0))
    return stress - line, stress - POISSON_RATIO * line
