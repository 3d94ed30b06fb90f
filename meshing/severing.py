"""Severing a body: a piece of it is dropped along a path of element edges, and nothing else changes.

The elements that stay keep their particles, so no field has to be transferred.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from meshing.mesh import Boundary, Mesh, unique_edges

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


_ACROSS = 2.0
"""The boundary between the ends of a path across the body is more than this times as long as the path."""


@dataclass(frozen=True)
class Crossing:
    """A path of element edges from one side of a body to the other.

    Attributes
    ----------
    start, end
        Boundary entries that it joins; the piece it severs has the entries from ``start`` onwards to ``end``.
    particles
        Particles on the path, those of ``start`` and ``end`` included; shape (k,).
    length
        Of the path (mm).
    """

    start: int
    end: int
    particles: IntArray
    length: float


@dataclass(frozen=True)
class Severed:
    """What is left of a mesh, and the indices of its particles and cells in the whole."""

    mesh: Mesh
    particles: IntArray
    cells: IntArray


def loop_after(boundary: Boundary, entry: int) -> IntArray:
    """The entries of the loop of ``entry``, from it onwards."""
    number = int(np.searchsorted(boundary.starts, entry, side="right")) - 1
    a, b = int(boundary.starts[number]), int(boundary.starts[number + 1])
    return np.roll(np.arange(a, b), a - entry)


def crossing(mesh: Mesh, start: int, ends: IntArray, ways: Array, reach: float) -> Crossing | None:
    """The shortest path across the body from the boundary entry ``start`` to one of ``ends``.

    It touches the boundary at its own ends alone, and is less than half as long as the boundary between them, so that
    it does not just run along it. None if there is none shorter than ``reach`` (mm).

    Parameters
    ----------
    mesh
        One body.
    start, ends
        Boundary entries; ``ends`` has shape (k,).
    ways
        Distance of each end from the start along the boundary (mm); shape (k,).
    reach
        Longest path (mm).
    """
    boundary, count = mesh.boundary, len(mesh.points)
    at = int(boundary.particles[start])
    near = np.hypot(*(mesh.points - mesh.points[at]).T) <= reach
    cells = mesh.cells[near[mesh.cells].all(axis=1)]
    if not len(cells):
        return None
    edges = unique_edges(cells)
    on_boundary = np.zeros(count, dtype=bool)
    on_boundary[boundary.particles] = True
    # Directed: out of the start, through the inside, into an end.
    leaves = ~on_boundary
    leaves[at] = True
    enters = ~on_boundary
    enters[boundary.particles[ends]] = True
    both = np.vstack([edges, edges[:, ::-1]])
    both = both[leaves[both[:, 0]] & enters[both[:, 1]]]
    both = both[~np.isin(_keys(both, count), _keys(boundary.edges, count))]
    lengths = np.hypot(*(mesh.points[both[:, 1]] - mesh.points[both[:, 0]]).T)
    graph = csr_array((lengths, (both[:, 0], both[:, 1])), shape=(count, count))
    distance, before = dijkstra(graph, indices=at, return_predecessors=True, limit=reach)
    found = distance[boundary.particles[ends]]
    found = np.where(_ACROSS * found < ways, found, np.inf)
    best = int(np.argmin(found)) if len(found) else 0
    if not len(found) or not np.isfinite(found[best]):
        return None
    path = [int(boundary.particles[ends[best]])]
    while path[-1] != at:
        path.append(int(before[path[-1]]))
    return Crossing(start, int(ends[best]), np.asarray(path[::-1], dtype=np.int64), float(found[best]))


def sever(mesh: Mesh, path: Crossing) -> Severed:
    """``mesh`` without the piece beyond ``path``, whose edges get the part that the boundary has from its end on."""
    boundary, count = mesh.boundary, len(mesh.points)
    order = loop_after(boundary, path.start)
    beyond = int(np.flatnonzero(order == path.end)[0])
    dropped = _piece(mesh, path, order[:beyond])
    cells = np.flatnonzero(~dropped)
    stays = np.zeros(count, dtype=bool)
    stays[mesh.cells[cells]] = True
    particles = np.flatnonzero(stays)
    number = np.cumsum(stays) - 1

    # The loop from the end of the path back round to its start, then along the path.
    rest = order[beyond:]
    part = boundary.parts[path.end]
    new_particles = np.concatenate([boundary.particles[rest], path.particles[:-1]])
    new_parts = np.concatenate([boundary.parts[rest], np.full(len(path.particles) - 1, part)])
    which = int(np.searchsorted(boundary.starts, path.start, side="right")) - 1
    spans = list(zip(boundary.starts[:-1], boundary.starts[1:], strict=True))
    loops = [(boundary.particles[a:b], boundary.parts[a:b]) for a, b in spans]
    loops[which] = (new_particles, new_parts)
    new_boundary = Boundary(
        number[np.concatenate([each for each, _ in loops])],
        np.concatenate([each for _, each in loops]),
        np.concatenate([[0], np.cumsum([len(each) for each, _ in loops])]).astype(np.int64),
    )
    left = Mesh(
        mesh.points[particles], number[mesh.cells[cells]], new_boundary, mesh.ids[particles], mesh.next_id
    )
    return Severed(left, particles, cells)


def _piece(mesh: Mesh, path: Crossing, entries: IntArray) -> BoolArray:
    """The cells on the side of ``path`` that has the boundary edges of ``entries``; shape (m,)."""
    count, m = len(mesh.points), len(mesh.cells)
    sides = np.vstack([mesh.cells[:, [0, 1]], mesh.cells[:, [1, 2]], mesh.cells[:, [2, 0]]])
    keys, owners = _keys(sides, count), np.tile(np.arange(m), 3)
    order = np.argsort(keys, kind="stable")
    keys, owners = keys[order], owners[order]
    shared = np.flatnonzero(keys[:-1] == keys[1:])
    on_path = _keys(np.column_stack([path.particles[:-1], path.particles[1:]]), count)
    shared = shared[~np.isin(keys[shared], on_path)]
    graph = csr_array((np.ones(len(shared)), (owners[shared], owners[shared + 1])), shape=(m, m))
    _, component = connected_components(graph, directed=False)
    at = np.isin(keys, _keys(mesh.boundary.edges[entries], count))
    return np.isin(component, component[owners[at]])


def _keys(pairs: IntArray, count: int) -> IntArray:
    """One integer for each undirected pair of particles; shape (e,)."""
    low, high = np.sort(pairs, axis=1).T
    return np.asarray(low * count + high, dtype=np.int64)
