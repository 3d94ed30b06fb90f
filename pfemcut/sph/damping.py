"""Artificial viscosity and the control of zero-energy modes of total-Lagrangian SPH.

The control's springs yield as the material does. In plastic flow the hidden part of a pair's length grows for ever, and
elastic springs would harden the body without end, until a reference update forgets them: in a cut the force on the tool
then rose by a tenth from update to update and fell back each time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.particles.neighbours import Neighbours
from pfemcut.sph.reference import Reference

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Springs:
    """The springs between the particles of a pair that control zero-energy modes.

    Attributes
    ----------
    slip
        Hidden length of each entry at which its spring is relaxed (mm); shape (k,).
    limit
        Strain, over its length, that a spring of a particle can bear, infinite where the material is elastic;
        shape (n,).
    """

    slip: Array
    limit: Array


def hidden_length(reference: Reference, positions: Array, gradient: Array) -> Array:
    """What of a pair's length the particles' deformation gradients don't see (mm; (k,)).

    The length now, less (F_i + F_j)/2 (X_j - X_i) along the line now.
    """
    one, other = reference.neighbours.owners, reference.neighbours.indices
    apart = reference.points[other] - reference.points[one]
    now = positions[other] - positions[one]
    length = np.sqrt(np.einsum("ka,ka->k", now, now))
    image = np.einsum("kab,kb->ka", 0.5 * (gradient[one] + gradient[other]), apart)
    return np.asarray(length - np.einsum("ka,ka->k", image, now) / length)


def carried(strain: Array, old: Neighbours, new: Neighbours) -> Array:
    """``strain`` (k,) of the entries of the ``old`` rows on those of the ``new`` ones; zero for new pairs."""
    count = len(new.offsets) - 1
    old_keys, new_keys = old.owners * count + old.indices, new.owners * count + new.indices
    # Rows are in order of the particles and of their neighbours, so the keys are sorted.
    place = np.minimum(np.searchsorted(old_keys, new_keys), max(len(old_keys) - 1, 0))
    found = np.zeros(len(new_keys))
    if len(old_keys):
        same = old_keys[place] == new_keys
        found[same] = strain[place[same]]
    return found


def damping_force(
    reference: Reference,
    positions: Array,
    velocities: Array,
    gradient: Array,
    mass: Array,
    density: Array,
    springs: Springs,
    constants: tuple[float, float, float, float, float],
) -> tuple[Array, Array, Array]:
    """Forces of Monaghan's artificial viscosity and of the control of zero-energy modes.

    Both act along the line that joins two particles now, so they conserve momentum and angular momentum. Viscosity
    (Monaghan and Gingold 1983) acts on pairs that approach: Pi = (-alpha c mu + beta mu²) / rho, mu = h v·x / (x² +
    0.01 h²). The zero-energy control (Ganzenmüller 2015, Comput. Methods Appl. Mech. Eng. 286, 87) is a spring for
    what of a pair's length its particles' deformation gradients don't see.

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
    springs
        Of the control.
    constants
        Smoothing length h (mm), alpha, beta, speed of sound c (mm/s), and the modulus of the control (MPa).

    Returns
    -------
    Forces of the viscosity and of the control, shape (n, d) each; the springs' new slip, shape (k,).
    """
    rows = reference.neighbours
    kernel = _damping_2d if positions.shape[1] == 2 else _damping_3d
    viscous, control, slip = kernel(
        rows.offsets,
        rows.indices,
        reference.gradient_weight,
        reference.distance,
        reference.spring_length,
        reference.spring_weight,
        reference.points,
        reference.volume,
        positions,
        velocities,
        gradient,
        mass,
        density,
        springs.slip,
        springs.limit,
        constants,
    )
    return viscous, control, slip


@njit(parallel=True, cache=True)
def _damping_2d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    weight,
    distance,
    spring_length,
    spring_weight,
    points,
    volume,
    positions,
    velocities,
    gradient,
    mass,
    density,
    slip,
    limit,
    constants,
):
    modulus = constants[4]
    count = len(positions)
    viscous, control = np.empty((count, 2)), np.empty((count, 2))
    new_slip = np.zeros_like(slip)
    for i in prange(count):
        vx = vy = cx = cy = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            square = x * x + y * y
            length = np.sqrt(square)
            inverse = 1.0 / length
            closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (velocities[j, 1] - velocities[i, 1])
            push = _viscosity(constants, closing, square, density[i], density[j])
            push *= mass[j] * weight[k] * distance[k] * inverse
            vx -= push * x
            vy -= push * y
            if modulus > 0.0:
                far_x, far_y = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
                image_x = (gradient[i, 0, 0] + gradient[j, 0, 0]) * far_x
                image_x += (gradient[i, 0, 1] + gradient[j, 0, 1]) * far_y
                image_y = (gradient[i, 1, 0] + gradient[j, 1, 0]) * far_x
                image_y += (gradient[i, 1, 1] + gradient[j, 1, 1]) * far_y
                # The length now, minus (F_i + F_j)/2 (X_j - X_i) along the line now.
                hidden = length - 0.5 * (image_x * x + image_y * y) * inverse
                borne = _borne(hidden - slip[k], min(limit[i], limit[j]) * spring_length[k])
                new_slip[k] = hidden - borne
                pull = volume[j] * spring_weight[k] * borne * inverse
                cx += pull * x
                cy += pull * y
        stiffness = modulus * volume[i]
        viscous[i, 0], viscous[i, 1] = mass[i] * vx, mass[i] * vy
        control[i, 0], control[i, 1] = stiffness * cx, stiffness * cy
    return viscous, control, new_slip


@njit(parallel=True, cache=True)
def _damping_3d(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    weight,
    distance,
    spring_length,
    spring_weight,
    points,
    volume,
    positions,
    velocities,
    gradient,
    mass,
    density,
    slip,
    limit,
    constants,
):
    modulus = constants[4]
    count = len(positions)
    viscous, control = np.empty((count, 3)), np.empty((count, 3))
    new_slip = np.zeros_like(slip)
    for i in prange(count):
        vx = vy = vz = cx = cy = cz = 0.0
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            x, y = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            z = positions[j, 2] - positions[i, 2]
            square = x * x + y * y + z * z
            length = np.sqrt(square)
            inverse = 1.0 / length
            closing = x * (velocities[j, 0] - velocities[i, 0]) + y * (velocities[j, 1] - velocities[i, 1])
            closing += z * (velocities[j, 2] - velocities[i, 2])
            push = _viscosity(constants, closing, square, density[i], density[j])
            push *= mass[j] * weight[k] * distance[k] * inverse
            vx -= push * x
            vy -= push * y
            vz -= push * z
            if modulus > 0.0:
                far_x, far_y = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
                far_z = points[j, 2] - points[i, 2]
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
                hidden = length - 0.5 * (image_x * x + image_y * y + image_z * z) * inverse
                borne = _borne(hidden - slip[k], min(limit[i], limit[j]) * spring_length[k])
                new_slip[k] = hidden - borne
                pull = volume[j] * spring_weight[k] * borne * inverse
                cx += pull * x
                cy += pull * y
                cz += pull * z
        stiffness = modulus * volume[i]
        viscous[i, 0], viscous[i, 1], viscous[i, 2] = mass[i] * vx, mass[i] * vy, mass[i] * vz
        control[i, 0], control[i, 1], control[i, 2] = stiffness * cx, stiffness * cy, stiffness * cz
    return viscous, control, new_slip


@njit(inline="always")
def _viscosity(constants, closing, square, density, other):  # type: ignore[no-untyped-def]
    """Pi of a pair from x·v, x² and both densities: zero unless it approaches, without a branch to guess wrong."""
    smoothing, alpha, beta, sound, _ = constants
    mu = smoothing * min(closing, 0.0) / (square + 0.01 * smoothing * smoothing)
    return (-alpha * sound + beta * mu) * mu / (0.5 * (density + other))


@njit(inline="always")
def _borne(length, most):  # type: ignore[no-untyped-def]
    """What a spring that yields at ``most`` bears of ``length``."""
    return min(max(length, -most), most)
