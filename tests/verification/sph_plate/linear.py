"""Small vibrations of total-Lagrangian SPH: the linear operator of its forces, and its lowest frequency.

F = 1 + D u with D the gradients of pfemcut's reference configuration; stress C : sym D u, forces - Dᵀ V C D u; springs
of the control as in pfemcut.sph.damping, elastic. No time steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import eigs

from pfemcut.particles.lattice import box_lattice
from pfemcut.sph.reference import reference_of

CLAMP = 6
"""Columns of held particles."""


def frequency(
    length: float,
    thickness: float,
    young: float,
    poisson: float,
    density: float,
    *,
    across: int,
    smoothing: float = 1.5,
    corrected: bool = True,
    control: float = 0.1,
    clamped: bool = True,
    near: float,
) -> float:
    """Angular frequency ``near`` a given one, of a plate held at x < 0 or free, with ``across`` particles across.

    ``smoothing`` is h over the spacing, ``control`` the springs' modulus over Young's.
    """
    spacing = thickness / across
    low, high = np.array([-CLAMP * spacing if clamped else 0.0, 0.0]), np.array([length, thickness])
    points, volume = box_lattice(low, high, spacing)
    count = len(points)
    body = np.zeros(count, dtype=np.int64)
    reference = reference_of(points, np.full(count, volume), body, smoothing * spacing, corrected)
    one, other = reference.neighbours.owners, reference.neighbours.indices
    apart = points[other] - points[one]
    towards = (volume * reference.gradient_weight)[:, None] * apart
    towards = np.einsum("kb,kba->ka", towards, reference.correction[one])

    def derivative(axis: int) -> Any:
        diagonal = np.bincount(one, towards[:, axis], count)
        return sparse.csr_matrix((towards[:, axis], (one, other)), (count, count)) - sparse.diags(diagonal)

    by_x, by_y = derivative(0), derivative(1)
    strain = sparse.bmat([[by_x, None], [None, by_y], [by_y, by_x]]).tocsr()
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * young / (1.0 + poisson)
    axial, unit = lame + 2.0 * shear, sparse.identity(count)
    moduli = sparse.bmat(
        [[axial * unit, lame * unit, None], [lame * unit, axial * unit, None], [None, None, shear * unit]]
    )
    stiffness = volume * (strain.T @ moduli @ strain)

    first = one < other
    pairs = int(first.sum())
    direction = apart[first] / reference.distance[first][:, None]

    def at(particles: Any) -> Any:
        return sparse.csr_matrix((np.ones(pairs), (np.arange(pairs), particles)), (pairs, count))

    mean, difference = 0.5 * (at(one[first]) + at(other[first])), at(other[first]) - at(one[first])
    along = [sparse.diags(direction[:, axis]) @ difference for axis in range(2)]
    seen = [
        sum(
            sparse.diags(direction[:, axis] * apart[first][:, b]) @ mean @ each
            for b, each in enumerate((by_x, by_y))
        )
        for axis in range(2)
    ]
    hidden = sparse.hstack([along[axis] - seen[axis] for axis in range(2)])
    springs = sparse.diags(control * young * volume**2 * reference.spring_weight[first])
    stiffness = stiffness + sparse.hstack(along).T @ springs @ hidden

    free = np.flatnonzero(np.tile(points[:, 0] > 0.0, 2))
    operator = (stiffness.tocsr()[free][:, free] / (density * volume)).tocsc()
    square = eigs(operator, k=1, sigma=(0.7 * near) ** 2, return_eigenvectors=False)
    return float(np.sqrt(square[0].real))
