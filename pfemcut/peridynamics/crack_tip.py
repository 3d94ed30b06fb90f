"""What a lattice releases when a crack along the fibre grows by one spacing, from its statics."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.linalg import splu

from pfemcut.particles.neighbours import neighbours_within
from pfemcut.peridynamics.bonds import Bonds, bonds_of
from pfemcut.peridynamics.micromodulus import BondStiffness
from pfemcut.peridynamics.plate import LineCrack, Plate, lattice_sites

Array = NDArray[np.float64]

_SIZE, _CRACK = 60.0, 20.2
"""Side of the square of lattice and length of the crack in it, in spacings."""


def tip_release(stiffness: BondStiffness) -> tuple[float, float]:
    """Energy that breaking the pair of bonds at a crack's tip releases, over the energy in the pair.

    In opening and in shear. A square with a crack along the fibre in its middle has edges that move as a homogeneous
    strain across the fibre, or in shear, would move them. With the elongations e of the pair, its stiffness k and the
    compliance c that it sees, the energy falls by 1/2 k e·(1 - k c)⁻¹ e when both bonds are cut. It is more than
    1/2 k e·e, since what they held gives way. The numbers depend on the ratio of the stiffnesses only; the size of the
    square changes them by less than 1 %.

    Parameters
    ----------
    stiffness
        Of the bonds; only their ratio matters.
    """
    across, shear = np.array([[0.0, 0.0], [0.0, 1.0]]), np.array([[0.0, 1.0], [0.0, 0.0]])
    plate = Plate(_SIZE, _SIZE, 1.0, 0.0, 0.0, (), (LineCrack(_CRACK, 0.0, (0.0, 0.0)),))
    sites = lattice_sites(plate, 1.0)
    bonds = bonds_of(plate, sites, neighbours_within(sites, 1.1, np.zeros(len(sites), dtype=np.int64)))
    k = np.where(bonds.fibre, stiffness.fibre, stiffness.matrix) * ~bonds.cut
    elongation = elongation_matrix(bonds)
    counted = elongation[bonds.once]
    matrix = (counted.T @ counted.multiply(k[bonds.once][:, None])).tocsc()
    free = np.repeat((np.abs(sites) < 0.5 * _SIZE - 1.0).all(axis=1), 2)
    solver = splu(matrix[free][:, free])
    tip = _tip_pair(bonds, sites)
    pair = elongation[tip].toarray()[:, free]
    compliance = pair @ solver.solve(pair.T)
    held_back = np.linalg.inv(np.eye(2) - stiffness.matrix * compliance)
    found = []
    for strain in (across, shear):
        u = (sites @ strain.T).ravel()
        moved = u * ~free
        u = moved.copy()
        u[free] = solver.solve(-(matrix @ moved)[free])
        e = elongation[tip] @ u
        found.append(float(e @ held_back @ e / (e @ e)))
    return found[0], found[1]


def elongation_matrix(bonds: Bonds) -> csr_matrix:
    """Matrix from displacements, (2 n,), to elongations of the entries in small motion; shape (k, 2 n)."""
    count, sites = len(bonds.owners), len(bonds.neighbours.offsets) - 1
    entries = np.repeat(np.arange(count), 2)
    axes = np.tile([0, 1], count)
    n = bonds.direction[bonds.family].ravel()
    other = 2 * np.repeat(bonds.neighbours.indices, 2) + axes
    own = 2 * np.repeat(bonds.owners, 2) + axes
    values = (np.concatenate([n, -n]), (np.tile(entries, 2), np.concatenate([other, own])))
    return coo_matrix(values, shape=(count, 2 * sites)).tocsr()


def _tip_pair(bonds: Bonds, sites: Array) -> list[int]:
    """Entries of the two bonds next to the crack's right tip that share a site."""
    right = bonds.once & ~bonds.fibre & ~bonds.cut
    middles = 0.5 * (sites[bonds.owners] + sites[bonds.neighbours.indices])
    right &= (np.abs(middles[:, 1]) < 1e-9) & (middles[:, 0] > 0.5 * _CRACK)
    entries = np.flatnonzero(right)
    first, second = entries[np.argsort(middles[entries, 0])][:2]
    assert math.isclose(middles[second, 0] - middles[first, 0], 0.5)
    return [int(first), int(second)]
