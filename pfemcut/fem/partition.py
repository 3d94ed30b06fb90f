"""Which rank has which rows of the matrices.

All particles and elements are on every rank (they are small). A rank owns the rows of a compact share of the particles
and computes all elements that touch them, so that assembly needs no communication; solutions are gathered once a solve.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from pfemcut.fem.sparsity import Sparsity

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Partition:
    """Shares of the particles and elements of one mesh.

    Parameters
    ----------
    comm
        Communicator.
    points
        Particle positions (mm); shape (n, 2).
    cells
        Triangles; shape (m, 3).

    Attributes
    ----------
    count
        Number of particles n.
    first, last
        Own particles have the numbers first <= number < last in the matrices.
    number
        Number of each particle; shape (n,).
    particles
        Particle of each number; shape (n,).
    elements
        Elements that touch an own particle; shape (local,).
    corners
        Their particles; shape (local, 3).
    cells
        Numbers of their particles; shape (local, 3).
    sparsity
        Which particles linear elements couple, in own rows.
    """

    def __init__(self, comm: MPI.Comm, points: Array, cells: IntArray):
        self.comm = comm
        self.count = len(points)
        if comm.size == 1:
            self.first, self.last = 0, self.count
            self.number = self.particles = np.arange(self.count)
            self.elements = np.arange(len(cells))
            self.corners = self.cells = np.ascontiguousarray(cells, dtype=np.int64)
            self.sparsity = Sparsity.of(self.cells, self.first, self.last, self.count)
            return
        owner = shares(points, comm.size)
        self.particles = np.argsort(owner, kind="stable")
        self.number = np.empty(self.count, dtype=np.int64)
        self.number[self.particles] = np.arange(self.count)
        ends = np.searchsorted(owner[self.particles], np.arange(comm.size + 1))
        self.first, self.last = int(ends[comm.rank]), int(ends[comm.rank + 1])
        self._counts = np.diff(ends)
        self.elements = np.flatnonzero((owner[cells] == comm.rank).any(axis=1))
        self.corners = np.ascontiguousarray(cells[self.elements], dtype=np.int64)
        self.cells = self.number[self.corners]
        self.sparsity = Sparsity.of(self.cells, self.first, self.last, self.count)

    def gather(self, own: Array, components: int) -> Array:
        """All particles' values from each rank's ``own`` ones, in the order of the particles; (n, components).

        Every rank gets the same bits: every rank decides on them.
        """
        if self.comm.size == 1:
            return own.reshape(self.count, components)
        values = np.empty(self.count * components)
        self.comm.Allgatherv(np.ascontiguousarray(own), (values, self._counts * components))
        return values.reshape(self.count, components)[self.number]


def shares(points: Array, parts: int) -> IntArray:
    """Compact shares of equal size: bisection of the ``points`` (n, 2) along their longer extent; part of each (n,)."""
    part = np.zeros(len(points), dtype=np.int64)
    pieces = [(np.arange(len(points)), 0, parts)]
    while pieces:
        members, first, count = pieces.pop()
        if count == 1 or not len(members):
            part[members] = first
            continue
        axis = int(np.argmax(np.ptp(points[members], axis=0)))
        order = members[np.argsort(points[members, axis], kind="stable")]
        lower = count // 2
        middle = len(members) * lower // count
        pieces.append((order[:middle], first, lower))
        pieces.append((order[middle:], first + lower, count - lower))
    return part
