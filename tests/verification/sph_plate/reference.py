"""Frequencies of a plate in plane strain: thin-plate theory, and a Ritz solution of the plane problem.

Thin plate (Landau and Lifshitz, Theory of Elasticity, section 25): omega² = E H² k⁴ / (12 rho (1 - nu²)), with
kL = 1.8751 for a plate that is clamped at one end. The Ritz solution has Legendre polynomials along and across, times
the distance from the clamp; it knows shear and the clamp's corner, and nothing of particles.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

Array = NDArray[np.float64]

CLAMPED_FREE = 1.875104


def thin_plate(length: float, thickness: float, young: float, poisson: float, density: float) -> float:
    """Angular frequency of the first mode."""
    stiffness = young * thickness**2 / (12.0 * density * (1.0 - poisson**2))
    return float(np.sqrt(stiffness) * (CLAMPED_FREE / length) ** 2)


def ritz(
    length: float,
    thickness: float,
    young: float,
    poisson: float,
    density: float,
    clamped: bool = True,
    degrees: tuple[int, int] = (24, 6),
) -> float:
    """Angular frequency of the first mode, clamped at x = 0 or free; an upper bound that falls with the ``degrees``."""
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * young / (1.0 + poisson)
    mx, kx, cx = _matrices(degrees[0], length, clamped)
    my, ky, cy = _matrices(degrees[1], thickness, clamped=False)
    mixed = lame * np.kron(cx, cy.T) + shear * np.kron(cx.T, cy)
    axial = lame + 2.0 * shear
    stiffness = np.block(
        [
            [axial * np.kron(kx, my) + shear * np.kron(mx, ky), mixed],
            [mixed.T, axial * np.kron(mx, ky) + shear * np.kron(kx, my)],
        ]
    )
    mass = density * block_diag(np.kron(mx, my), np.kron(mx, my))
    first = 0 if clamped else 3  # a free plate moves as a rigid body in three ways
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True, subset_by_index=[first, first])[0]))


def _matrices(degree: int, length: float, clamped: bool) -> tuple[Array, Array, Array]:
    """Integrals of f g, f' g' and f' g over the length for all pairs of functions."""
    points, weights = legendre.leggauss(degree + 4)
    value = legendre.legvander(points, degree)
    slope = np.column_stack([legendre.legval(points, legendre.legder(unit)) for unit in np.eye(degree + 1)])
    if clamped:
        value, slope = (1.0 + points)[:, None] * value, value + (1.0 + points)[:, None] * slope
    half = 0.5 * length
    slope = slope / half
    scaled = half * weights[:, None]
    return (scaled * value).T @ value, (scaled * slope).T @ slope, (scaled * slope).T @ value
