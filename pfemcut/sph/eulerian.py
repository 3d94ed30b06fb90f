"""Kernel sums over present neighbours: velocity gradient, forces of stress, viscosity and artificial pressure.

Each loop gathers into its own particle's row, in the order of the neighbours, so results do not depend on the number
of threads. The gradient of the kernel at particle i is |dW/dr| / r (x_j - x_i): it points to the neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.kernel import SUPPORT, normalisation, shape, shape_slope

Array = NDArray[np.float64]


def velocity_sums(
    neighbours: NeighbourList, positions: Array, velocities: Array, volume: Array, smoothing_length: float
) -> tuple[Array, Array]:
    """Sums of V_j (v_j - v_i) ⊗ gradient and of K_i = V_j (x_j - x_i) ⊗ gradient.

    The first is the velocity gradient (Islam et al. 2019, eq. 9), with K⁻¹ that which is exact for linear fields.

    Parameters
    ----------
    neighbours
        Of the particles at ``positions``.
    positions, velocities
        mm and mm/s; shape (n, d).
    volume
        m / rho of each particle (mm^d); shape (n,).
    smoothing_length
        h (mm).

    Returns
    -------
    Both sums (1/s and dimensionless), shape (n, d, d).
    """
    scale = normalisation(smoothing_length, positions.shape[1]) / smoothing_length
    rates, moments = _velocity_sums(
        neighbours.offsets, neighbours.indices, positions, velocities, volume, smoothing_length, scale
    )
    return rates, moments


@njit(parallel=True, cache=True)
def _velocity_sums(offsets, indices, positions, velocities, volume, smoothing, scale):  # type: ignore[no-untyped-def]
    count, dimension = positions.shape
    rates, moments = np.zeros((count, dimension, dimension)), np.zeros((count, dimension, dimension))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square = 0.0
            for a in range(dimension):
                square += (positions[j, a] - positions[i, a]) ** 2
            if square < reach:
                distance = np.sqrt(square)
                weight = -volume[j] * scale * shape_slope(distance / smoothing) / distance
                for b in range(dimension):
                    gradient = weight * (positions[j, b] - positions[i, b])
                    for a in range(dimension):
                        rates[i, a, b] += (velocities[j, a] - velocities[i, a]) * gradient
                        moments[i, a, b] += (positions[j, a] - positions[i, a]) * gradient
    return rates, moments


@dataclass(frozen=True)
class PairConstants:
    """Constants of forces between pairs.

    Attributes
    ----------
    smoothing_length, spacing
        h and the spacing dp at the start (mm).
    alpha, beta, sound_speed
        Of Monaghan's viscosity; c in mm/s.
    gamma
        Of the artificial pressure.
    """

    smoothing_length: float
    spacing: float
    alpha: float
    beta: float
    sound_speed: float
    gamma: float


def pair_forces(
    neighbours: NeighbourList,
    positions: Array,
    velocities: Array,
    mass: Array,
    density: Array,
    stress: Array,
    pressure: Array,
    constants: PairConstants,
) -> tuple[Array, Array, Array]:
    """Forces of stress, of artificial viscosity and of artificial pressure; shape (n, d) each.

    m_i sum_j m_j (sigma_i / rho_i² + sigma_j / rho_j² - Pi - P_a) gradient (Islam et al. 2019, eqs. 8 and 12 to 16):

    1. Stress, by Gray, Monaghan and Swift 2001; ``stress`` may hold sigma K⁻¹.
    2. Viscosity of Monaghan and Gingold 1983 on pairs that approach: Pi = (-alpha c mu + beta mu²) / rho with
       mu = h v·x / (x² + 0.01 h²).
    3. Artificial pressure, unless both particles are compressed: P_a = gamma (|p_i| / rho_i² + |p_j| / rho_j²)
       (W(r) / W(dp))^n, n = W(0) / W(dp). It keeps particles under tension from clustering (Monaghan 2000).

    Opposite on both particles of a pair, so momentum is conserved to round-off.

    Parameters
    ----------
    neighbours
        Of the particles at ``positions``.
    positions, velocities
        mm and mm/s; shape (n, d).
    mass, density, pressure
        tonne, tonne/mm³ and MPa, positive in compression; shape (n,).
    stress
        Cauchy stress (MPa); shape (n, d, d).
    constants
        See :class:`PairConstants`.
    """
    h, dp = constants.smoothing_length, constants.spacing
    dimension = positions.shape[1]
    at_spacing = shape(dp / h)
    exponent = shape(0.0) / at_spacing if at_spacing > 0.0 else 0.0
    squared = density * density
    internal, viscous, repulsive = _pair_forces(
        neighbours.offsets,
        neighbours.indices,
        positions,
        velocities,
        mass,
        density,
        stress / squared[:, None, None],
        pressure / squared,
        (h, constants.alpha, constants.beta, constants.sound_speed),
        (constants.gamma if at_spacing > 0.0 else 0.0, at_spacing, exponent),
        normalisation(h, dimension) / h,
    )
    return internal, viscous, repulsive


@njit(parallel=True, cache=True)
def _pair_forces(  # type: ignore[no-untyped-def]
    offsets, indices, positions, velocities, mass, density, stress, pressure, viscosity, artificial, scale
):
    smoothing, alpha, beta, sound = viscosity
    gamma, at_spacing, exponent = artificial
    count, dimension = positions.shape
    internal = np.zeros((count, dimension))
    viscous, repulsive = np.zeros((count, dimension)), np.zeros((count, dimension))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square, closing = 0.0, 0.0
            for a in range(dimension):
                x = positions[j, a] - positions[i, a]
                square += x * x
                closing += x * (velocities[j, a] - velocities[i, a])
            if square < reach:
                distance = np.sqrt(square)
                weight = -mass[i] * mass[j] * scale * shape_slope(distance / smoothing) / distance
                for a in range(dimension):
                    for b in range(dimension):
                        gradient = weight * (positions[j, b] - positions[i, b])
                        internal[i, a] += (stress[i, a, b] + stress[j, a, b]) * gradient
                if closing < 0.0:
                    mu = smoothing * closing / (square + 0.01 * smoothing * smoothing)
                    push = (-alpha * sound + beta * mu) * mu / (0.5 * (density[i] + density[j]))
                    for a in range(dimension):
                        viscous[i, a] -= push * weight * (positions[j, a] - positions[i, a])
                if gamma > 0.0 and (pressure[i] < 0.0 or pressure[j] < 0.0):
                    push = gamma * (abs(pressure[i]) + abs(pressure[j]))
                    push *= (shape(distance / smoothing) / at_spacing) ** exponent
                    for a in range(dimension):
                        repulsive[i, a] -= push * weight * (positions[j, a] - positions[i, a])
    return internal, viscous, repulsive


def support(smoothing_length: float) -> float:
    """Radius of the kernel's support (mm)."""
    return SUPPORT * smoothing_length
