"""Pinball contact (Belytschko and Yeh 1993; Islam et al. 2019, section 2.4).

Bodies touch each other by it, and a body touches itself where it folds (:mod:`pfemcut.sph.connectivity`). Each particle
carries a ball of half the spacing. Where two that may touch overlap by a penetration p,

1. while they approach, the smaller of f1 and f2, else f2 pushes them apart along the line of their middles;
2. f1 = k1 m_i m_j / (m_i + m_j) p' / dt, which takes the approach in a step or two. The paper has rho R³
   for the masses, which in the plane would not be those of the particles;
3. f2 = k2 G_i G_j / (G_i + G_j) sqrt(R_i R_j / (R_i + R_j)) p^(3/2), Hertz's law. In the plane, per mm of width, it is
   divided by the spacing, as if the balls were that far apart across.

With k1 = 0 there is f2 alone, which has a potential. With f1 a body that is pushed on all the time sinks into the
other: f1 is in balance with a pressure q only at a closing speed of 2 q dp² dt / (k1 m), or its like in space.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.particles.problem import ParticleProblem
from pfemcut.sph.touching import Pairs

Array = NDArray[np.float64]


def pinball_contact(
    problem: ParticleProblem, touching: Pairs, positions: Array, velocities: Array, dt: float
) -> Array:
    """:func:`pinball_forces` between the particles of a problem; shape (n, d)."""
    return pinball_forces(
        touching,
        positions,
        velocities,
        problem.mass,
        problem.shear_modulus,
        problem.smoothing.spacing,
        problem.smoothing.pinball,
        dt,
    )


def pinball_forces(
    touching: Pairs,
    positions: Array,
    velocities: Array,
    mass: Array,
    shear_modulus: Array,
    spacing: float,
    factors: tuple[float, float],
    dt: float,
) -> Array:
    """Forces on the particles, equal and opposite on those of a pair; shape (n, d).

    Parameters
    ----------
    touching
        All pairs nearer than ``spacing`` that may touch.
    positions, velocities
        mm and mm/s; shape (n, d).
    mass, shear_modulus
        tonne and MPa; shape (n,).
    spacing
        Twice the radius of the balls (mm).
    factors
        k1, zero for Hertz's law alone, and k2.
    dt
        Time step (s).
    """
    width = spacing if positions.shape[1] == 2 else 1.0
    return np.asarray(
        _pinballs(
            touching.offsets,
            touching.indices,
            positions,
            velocities,
            mass,
            shear_modulus,
            (spacing, factors[0] / dt, factors[1] * np.sqrt(0.25 * spacing) / width),
        )
    )


@njit(parallel=True, cache=True)
def _pinballs(offsets, indices, positions, velocities, mass, shear, constants):  # type: ignore[no-untyped-def]
    reach, stopping, hertz = constants
    count, dimension = positions.shape
    force = np.zeros((count, dimension))
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square, closing = 0.0, 0.0
            for a in range(dimension):
                x = positions[j, a] - positions[i, a]
                square += x * x
                closing -= x * (velocities[j, a] - velocities[i, a])
            distance = np.sqrt(square)
            if distance < reach and distance > 0.0:
                elastic = hertz * shear[i] * shear[j] / (shear[i] + shear[j]) * (reach - distance) ** 1.5
                push = elastic
                if stopping > 0.0 and closing > 0.0:
                    reduced = mass[i] * mass[j] / (mass[i] + mass[j])
                    push = min(elastic, stopping * reduced * closing / distance)
                for a in range(dimension):
                    force[i, a] -= push * (positions[j, a] - positions[i, a]) / distance
    return force
