"""Neighbours in the present configuration, from a list of cells, kept until particles have moved too far.

The list reaches farther than the kernel by a skin, so it stays complete while no particle has moved by more than half
of the skin, seen from their mean. Pairs out of reach add nothing to a sum over the kernel, not even in its last bit; so
results do not depend on when the list was made, and it is no part of a run's state.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_SKIN = 0.15
"""Of the radius: longer lists against rarer ones."""
_MOST_CELLS = 8
"""Cells a particle; beyond, where some have flown off, cells are made larger."""

_NO_GROUPS: IntArray = np.zeros(0, dtype=np.int64)


class NeighbourList:
    """Neighbours within a radius (mm) of points that move; the list reaches farther by the part ``skin`` of it.

    Points of different ``group`` (n,) are no neighbours, if groups are given.

    Attributes
    ----------
    offsets, indices
        Rows of neighbours as in :class:`pfemcut.particles.neighbours.Neighbours`, with those in the skin.
    """

    def __init__(self, radius: float, skin: float = _SKIN, group: IntArray = _NO_GROUPS) -> None:
        self._radius = radius
        self._skin = skin
        self._group = group
        self._made_at: Array = np.empty((0, 0))
        self.offsets: IntArray = np.zeros(1, dtype=np.int64)
        self.indices: IntArray = np.zeros(0, dtype=np.int64)

    def follow(self, points: Array) -> None:
        """Make the list complete for ``points`` (n, d)."""
        if self._made_at.shape == points.shape:
            moved = points - self._made_at
            moved -= moved.mean(axis=0)
            if np.max(np.einsum("na,na->n", moved, moved)) <= (0.5 * self._skin * self._radius) ** 2:
                return
        found = pairs_in_cells(points, (1.0 + self._skin) * self._radius)
        self.offsets, self.indices = self._of_one_group(*found) if len(self._group) else found
        self._made_at = points

    def _of_one_group(self, offsets: IntArray, indices: IntArray) -> tuple[IntArray, IntArray]:
        owners = np.repeat(self._group, np.diff(offsets))
        return kept_rows(offsets, indices, self._group[indices] == owners)


def pairs_in_cells(points: Array, radius: float) -> tuple[IntArray, IntArray]:
    """Offsets (n + 1,) and indices (k,) of all neighbours of ``points`` (n, d) up to ``radius`` (mm), in order."""
    low = points.min(axis=0)
    extent = points.max(axis=0) - low
    size = radius
    while np.prod(np.floor(extent / size) + 1.0) > _MOST_CELLS * len(points) + 1000.0:
        size *= 1.5
    shape = np.ones(3, dtype=np.int64)
    shape[: points.shape[1]] = np.floor(extent / size).astype(np.int64) + 1
    places = np.zeros((len(points), 3), dtype=np.int64)
    places[:, : points.shape[1]] = np.floor((points - low) / size)
    cell = (places[:, 0] * shape[1] + places[:, 1]) * shape[2] + places[:, 2]
    members = np.argsort(cell, kind="stable")
    starts = np.searchsorted(cell[members], np.arange(int(shape.prod()) + 1))
    none = np.zeros(0, dtype=np.int64)
    counts = _rows(points, radius * radius, places, shape, members, starts, none, none)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    indices = np.empty(int(offsets[-1]), dtype=np.int64)
    _rows(points, radius * radius, places, shape, members, starts, offsets, indices)
    return offsets, _transposed(offsets, indices)


def kept_rows(offsets: IntArray, indices: IntArray, kept: BoolArray) -> tuple[IntArray, IntArray]:
    """The rows with those entries only that are ``kept`` (k,)."""
    return np.concatenate([[0], np.cumsum(kept)])[offsets], indices[kept]


@njit(parallel=True, cache=True)
def _rows(points, square, places, shape, members, starts, offsets, indices):  # type: ignore[no-untyped-def]
    """Number of neighbours of each particle; their indices too, by cells, if there are offsets to put them."""
    count, dimension = points.shape
    counts = np.zeros(count, dtype=np.int64)
    for i in prange(count):
        found = 0
        for x in range(max(places[i, 0] - 1, 0), min(places[i, 0] + 2, shape[0])):
            for y in range(max(places[i, 1] - 1, 0), min(places[i, 1] + 2, shape[1])):
                for z in range(max(places[i, 2] - 1, 0), min(places[i, 2] + 2, shape[2])):
                    cell = (x * shape[1] + y) * shape[2] + z
                    for place in range(starts[cell], starts[cell + 1]):
                        j = members[place]
                        apart = 0.0
                        for a in range(dimension):
                            apart += (points[j, a] - points[i, a]) ** 2
                        if j != i and apart <= square:
                            if len(offsets):
                                indices[offsets[i] + found] = j
                            found += 1
        counts[i] = found
    return counts


@njit(cache=True)
def _transposed(offsets, indices):  # type: ignore[no-untyped-def]
    """The rows seen from the other side: the same pairs, now in order, several times as fast as by sorting each row."""
    place, other = offsets[:-1].copy(), np.empty_like(indices)
    for i in range(len(offsets) - 1):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            other[place[j]] = i
            place[j] += 1
    return other
