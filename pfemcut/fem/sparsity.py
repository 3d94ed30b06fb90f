"""Which particles a sparse matrix couples, and where its entries lie.

Rows belong to particles in blocks; a block row has the particle itself and its neighbours, in ascending numbers, and
its scalar rows follow each other. So the place of an entry follows from that of its block.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

IntArray = NDArray[np.int64]
Int32Array = NDArray[np.int32]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Sparsity:
    """Block structure of the own rows of a matrix.

    Attributes
    ----------
    first
        Number of the first own particle.
    starts
        First block of each own row, and the end; shape (r + 1,).
    neighbours
        Number of the particle of each block, ascending in a row; shape (blocks,).
    places
        Block of each pair of corners (a, b) of the partition's cells, at 3 a + b; -1 where the row is not an own one;
        shape (m, 9).
    """

    first: int
    starts: IntArray
    neighbours: IntArray
    places: IntArray

    @staticmethod
    def of(cells: IntArray, first: int, last: int, count: int) -> Sparsity:
        """That of linear elements on ``cells`` (m, 3) of ``count`` particles; own: first <= number < last."""
        return Sparsity(first, *_couplings(cells, first, last - first, count))

    def coupled(self, groups: Sequence[IntArray]) -> Sparsity:
        """The same with the particle numbers of each of ``groups`` coupled, too."""
        if not groups:
            return self
        rows = np.concatenate([np.repeat(each, len(each)) for each in groups]) - self.first
        columns = np.concatenate([np.tile(each, len(each)) for each in groups])
        own = (rows >= 0) & (rows < len(self.starts) - 1)
        count = 1 + int(max(self.neighbours.max(initial=0), columns.max(initial=0)))
        old = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts)) * count + self.neighbours
        keys = np.union1d(old, rows[own] * count + columns[own])
        block = np.append(np.searchsorted(keys, old), -1)
        starts = np.searchsorted(keys, count * np.arange(len(self.starts)))
        return Sparsity(self.first, starts, keys % count, block[self.places])

    def scalar_rows(self, components: int) -> tuple[Int32Array, Int32Array]:
        """Row pointers and columns of the scalar matrix with ``components`` unknowns a particle."""
        return _scalar_rows(self.starts, self.neighbours, components)

    def blocks(self, rows: IntArray, columns: IntArray) -> IntArray:
        """Blocks of pairs of particle numbers that the matrix couples, with own rows.

        Raises
        ------
        ValueError
            If a pair is not coupled.
        """
        found = _blocks(self.starts, self.neighbours, rows - self.first, columns)
        if len(found) and found.min() < 0:
            raise ValueError("the matrix does not couple these particles")
        return found


@njit(cache=True)
def _couplings(cells, first, rows, count):  # type: ignore[no-untyped-def]
    """Starts, neighbours and places of :class:`Sparsity`."""
    m = len(cells)
    meeting = np.zeros(rows + 1, dtype=np.int64)
    for i in range(m):
        for a in range(3):
            row = cells[i, a] - first
            if 0 <= row < rows:
                meeting[row + 1] += 1
    meeting = np.cumsum(meeting)
    around = np.empty(meeting[rows], dtype=np.int64)
    filled = meeting[:-1].copy()
    for i in range(m):
        for a in range(3):
            row = cells[i, a] - first
            if 0 <= row < rows:
                around[filled[row]] = i
                filled[row] += 1

    starts = np.zeros(rows + 1, dtype=np.int64)
    neighbours = np.empty(3 * meeting[rows] + rows, dtype=np.int64)
    seen = np.full(count, -1, dtype=np.int64)
    end = 0
    for row in range(rows):
        begin = end
        neighbours[end] = row + first  # a particle without elements has its own block, too
        seen[row + first] = row
        end += 1
        for k in range(meeting[row], meeting[row + 1]):
            for b in range(3):
                other = cells[around[k], b]
                if seen[other] != row:
                    seen[other] = row
                    neighbours[end] = other
                    end += 1
        neighbours[begin:end] = np.sort(neighbours[begin:end])
        starts[row + 1] = end

    places = np.full((m, 9), -1, dtype=np.int64)
    at = np.empty(count, dtype=np.int64)
    for row in range(rows):
        for block in range(starts[row], starts[row + 1]):
            at[neighbours[block]] = block
        for k in range(meeting[row], meeting[row + 1]):
            i = around[k]
            for a in range(3):
                if cells[i, a] - first == row:
                    for b in range(3):
                        places[i, 3 * a + b] = at[cells[i, b]]
    return starts, neighbours[:end].copy(), places


@njit(cache=True)
def _scalar_rows(starts, neighbours, components):  # type: ignore[no-untyped-def]
    rows = len(starts) - 1
    pointers = np.zeros(components * rows + 1, dtype=np.int32)
    columns = np.empty(components * components * len(neighbours), dtype=np.int32)
    at = 0
    for row in range(rows):
        for j in range(components):
            for block in range(starts[row], starts[row + 1]):
                for k in range(components):
                    columns[at] = components * neighbours[block] + k
                    at += 1
            pointers[components * row + j + 1] = at
    return pointers, columns


@njit(cache=True)
def _blocks(starts, neighbours, rows, columns):  # type: ignore[no-untyped-def]
    found = np.full(len(rows), -1, dtype=np.int64)
    for i in range(len(rows)):
        begin, end = starts[rows[i]], starts[rows[i] + 1]
        block = begin + np.searchsorted(neighbours[begin:end], columns[i])
        if block < end and neighbours[block] == columns[i]:
            found[i] = block
    return found


@njit(cache=True)
def add_blocks(starts, values, components, blocks, rows, stiffness):  # type: ignore[no-untyped-def]
    """Add ``stiffness`` (s, k, k), k <= components, to the first entries of the ``blocks`` of the own ``rows`` (s,)."""
    for i in range(len(blocks)):
        row = rows[i]
        start, count = starts[row], starts[row + 1] - starts[row]
        for j in range(stiffness.shape[1]):
            at = components * (components * start + j * count + blocks[i] - start)
            for k in range(stiffness.shape[2]):
                values[at + k] += stiffness[i, j, k]


@njit(cache=True)
def fix_unknowns(pointers, columns, values, fixed, first):  # type: ignore[no-untyped-def]
    """Zero rows and columns of the ``fixed`` unknowns (all scalars), but for a one on the diagonal; in place.

    ``first`` is the number of the first own scalar row.
    """
    for row in range(len(pointers) - 1):
        own = fixed[first + row]
        for at in range(pointers[row], pointers[row + 1]):
            if own or fixed[columns[at]]:
                values[at] = 1.0 if columns[at] == first + row else 0.0
