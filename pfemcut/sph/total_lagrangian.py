"""Sums over reference neighbours: deformation gradient, internal force, viscosity, zero-energy control.

Each loop gathers into its own particle's row, in the order of the neighbours, so results do not depend on the number
of threads. Two and three dimensions are written out apart: the sums then stay in registers.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.sph.reference import Reference

Array = NDArray[np.float64]


def deformation_gradient(reference: Reference, positions: Array) -> Array:
    """F_i = sum_j V_j (x_j - x_i) ⊗ K_i⁻¹ gradient_ij (Islam et al. 2019, eq. 18, with corrected gradients).

    Without correction the sum over reference positions is not the identity, so it is taken over displacements.

    Parameters
    ----------
    reference
        The reference configuration.
    positions
        Present positions (mm); shape (n, d).

    Returns
    -------
    F, shape (n, d, d).
    """
    rows = reference.neighbours
    sums = _sums_2d if positions.shape[1] == 2 else _sums_3d
    displaced = sums(
        rows.offsets,
        rows.indices,
        reference.gradient_weight,
        reference.points,
        reference.volume,
        positions - reference.points,
    )
    return np.eye(positions.shape[1]) + displaced @ reference.correction


@njit(parallel=True, cache=True)
def _sums_2d(offsets, indices, weight, points, volume, displacement):  # type: ignore[no-untyped-def]
    """sum_j V_j (u_j - u_i) ⊗ gradient_ij in the plane; shape (n, 2, 2)."""
    count = len(points)
    gradient = np.empty((count, 2, 2))
    for i in prange(count):
        xx = xy = yx = yy = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            scale = weight[k] * volume[j]
            gx = scale * (points[j, 0] - points[i, 0])
            gy = scale * (points[j, 1] - points[i, 1])
            ux = displacement[j, 0] - displacement[i, 0]
            uy = displacement[j, 1] - displacement[i, 1]
            xx += ux * gx
            xy += ux * gy
            yx += uy * gx
            yy += uy * gy
        gradient[i, 0, 0], gradient[i, 0, 1] = xx, xy
        gradient[i, 1, 0], gradient[i, 1, 1] = yx, yy
    return gradient


@njit(parallel=True, cache=True)
def _sums_3d(offsets, indices, weight, points, volume, displacement):  # type: ignore[no-untyped-def]
    """sum_j V_j (u_j - u_i) ⊗ gradient_ij in space; shape (n, 3, 3)."""
    count = len(points)
    gradient = np.empty((count, 3, 3))
    for i in prange(count):
        xx = xy = xz = yx = yy = yz = zx = zy = zz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            scale = weight[k] * volume[j]
            gx = scale * (points[j, 0] - points[i, 0])
            gy = scale * (points[j, 1] - points[i, 1])
            gz = scale * (points[j, 2] - points[i, 2])
            ux = displacement[j, 0] - displacement[i, 0]
            uy = displacement[j, 1] - displacement[i, 1]
            uz = displacement[j, 2] - displacement[i, 2]
            xx += ux * gx
            xy += ux * gy
            xz += ux * gz
            yx += uy * gx
            yy += uy * gy
            yz += uy * gz
            zx += uz * gx
            zy += uz * gy
            zz += uz * gz
        gradient[i, 0, 0], gradient[i, 0, 1], gradient[i, 0, 2] = xx, xy, xz
        gradient[i, 1, 0], gradient[i, 1, 1], gradient[i, 1, 2] = yx, yy, yz
        gradient[i, 2, 0], gradient[i, 2, 1], gradient[i, 2, 2] = zx, zy, zz
    return gradient


def internal_force(reference: Reference, first_piola: Array) -> Array:
    """f_i = V_i sum_j V_j (P_i K_i⁻¹ + P_j K_j⁻¹) gradient_ij, which is minus the energy's gradient.

    Opposite on both particles of a pair, so momentum is conserved to round-off.

    Parameters
    ----------
    reference
        The reference configuration.
    first_piola
        First Piola-Kirchhoff stress P (MPa), by reference area; shape (n, d, d).

    Returns
    -------
    Forces (N, or N per mm of width); shape (n, d).
    """
    rows = reference.neighbours
    forces = _forces_2d if first_piola.shape[1] == 2 else _forces_3d
    return np.asarray(
        forces(
            rows.offsets,
            rows.indices,
            reference.gradient_weight,
            reference.points,
            reference.volume,
            first_piola @ reference.correction,
        )
    )


@njit(parallel=True, cache=True)
def _forces_2d(offsets, indices, weight, points, volume, stress):  # type: ignore[no-untyped-def]
    count = len(points)
    force = np.empty((count, 2))
    for i in prange(count):
        fx = fy = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            scale = weight[k] * volume[j]
            gx = scale * (points[j, 0] - points[i, 0])
            gy = scale * (points[j, 1] - points[i, 1])
            fx += (stress[i, 0, 0] + stress[j, 0, 0]) * gx + (stress[i, 0, 1] + stress[j, 0, 1]) * gy
            fy += (stress[i, 1, 0] + stress[j, 1, 0]) * gx + (stress[i, 1, 1] + stress[j, 1, 1]) * gy
        force[i, 0], force[i, 1] = volume[i] * fx, volume[i] * fy
    return force


@njit(parallel=True, cache=True)
def _forces_3d(offsets, indices, weight, points, volume, stress):  # type: ignore[no-untyped-def]
    count = len(points)
    force = np.empty((count, 3))
    for i in prange(count):
        fx = fy = fz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            scale = weight[k] * volume[j]
            gx = scale * (points[j, 0] - points[i, 0])
            gy = scale * (points[j, 1] - points[i, 1])
            gz = scale * (points[j, 2] - points[i, 2])
            fx += (
                (stress[i, 0, 0] + stress[j, 0, 0]) * gx
                + (stress[i, 0, 1] + stress[j, 0, 1]) * gy
                + (stress[i, 0, 2] + stress[j, 0, 2]) * gz
            )
            fy += (
                (stress[i, 1, 0] + stress[j, 1, 0]) * gx
                + (stress[i, 1, 1] + stress[j, 1, 1]) * gy
                + (stress[i, 1, 2] + stress[j, 1, 2]) * gz
            )
            fz += (
                (stress[i, 2, 0] + stress[j, 2, 0]) * gx
                + (stress[i, 2, 1] + stress[j, 2, 1]) * gy
                + (stress[i, 2, 2] + stress[j, 2, 2]) * gz
            )
        force[i, 0], force[i, 1], force[i, 2] = volume[i] * fx, volume[i] * fy, volume[i] * fz
    return force


def damping_force(
    reference: Reference,
    positions: Array,
    velocities: Array,
    gradient: Array,
    mass: Array,
    density: Array,
    constants: tuple[float, float, float, float, float],
) -> tuple[Array, Array]:
    """Forces of Monaghan's artificial viscosity and of the control of zero-energy modes.

    Both act along the line that joins two particles now, so they conserve momentum and angular momentum. Viscosity
    (Monaghan and Gingold 1983) acts on pairs that approach: Pi = (-alpha c mu + beta mu²) / rho, mu = h v·x / (x² +
    0.01 h²). The zero-energy control (Ganzenmüller 2015, Comput. Methods Appl. Mech. Eng. 286, 87) resists what of a
    pair's length its particles' deformation gradients don't see.

    Parameters
    ----------
    reference
        The reference configuration.
    positions, velocities
        mm and mm/s; shape (n, d).
    gradient
        Deformation gradient; shape (n, d, d).
    mass, density
        Of each particle (tonne, tonne/mm³); shape (n,).
    constants
        Smoothing length h (mm), alpha, beta, speed of sound c (mm/s), and the modulus of the control (MPa).

    Returns
    -------
    Forces of the viscosity and of the control; shape (n, d) each.
    """
    rows = reference.neighbours
    damping = _damping_2d if positions.shape[1] == 2 else _damping_3d
    viscous, control = damping(
        rows.offsets,
        rows.indices,
        reference.gradient_weight,
        reference.kernel,
        reference.points,
        reference.volume,
        positions,
        velocities,
        gradient,
        mass,
        density,
        constants,
    )
    return viscous, control


@njit(parallel=True, cache=True)
def _damping_2d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    weight,
    kernel,
    points,
    volume,
    positions,
    velocities,
    gradient,
    mass,
    density,
    constants,
):
    modulus = constants[4]
    count = len(positions)
    viscous, control = np.empty((count, 2)), np.empty((count, 2))
    for i in prange(count):
        vx = vy = cx = cy = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            far_x, far_y = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            square, reference_square = x * x + y * y, far_x * far_x + far_y * far_y
            closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (velocities[j, 1] - velocities[i, 1])
            length = np.sqrt(square)
            if closing < 0.0:
                push = _viscosity(constants, closing, square, density[i], density[j])
                push *= mass[i] * mass[j] * weight[k] * np.sqrt(reference_square) / length
                vx -= push * x
                vy -= push * y
            if modulus > 0.0:
                image_x = (gradient[i, 0, 0] + gradient[j, 0, 0]) * far_x
                image_x += (gradient[i, 0, 1] + gradient[j, 0, 1]) * far_y
                image_y = (gradient[i, 1, 0] + gradient[j, 1, 0]) * far_x
                image_y += (gradient[i, 1, 1] + gradient[j, 1, 1]) * far_y
                # The length now, minus (F_i + F_j)/2 (X_j - X_i) along the line now.
                hidden = length - 0.5 * (image_x * x + image_y * y) / length
                pull = modulus * volume[i] * volume[j] * kernel[k] * hidden / (reference_square * length)
                cx += pull * x
                cy += pull * y
        viscous[i, 0], viscous[i, 1] = vx, vy
        control[i, 0], control[i, 1] = cx, cy
    return viscous, control


@njit(parallel=True, cache=True)
def _damping_3d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    weight,
    kernel,
    points,
    volume,
    positions,
    velocities,
    gradient,
    mass,
    density,
    constants,
):
    modulus = constants[4]
    count = len(positions)
    viscous, control = np.empty((count, 3)), np.empty((count, 3))
    for i in prange(count):
        vx = vy = vz = cx = cy = cz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            z = positions[j, 2] - positions[i, 2]
            far_x, far_y = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            far_z = points[j, 2] - points[i, 2]
            square = x * x + y * y + z * z
            reference_square = far_x * far_x + far_y * far_y + far_z * far_z
            closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (velocities[j, 1] - velocities[i, 1])
            closing += z * (velocities[j, 2] - velocities[i, 2])
            length = np.sqrt(square)
            if closing < 0.0:
                push = _viscosity(constants, closing, square, density[i], density[j])
                push *= mass[i] * mass[j] * weight[k] * np.sqrt(reference_square) / length
                vx -= push * x
                vy -= push * y
                vz -= push * z
            if modulus > 0.0:
                image_x = (gradient[i, 0, 0] + gradient[j, 0, 0]) * far_x
                image_x += (gradient[i, 0, 1] + gradient[j, 0, 1]) * far_y
                image_x += (gradient[i, 0, 2] + gradient[j, 0, 2]) * far_z
                image_y = (gradient[i, 1, 0] + gradient[j, 1, 0]) * far_x
                image_y += (gradient[i, 1, 1] + gradient[j, 1, 1]) * far_y
                image_y += (gradient[i, 1, 2] + gradient[j, 1, 2]) * far_z
                image_z = (gradient[i, 2, 0] + gradient[j, 2, 0]) * far_x
                image_z += (gradient[i, 2, 1] + gradient[j, 2, 1]) * far_y
                image_z += (gradient[i, 2, 2] + gradient[j, 2, 2]) * far_z
                # The length now, minus (F_i + F_j)/2 (X_j - X_i) along the line now.
                hidden = length - 0.5 * (image_x * x + image_y * y + image_z * z) / length
                pull = modulus * volume[i] * volume[j] * kernel[k] * hidden / (reference_square * length)
                cx += pull * x
                cy += pull * y
                cz += pull * z
        viscous[i, 0], viscous[i, 1], viscous[i, 2] = vx, vy, vz
        control[i, 0], control[i, 1], control[i, 2] = cx, cy, cz
    return viscous, control


@njit(inline="always")
def _viscosity(constants, closing, square, density, other):  # type: ignore[no-untyped-def]
    """Pi of a pair that approaches, from x·v, x² and both densities."""
    smoothing, alpha, beta, sound, _ = constants
    mu = smoothing * closing / (square + 0.01 * smoothing * smoothing)
    return (-alpha * sound + beta * mu) * mu / (0.5 * (density + other))
