"""Kernel sums over present neighbours: velocity gradient, forces of stress, viscosity and artificial pressure.

Each loop gathers into its own particle's row, in the order of the neighbours, so results do not depend on the number
of threads. Two and three dimensions are written out apart: the sums then stay in registers. The gradient of the kernel
at particle i is |dW/dr| / r (x_j - x_i): it points to the neighbour.
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
    sums = _velocity_sums_2d if positions.shape[1] == 2 else _velocity_sums_3d
    rates, moments = sums(
        neighbours.offsets, neighbours.indices, positions, velocities, volume, smoothing_length, scale
    )
    return rates, moments


@njit(parallel=True, cache=True)
def _velocity_sums_2d(offsets, indices, positions, velocities, volume, smoothing, scale):  # type: ignore[no-untyped-def]
    count = len(positions)
    rates, moments = np.empty((count, 2, 2)), np.empty((count, 2, 2))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        lxx = lxy = lyx = lyy = 0.0
        kxx = kxy = kyy = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            square = x * x + y * y
            if square < reach:
                distance = np.sqrt(square)
                weight = -volume[j] * scale * shape_slope(distance / smoothing) / distance
                gx, gy = weight * x, weight * y
                vx, vy = velocities[j, 0] - velocities[i, 0], velocities[j, 1] - velocities[i, 1]
                lxx += vx * gx
                lxy += vx * gy
                lyx += vy * gx
                lyy += vy * gy
                kxx += x * gx
                kxy += x * gy
                kyy += y * gy
        rates[i, 0, 0], rates[i, 0, 1], rates[i, 1, 0], rates[i, 1, 1] = lxx, lxy, lyx, lyy
        moments[i, 0, 0], moments[i, 0, 1], moments[i, 1, 0], moments[i, 1, 1] = kxx, kxy, kxy, kyy
    return rates, moments


@njit(parallel=True, cache=True)
def _velocity_sums_3d(offsets, indices, positions, velocities, volume, smoothing, scale):  # type: ignore[no-untyped-def]
    count = len(positions)
    rates, moments = np.empty((count, 3, 3)), np.empty((count, 3, 3))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        lxx = lxy = lxz = lyx = lyy = lyz = lzx = lzy = lzz = 0.0
        kxx = kxy = kxz = kyy = kyz = kzz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            z = positions[j, 2] - positions[i, 2]
            square = x * x + y * y + z * z
            if square < reach:
                distance = np.sqrt(square)
                weight = -volume[j] * scale * shape_slope(distance / smoothing) / distance
                gx, gy, gz = weight * x, weight * y, weight * z
                vx, vy = velocities[j, 0] - velocities[i, 0], velocities[j, 1] - velocities[i, 1]
                vz = velocities[j, 2] - velocities[i, 2]
                lxx += vx * gx
                lxy += vx * gy
                lxz += vx * gz
                lyx += vy * gx
                lyy += vy * gy
                lyz += vy * gz
                lzx += vz * gx
                lzy += vz * gy
                lzz += vz * gz
                kxx += x * gx
                kxy += x * gy
                kxz += x * gz
                kyy += y * gy
                kyz += y * gz
                kzz += z * gz
        rates[i, 0, 0], rates[i, 0, 1], rates[i, 0, 2] = lxx, lxy, lxz
        rates[i, 1, 0], rates[i, 1, 1], rates[i, 1, 2] = lyx, lyy, lyz
        rates[i, 2, 0], rates[i, 2, 1], rates[i, 2, 2] = lzx, lzy, lzz
        moments[i, 0, 0], moments[i, 0, 1], moments[i, 0, 2] = kxx, kxy, kxz
        moments[i, 1, 0], moments[i, 1, 1], moments[i, 1, 2] = kxy, kyy, kyz
        moments[i, 2, 0], moments[i, 2, 1], moments[i, 2, 2] = kxz, kyz, kzz
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

    sum_j [V_i V_j (sigma_i + sigma_j) - m_i m_j (Pi + P_a)] gradient (Islam et al. 2019, eqs. 8 and 12 to 16):

    1. Stress; ``stress`` may hold sigma K⁻¹. The paper has m_i m_j (sigma_i / rho_i² + sigma_j / rho_j²), which does
       other work than the stress at the particles with the velocity gradient of its eq. 9: with V_i V_j these are
       conjugate (Bonet and Lok 1999). Where densities are equal there is no difference.
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
    forces = _pair_forces_2d if dimension == 2 else _pair_forces_3d
    internal, viscous, repulsive = forces(
        neighbours.offsets,
        neighbours.indices,
        positions,
        velocities,
        mass,
        mass / density,
        density,
        stress,
        pressure / squared,
        (h, constants.alpha, constants.beta, constants.sound_speed),
        (constants.gamma if at_spacing > 0.0 else 0.0, at_spacing, exponent),
        normalisation(h, dimension) / h,
    )
    return internal, viscous, repulsive


@njit(parallel=True, cache=True)
def _pair_forces_2d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    positions,
    velocities,
    mass,
    volume,
    density,
    stress,
    pressure,
    viscosity,
    artificial,
    scale,
):
    smoothing = viscosity[0]
    count = len(positions)
    internal, viscous, repulsive = np.empty((count, 2)), np.empty((count, 2)), np.empty((count, 2))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        fx = fy = vx = vy = rx = ry = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            square = x * x + y * y
            if square < reach:
                distance = np.sqrt(square)
                weight = -scale * shape_slope(distance / smoothing) / distance
                gx, gy = weight * x, weight * y
                fx += volume[j] * (
                    (stress[i, 0, 0] + stress[j, 0, 0]) * gx + (stress[i, 0, 1] + stress[j, 0, 1]) * gy
                )
                fy += volume[j] * (
                    (stress[i, 1, 0] + stress[j, 1, 0]) * gx + (stress[i, 1, 1] + stress[j, 1, 1]) * gy
                )
                closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (
                    velocities[j, 1] - velocities[i, 1]
                )
                if closing < 0.0:
                    push = mass[j] * _viscosity(viscosity, closing, square, density[i], density[j])
                    vx -= push * gx
                    vy -= push * gy
                if artificial[0] > 0.0 and (pressure[i] < 0.0 or pressure[j] < 0.0):
                    push = mass[j] * _artificial(artificial, distance / smoothing, pressure[i], pressure[j])
                    rx -= push * gx
                    ry -= push * gy
        internal[i, 0], internal[i, 1] = volume[i] * fx, volume[i] * fy
        viscous[i, 0], viscous[i, 1] = mass[i] * vx, mass[i] * vy
        repulsive[i, 0], repulsive[i, 1] = mass[i] * rx, mass[i] * ry
    return internal, viscous, repulsive


@njit(parallel=True, cache=True)
def _pair_forces_3d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    positions,
    velocities,
    mass,
    volume,
    density,
    stress,
    pressure,
    viscosity,
    artificial,
    scale,
):
    smoothing = viscosity[0]
    count = len(positions)
    internal, viscous, repulsive = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        fx = fy = fz = vx = vy = vz = rx = ry = rz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            z = positions[j, 2] - positions[i, 2]
            square = x * x + y * y + z * z
            if square < reach:
                distance = np.sqrt(square)
                weight = -scale * shape_slope(distance / smoothing) / distance
                gx, gy, gz = weight * x, weight * y, weight * z
                fx += volume[j] * (
                    (stress[i, 0, 0] + stress[j, 0, 0]) * gx
                    + (stress[i, 0, 1] + stress[j, 0, 1]) * gy
                    + (stress[i, 0, 2] + stress[j, 0, 2]) * gz
                )
                fy += volume[j] * (
                    (stress[i, 1, 0] + stress[j, 1, 0]) * gx
                    + (stress[i, 1, 1] + stress[j, 1, 1]) * gy
                    + (stress[i, 1, 2] + stress[j, 1, 2]) * gz
                )
                fz += volume[j] * (
                    (stress[i, 2, 0] + stress[j, 2, 0]) * gx
                    + (stress[i, 2, 1] + stress[j, 2, 1]) * gy
                    + (stress[i, 2, 2] + stress[j, 2, 2]) * gz
                )
                closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (
                    velocities[j, 1] - velocities[i, 1]
                )
                closing += z * (velocities[j, 2] - velocities[i, 2])
                if closing < 0.0:
                    push = mass[j] * _viscosity(viscosity, closing, square, density[i], density[j])
                    vx -= push * gx
                    vy -= push * gy
                    vz -= push * gz
                if artificial[0] > 0.0 and (pressure[i] < 0.0 or pressure[j] < 0.0):
                    push = mass[j] * _artificial(artificial, distance / smoothing, pressure[i], pressure[j])
                    rx -= push * gx
                    ry -= push * gy
                    rz -= push * gz
        own = volume[i]
        internal[i, 0], internal[i, 1], internal[i, 2] = own * fx, own * fy, own * fz
        own = mass[i]
        viscous[i, 0], viscous[i, 1], viscous[i, 2] = own * vx, own * vy, own * vz
        repulsive[i, 0], repulsive[i, 1], repulsive[i, 2] = own * rx, own * ry, own * rz
    return internal, viscous, repulsive


@njit(inline="always")
def _viscosity(constants, closing, square, density, other):  # type: ignore[no-untyped-def]
    """Pi of a pair that approaches, from x·v, x² and both densities."""
    smoothing, alpha, beta, sound = constants
    mu = smoothing * closing / (square + 0.01 * smoothing * smoothing)
    return (-alpha * sound + beta * mu) * mu / (0.5 * (density + other))


@njit(inline="always")
def _artificial(constants, q, pressure, other):  # type: ignore[no-untyped-def]
    """P_a of a pair at a distance of q h, from both p / rho²."""
    gamma, at_spacing, exponent = constants
    return gamma * (abs(pressure) + abs(other)) * (shape(q) / at_spacing) ** exponent


def support(smoothing_length: float) -> float:
    """Radius of the kernel's support (mm)."""
    return SUPPORT * smoothing_length
