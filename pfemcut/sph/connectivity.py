"""Which particles of a body belong together: a body that touches itself does not grow on to itself.

A renewed reference takes its neighbours from where particles are now, but only those that were connected in the old
one: neighbours, or pairs with at least a tenth of their neighbours in common. Between two references a pair moves by
about half a smoothing length, so what comes near by flow has a quarter or more in common, in shear without end too;
what comes near as the body folds has none. At the root of a fold some have: with one alone being enough a fold would
close like a zip, from reference to reference. Near pairs that are not connected stay apart as long as they are near,
unless they have two thirds in common, as pairs a spacing apart have inside of a body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.particles.neighbours import Neighbours, neighbours_of, pairs_within

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

COMMON = 1.0 / 10.0
"""Part of the fewer neighbours of a pair that it must have in common to be connected."""
COMMON_OF_APART = 2.0 / 3.0
"""The same for a pair that is apart."""


@dataclass(frozen=True)
class Connectivity:
    """Pairs of one body within the support of the kernel.

    Attributes
    ----------
    neighbours
        Those that belong together.
    apart
        Those that do not.
    """

    neighbours: Neighbours
    apart: Neighbours

    @property
    def apart_pairs(self) -> IntArray:
        """Pairs that are apart, each once; shape (m, 2)."""
        owners = self.apart.owners
        once = owners < self.apart.indices
        return np.column_stack([owners[once], self.apart.indices[once]])

    def connected(self, pairs: IntArray) -> BoolArray:
        """Whether each of the ``pairs`` (m, 2) is one of neighbours, or has enough of them in common; (m,)."""
        return np.asarray(_connected(pairs, *self.rows))

    @property
    def rows(self) -> tuple[IntArray, IntArray, IntArray, IntArray, tuple[float, float]]:
        """Offsets and indices of the neighbours, then of those apart; what must be in common."""
        near, apart = self.neighbours, self.apart
        return near.offsets, near.indices, apart.offsets, apart.indices, (COMMON, COMMON_OF_APART)


def connectivity(points: Array, radius: float, group: IntArray, apart: IntArray) -> Connectivity:
    """All pairs of ``points`` (n, d) of one ``group`` (n,) within ``radius`` (mm), but for those ``apart`` (m, 2)."""
    pairs = pairs_within(points, radius, group)
    divided = np.isin(_keys(pairs, len(points)), _keys(np.sort(apart, axis=1), len(points)))
    return _split(pairs, ~divided, len(points))


def renewed_connectivity(old: Connectivity, points: Array, radius: float, group: IntArray) -> Connectivity:
    """That of particles now at ``points`` (n, d): neighbours are pairs that were connected in the ``old`` one."""
    pairs = pairs_within(points, radius, group)
    return _split(pairs, old.connected(pairs), len(points))


def _split(pairs: IntArray, together: BoolArray, count: int) -> Connectivity:
    return Connectivity(neighbours_of(pairs[together], count), neighbours_of(pairs[~together], count))


def _keys(pairs: IntArray, count: int) -> IntArray:
    return pairs[:, 0] * count + pairs[:, 1]


@njit(parallel=True, cache=True)
def _connected(pairs, offsets, indices, apart_offsets, apart_indices, shares):  # type: ignore[no-untyped-def]
    found = np.empty(len(pairs), dtype=np.bool_)
    for k in prange(len(pairs)):
        found[k] = are_connected(
            pairs[k, 0], pairs[k, 1], offsets, indices, apart_offsets, apart_indices, shares
        )
    return found


@njit(inline="always")
def are_connected(  # type: ignore[no-untyped-def]
    i, j, offsets, indices, apart_offsets, apart_indices, shares
):
    """Whether i and j are neighbours or have enough of them in common: more so if they are apart."""
    a, b = offsets[i], offsets[j]
    last_a, last_b = offsets[i + 1], offsets[j + 1]
    for k in range(a, last_a):
        if indices[k] == j:
            return True
    share = shares[0]
    for k in range(apart_offsets[i], apart_offsets[i + 1]):
        if apart_indices[k] == j:
            share = shares[1]
    fewer = min(last_a - a, last_b - b)
    common = 0
    # Both rows are in order.
    while a < last_a and b < last_b:
        if indices[a] == indices[b]:
            common += 1
            a += 1
            b += 1
        elif indices[a] < indices[b]:
            a += 1
        else:
            b += 1
    return common > 0 and common >= share * fewer
