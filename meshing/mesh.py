"""A triangle mesh of persistent particles with ordered, named boundary loops."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Boundary:
    """Closed boundary loops, one after the other, with the body on the left of every edge.

    Attributes
    ----------
    particles
        Particle index of each loop entry; shape (b,). Edge ``i`` runs from entry ``i`` to ``following[i]``.
    parts
        Part number of each edge (index into the body's part names); shape (b,).
    starts
        First entry of each loop and, last, ``b``; shape (loops + 1,).
    """

    particles: IntArray
    parts: IntArray
    starts: IntArray

    @property
    def following(self) -> IntArray:
        """Loop entry after each entry; shape (b,)."""
        following = np.arange(1, len(self.particles) + 1)
        following[self.starts[1:] - 1] = self.starts[:-1]
        return following

    @property
    def preceding(self) -> IntArray:
        """Loop entry before each entry; shape (b,)."""
        preceding = np.arange(-1, len(self.particles) - 1)
        preceding[self.starts[:-1]] = self.starts[1:] - 1
        return preceding

    @property
    def edges(self) -> IntArray:
        """Particle pairs of the edges; shape (b, 2)."""
        return np.column_stack([self.particles, self.particles[self.following]])

    @property
    def loops(self) -> tuple[IntArray, ...]:
        """Particle indices of each loop."""
        return tuple(np.split(self.particles, self.starts[1:-1]))

    @cached_property
    def loop_numbers(self) -> IntArray:
        """Number of the loop of each entry; shape (b,)."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))


@dataclass(frozen=True)
class Mesh:
    """Particles, triangles and boundary of a body.

    Attributes
    ----------
    points
        Particle positions (mm); shape (n, 2).
    cells
        Triangles, counter-clockwise particle indices; shape (m, 3).
    boundary
        Boundary loops.
    ids
        Persistent identity of each particle; shape (n,).
    next_id
        Identity of the next particle to be born.
    first_particles, first_cells
        First particle and first cell of each body; those of a body lie together; shape (bodies,).
    """

    points: Array
    cells: IntArray
    boundary: Boundary
    ids: IntArray
    next_id: int
    first_particles: IntArray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    first_cells: IntArray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))

    @property
    def particle_ranges(self) -> tuple[slice, ...]:
        """Particles of each body."""
        return _ranges(self.first_particles, len(self.points))

    @property
    def cell_ranges(self) -> tuple[slice, ...]:
        """Cells of each body."""
        return _ranges(self.first_cells, len(self.cells))


def _ranges(first: IntArray, count: int) -> tuple[slice, ...]:
    ends = [*first[1:].tolist(), count]
    return tuple(slice(a, b) for a, b in zip(first.tolist(), ends, strict=True))


def signed_areas(points: Array, cells: IntArray) -> Array:
    """Signed areas (mm²) of triangles ``cells`` (m, 3), positive when counter-clockwise; shape (m,)."""
    a, b, c = points[cells[:, 0]], points[cells[:, 1]], points[cells[:, 2]]
    u, v = b - a, c - a
    return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def circumradii(points: Array, cells: IntArray) -> Array:
    """Circumradii (mm) of triangles ``cells`` (m, 3); shape (m,)."""
    a, b, c = points[cells[:, 0]], points[cells[:, 1]], points[cells[:, 2]]
    product = np.hypot(*(b - a).T) * np.hypot(*(c - b).T) * np.hypot(*(a - c).T)
    return product / np.maximum(4.0 * np.abs(signed_areas(points, cells)), 1e-300)


def boundary_area(points: Array, boundary: Boundary) -> float:
    """Area (mm²) enclosed by the boundary loops (shoelace formula)."""
    a, b = points[boundary.edges[:, 0]], points[boundary.edges[:, 1]]
    # Relative to a near origin, so that the sum of products does not cancel digits.
    origin = points[boundary.particles].mean(axis=0)
    a, b = a - origin, b - origin
    return 0.5 * float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


def unique_edges(cells: IntArray) -> IntArray:
    """Undirected edges of triangles ``cells`` (m, 3), smaller index first; shape (e, 2)."""
    pairs = np.sort(np.vstack([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    base = int(cells.max()) + 1
    keys = np.unique(pairs[:, 0] * base + pairs[:, 1])
    return np.column_stack([keys // base, keys % base])
