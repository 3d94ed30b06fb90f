"""Sums over reference neighbours: deformation gradient and internal force.

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
