"""Bonds between nearest sites of a turned triangular lattice, with families and flags, in compressed rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.neighbours import Neighbours
from pfemcut.peridynamics.plate import Plate, cut_by_cracks

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

FAMILIES = 6
"""Directions of bonds: 60 degrees times their number from the fibre; 0 and 3 are fibre bonds."""


@dataclass(frozen=True)
class Bonds:
    """Bonds, each seen from both of its sites.

    Attributes
    ----------
    neighbours
        The other site of each entry, by rows.
    owners
        The site whose row an entry is in; shape (k,).
    family
        Of each entry; shape (k,).
    direction
        Unit vectors of the families; shape (6, 2).
    once
        Whether an entry is that of the two which counts the bond; shape (k,).
    cut
        Whether a line crack cuts the bond from the start; shape (k,).
    """

    neighbours: Neighbours
    owners: IntArray
    family: NDArray[np.int8]
    direction: Array
    once: NDArray[np.bool_]
    cut: NDArray[np.bool_]

    @property
    def fibre(self) -> NDArray[np.bool_]:
        """Whether entries are fibre bonds; shape (k,)."""
        return self.family % 3 == 0


def bonds_of(plate: Plate, sites: Array, neighbours: Neighbours) -> Bonds:
    """The bonds of ``neighbours`` in ``plate``.

    Parameters
    ----------
    plate
        Its fibre angle and line cracks.
    sites
        Shape (n, 2).
    neighbours
        Pairs of nearest sites.
    """
    owners = neighbours.owners
    between = sites[neighbours.indices] - sites[owners]
    turned = np.arctan2(between[:, 1], between[:, 0]) - plate.fibre_angle
    family = (np.rint(turned / (np.pi / 3.0)).astype(np.int64) % FAMILIES).astype(np.int8)
    angles = plate.fibre_angle + np.arange(FAMILIES // 2) * np.pi / 3.0
    half = np.column_stack([np.cos(angles), np.sin(angles)])
    # Exactly opposite from a bond's two sides, so that momentum is conserved to round-off.
    direction = np.concatenate([half, -half])
    cut = cut_by_cracks(plate, sites[owners], sites[neighbours.indices])
    # From its two sides a bond is cut alike but for round-off.
    cut |= cut[neighbours.reverse]
    return Bonds(neighbours, owners, family, direction, owners < neighbours.indices, cut)
