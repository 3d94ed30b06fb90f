"""Neighbours of particles: every pair within a radius, seen from both sides, in compressed rows.

The neighbours of particle i are ``indices[offsets[i] : offsets[i + 1]]``, in increasing order. A loop over particles
that only writes to its own row needs no locks, so it runs on any number of threads with the same result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Neighbours:
    """Pairs of particles in compressed rows.

    Attributes
    ----------
    offsets
        First entry of each particle, and the number of entries; shape (n + 1,).
    indices
        The other particle of each entry; shape (k,).
    reverse
        The entry of the same pair in the other particle's row; shape (k,).
    """

    offsets: IntArray
    indices: IntArray
    reverse: IntArray

    @property
    def owners(self) -> IntArray:
        """The particle whose row each entry is in; shape (k,)."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


def neighbours_within(points: Array, radius: float, group: IntArray) -> Neighbours:
    """All pairs of ``points`` (n, d) of one ``group`` (n,) that are not farther apart than ``radius`` (mm)."""
    return neighbours_of(pairs_within(points, radius, group), len(points))


def pairs_within(points: Array, radius: float, group: IntArray) -> IntArray:
    """The same pairs, each once with the smaller number first; shape (m, 2)."""
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray").astype(np.int64)
    return pairs[group[pairs[:, 0]] == group[pairs[:, 1]]]


def neighbours_of(pairs: IntArray, count: int) -> Neighbours:
    """Rows of ``count`` particles from ``pairs`` (m, 2), each given once."""
    one = np.concatenate([pairs[:, 0], pairs[:, 1]])
    other = np.concatenate([pairs[:, 1], pairs[:, 0]])
    order = np.lexsort((other, one))
    one, other = one[order], other[order]
    offsets = np.concatenate([[0], np.cumsum(np.bincount(one, minlength=count))])
    # Entries sorted by their other particle are the rows again, each pair now seen from its other side.
    return Neighbours(offsets, other, np.lexsort((one, other)))
