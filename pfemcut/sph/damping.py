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
        Hidden strain of each entry at which its spring is relaxed; shape (k,).
    limit
        Strain that a spring of a particle can bear, infinite where the material is elastic; shape (n,).
    """

    slip: Array
    limit: Array


def hidden_strain(reference: Reference, positions: Array, gradient: Array) -> Array:
    """What of a pair's length the particles' deformation gradients don't see, over the reference length; (k,).

    The length now, less (F_i + F_j)/2 (X_j - X_i) along the line now.
    """
    one, other = reference.neighbours.owners, reference.neighbours.indices
    apart = reference.points[other] - reference.points[one]
    now = positions[other] - positions[one]
    length = np.sqrt(np.einsum("ka,ka->k", now, now))
    image = np.einsum("kab,kb->ka", 0.5 * (gradient[one] + gradient[other]), apart)
    seen = np.einsum("ka,ka->k", image, now) / length
    return np.asarray((length - seen) / np.sqrt(np.einsum("ka,ka->k", apart, apart)))


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
    viscous, control, slip = _damping(
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
        springs.slip,
        springs.limit,
        constants,
    )
    return viscous, control, slip


@njit(parallel=True, cache=True)
def _damping(  # type: ignore[no-untyped-def]
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
    slip,
    limit,
    constants,
):
    smoothing, alpha, beta, sound, modulus = constants
    count, dimension = positions.shape
    viscous, control = np.zeros((count, dimension)), np.zeros((count, dimension))
    new_slip = np.zeros_like(slip)
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square, reference_square, closing = 0.0, 0.0, 0.0
            for a in range(dimension):
                x = positions[j, a] - positions[i, a]
                far = points[j, a] - points[i, a]
                square += x * x
                reference_square += far * far
                closing += x * (velocities[j, a] - velocities[i, a])
            push, pull = 0.0, 0.0
            if closing < 0.0:
                mu = smoothing * closing / (square + 0.01 * smoothing * smoothing)
                viscosity = (-alpha * sound + beta * mu) * mu / (0.5 * (density[i] + density[j]))
                push = mass[i] * mass[j] * viscosity * weight[k] * np.sqrt(reference_square)
            length = np.sqrt(square)
            if modulus > 0.0:
                # (F_i + F_j)/2 (X_j - X_i) along the line now, minus the length now.
                seen = 0.0
                for a in range(dimension):
                    image = 0.0
                    for b in range(dimension):
                        image += 0.5 * (gradient[i, a, b] + gradient[j, a, b]) * (points[j, b] - points[i, b])
                    seen += image * (positions[j, a] - positions[i, a])
                reference_length = np.sqrt(reference_square)
                hidden = (length - seen / length) / reference_length
                most = min(limit[i], limit[j])
                strain = min(max(hidden - slip[k], -most), most)
                new_slip[k] = hidden - strain
                pull = modulus * volume[i] * volume[j] * kernel[k] * strain / reference_length
            for a in range(dimension):
                viscous[i, a] -= push * (positions[j, a] - positions[i, a]) / length
                control[i, a] += pull * (positions[j, a] - positions[i, a]) / length
    return viscous, control, new_slip
