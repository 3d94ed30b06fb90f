"""Pairs of particles that may touch by pinballs: of two bodies, or of one if they aren't connected."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.particles.cells import NeighbourList, kept_rows
from pfemcut.sph.connectivity import Connectivity, are_connected

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SKIN = 0.5
"""Of the radius: nearly all pairs are connected and leave the list when it is made, so it may reach far."""


class Pairs(Protocol):
    """Pairs in rows as in :class:`pfemcut.particles.neighbours.Neighbours`, and others that are too far apart."""

    offsets: IntArray
    indices: IntArray


class OtherBodies:
    """Pairs of two bodies within a radius (mm) of particles that move; rows as in :class:`Pairs`."""

    def __init__(self, radius: float, body: IntArray) -> None:
        self._near = NeighbourList(radius)
        self._body = body
        self._seen: IntArray = self._near.indices
        self.offsets: IntArray = np.zeros(len(body) + 1, dtype=np.int64)
        self.indices: IntArray = np.zeros(0, dtype=np.int64)

    def follow(self, points: Array) -> None:
        """Make the list complete for ``points`` (n, d)."""
        self._near.follow(points)
        offsets, indices = self._near.offsets, self._near.indices
        if self._seen is not indices:
            others = self._body[indices] != np.repeat(self._body, np.diff(offsets))
            self.offsets, self.indices = kept_rows(offsets, indices, others)
            self._seen = indices


class TouchingPairs:
    """Pairs of total-Lagrangian SPH within a radius (mm) of particles that move.

    Made anew where particles have moved too far, or where the reference is a new one. Pairs out of reach bear no force,
    so forces don't depend on when the list was made.

    Attributes
    ----------
    offsets, indices
        Rows as in :class:`pfemcut.particles.neighbours.Neighbours`, with those in the skin.
    """

    def __init__(self, radius: float, body: IntArray, group: IntArray) -> None:
        self._near = NeighbourList(radius, _SKIN)
        self._body, self._group = body, group
        self._seen: tuple[Connectivity, IntArray] | tuple[()] = ()
        self.offsets: IntArray = np.zeros(len(body) + 1, dtype=np.int64)
        self.indices: IntArray = np.zeros(0, dtype=np.int64)

    def follow(self, points: Array, connectivity: Connectivity) -> None:
        """Make the list complete for ``points`` (n, d)."""
        self._near.follow(points)
        offsets, indices = self._near.offsets, self._near.indices
        if self._seen and self._seen[0] is connectivity and self._seen[1] is indices:
            return
        touching = _may_touch(offsets, indices, self._body, self._group, *connectivity.rows)
        self.offsets, self.indices = kept_rows(offsets, indices, touching)
        self._seen = (connectivity, indices)


@njit(parallel=True, cache=True)
def _may_touch(  # type: ignore[no-untyped-def]
    offsets, indices, body, group, rows, neighbours, apart_rows, apart, shares
):
    found = np.empty(len(indices), dtype=np.bool_)
    for i in prange(len(body)):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            if body[i] != body[j]:
                found[k] = True
            else:
                # Particles of a rigid body are each a group.
                found[k] = group[i] == group[j] and not are_connected(
                    i, j, rows, neighbours, apart_rows, apart, shares
                )
    return found
