"""Where the boundary of a body faces itself: chip against chip, chip against workpiece.

A point q of the boundary faces the nearest point of an edge that shares no particle with q's edge, if

1. q lies outside the edge, on the side of its outward normal: the other side of a thin wall does not count;
2. the outward normals oppose: the cosine of the angle between one and the reverse of the other exceeds 1/4. From
   there to 1 grows the weight of the contact's length, so that contact begins and ends smoothly where surfaces turn;
3. it is nearer than a reach, and than half the boundary between the two: in an open notch, such as the root of the
   chip, nothing faces.

The walls of any notch are near each other at its root. So the distance at which two points touch, the contact
thickness, is at most an eighth of the boundary between them: the walls of a notch of more than 14 degrees never touch,
and one that closes does so from its mouth, or progressively from its root. The curve that contact sees is the closed
quadratic B-spline through all particles of the loop; it rounds corners by less than a quarter of an edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshing.mesh import Boundary
from pfemcut.contact.surface import SPLINE, Arcs

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_NOTCH = 0.125  # largest contact thickness relative to the boundary between two points
_OPEN = 0.5  # distance relative to the boundary between two points beyond which they lie in an open notch
_OPPOSED = 0.25  # cosine between normal and reversed normal below which surfaces do not face each other
_WINDOW = 3  # arcs on each side of the nearest one among which the foot is looked for
_LEAST_APART = 2  # entries between the ends of a point's edge and the arcs of its window
_PLACES = np.array([0.0, 0.5, 1.0])  # of the points on an edge, and what they stand for: Simpson's rule
_PARTS = np.array([1.0, 4.0, 1.0]) / 6.0


@dataclass(frozen=True)
class FacingPoints:
    """Points of the boundary that face another part of it.

    Attributes
    ----------
    edges
        Edge of each point, as entry of the boundary; shape (k,).
    place
        Coordinate on it, from 0 to 1; shape (k,).
    lengths
        Length that it stands for, weighted by how much the surfaces face each other (mm); shape (k,).
    distance
        To the nearest point of the surface that it faces (mm); shape (k,).
    apart
        Length of boundary between the two (mm); infinite between loops; shape (k,).
    curve
        The loops as closed curves; arc i is that of entry i.
    candidates
        Arcs of it among which that point is; shape (k, w).
    """

    edges: IntArray
    place: Array
    lengths: Array
    distance: Array
    apart: Array
    curve: Arcs
    candidates: IntArray

    @property
    def numbers(self) -> IntArray:
        """A number for each point that tells its edge and place; shape (k,)."""
        return len(_PLACES) * self.edges + np.rint((len(_PLACES) - 1) * self.place).astype(np.int64)

    def thickness(self, largest: float) -> Array:
        """Distance at which each point touches (mm), at most ``largest``; shape (k,)."""
        return np.minimum(largest, _NOTCH * self.apart)


def facing_points(
    points: Array, boundary: Boundary, bodies: IntArray, motion: Array, thickness: float, reach: float
) -> FacingPoints:
    """Search the boundary for points that may come as near to another part of it as they touch.

    Parameters
    ----------
    points
        Positions of all particles (mm); shape (n, 2).
    bodies
        Number of the body of each boundary entry; different bodies don't see each other; shape (b,).
    motion
        Predicted motion of the particles (mm); shape (n, 2).
    thickness
        Largest contact thickness (mm).
    reach
        Distance beyond the contact thickness up to which points count (mm), to which twice their predicted relative
        motion is added.
    """
    start, end = points[boundary.edges[:, 0]], points[boundary.edges[:, 1]]
    along = end - start
    length = np.hypot(*along.T)
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    arc = _arc_coordinates(boundary, length)
    pace = 0.5 * (motion[boundary.edges[:, 0]] + motion[boundary.edges[:, 1]])
    fastest = 2.0 * float(np.hypot(*(pace - pace.mean(axis=0)).T).max(initial=0.0))
    farthest = thickness + reach + 2.0 * fastest

    count = len(length)
    edge, place = np.repeat(np.arange(count), 3), np.tile(_PLACES, count)
    at = start[edge] + place[:, None] * along[edge]
    query, other = _near_pairs(at, start, along, length, farthest)
    mine = edge[query]
    keep = (bodies[mine] == bodies[other]) & (_entries_between(boundary, mine, other) >= 2)
    keep[keep] = -np.sum(outward[mine[keep]] * outward[other[keep]], axis=1) > _OPPOSED
    query, other, mine = query[keep], other[keep], mine[keep]

    offset = at[query] - start[other]
    fraction = np.clip(np.sum(offset * along[other], axis=1) / length[other] ** 2, 0.0, 1.0)
    distance = np.hypot(*(offset - fraction[:, None] * along[other]).T)
    outside = np.sum(offset * outward[other], axis=1) >= 0.0
    apart = _length_between(
        boundary,
        length,
        mine,
        other,
        arc[mine] + place[query] * length[mine],
        arc[other] + fraction * length[other],
    )
    touches_at = np.minimum(thickness, _NOTCH * apart)
    slack = reach + 2.0 * np.hypot(*(pace[mine] - pace[other]).T)
    middle = np.where(fraction < 0.5, other, boundary.following[other])
    separation = np.minimum(
        _entries_between(boundary, mine, middle),
        _entries_between(boundary, boundary.following[mine], middle),
    )
    near = distance < np.minimum(touches_at + slack, _OPEN * apart)
    chosen = outside & near & (separation >= _LEAST_APART)

    # Of each point the surface that it is nearest to touching.
    rows = np.flatnonzero(chosen)
    order = rows[np.lexsort((other[rows], (distance - touches_at)[rows], query[rows]))]
    first = np.ones(len(order), dtype=bool)
    first[1:] = query[order[1:]] != query[order[:-1]]
    best = order[first]
    # By the curve's normal at the foot: that of the edge would change from one to the next.
    curve = _closed_arcs(boundary)
    opposite = _curve_normals(
        points, curve, middle[best], np.where(fraction < 0.5, 0.5, -0.5)[best] + fraction[best]
    )
    cosine = np.maximum(-np.sum(outward[mine[best]] * opposite, axis=1), _OPPOSED)
    weight = np.tile(_PARTS, count)[query[best]]
    return FacingPoints(
        mine[best],
        place[query[best]],
        weight * length[mine[best]] * (cosine - _OPPOSED) / (1.0 - _OPPOSED),
        distance[best],
        apart[best],
        curve,
        _window(boundary, middle[best], separation[best]),
    )


def _closed_arcs(boundary: Boundary) -> Arcs:
    """The loops as closed B-splines, corners included; arc i is that of entry i."""
    particles = boundary.particles
    nodes = np.column_stack([particles[boundary.preceding], particles, particles[boundary.following]])
    sizes = np.diff(boundary.starts)
    count = len(particles)
    return Arcs(
        nodes,
        np.tile(SPLINE, (count, 1, 1)),
        np.repeat(boundary.starts[:-1], sizes),
        np.repeat(boundary.starts[1:] - 1, sizes),
        np.ones(count, dtype=bool),
    )


def _curve_normals(points: Array, curve: Arcs, arcs: IntArray, t: Array) -> Array:
    """Outward unit normals of the closed ``curve`` at ``t`` (k,) on its ``arcs`` (k,); shape (k, 2)."""
    _, slope, _ = curve.at(arcs, t)
    tangent = np.einsum("ka,kai->ki", slope, points[curve.nodes[arcs]])
    return np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]


def _near_pairs(
    at: Array, start: Array, along: Array, length: Array, reach: float
) -> tuple[IntArray, IntArray]:
    """Pairs of a point ``at`` (q, 2) and an edge that may be nearer than ``reach``: all that are, and some more."""
    spacing = max(float(np.median(length)), reach)
    pieces = np.ceil(length / spacing).astype(np.int64)
    edge = np.repeat(np.arange(len(length)), pieces)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    samples = start[edge] + ((number + 0.5) / pieces[edge])[:, None] * along[edge]
    found = cKDTree(at).sparse_distance_matrix(cKDTree(samples), reach + 0.5 * spacing, output_type="ndarray")
    # An edge of several samples may be found more than once.
    keys = np.unique(found["i"] * len(length) + edge[found["j"]])
    return keys // len(length), keys % len(length)


def _arc_coordinates(boundary: Boundary, length: Array) -> Array:
    """Distance along its loop at which each edge begins (mm); shape (b,)."""
    total = np.concatenate([[0.0], np.cumsum(length)])
    sizes = np.diff(boundary.starts)
    return total[:-1] - np.repeat(total[boundary.starts[:-1]], sizes)


def _length_between(
    boundary: Boundary, length: Array, a: IntArray, b: IntArray, at_a: Array, at_b: Array
) -> Array:
    """Shorter way along the loop between places on the edges ``a`` and ``b`` (mm); infinite between loops; (k,)."""
    loop = boundary.loop_numbers
    perimeter = np.add.reduceat(length, boundary.starts[:-1])[loop[a]]
    way = np.abs(at_a - at_b)
    return np.where(loop[a] == loop[b], np.minimum(way, perimeter - way), np.inf)


def _entries_between(boundary: Boundary, a: IntArray, b: IntArray) -> IntArray:
    """Steps from entry to entry between ``a`` and ``b`` (k,), the shorter way; many between loops; shape (k,)."""
    loop = boundary.loop_numbers
    size = np.diff(boundary.starts)[loop[a]]
    way = np.abs(a - b)
    return np.where(loop[a] == loop[b], np.minimum(way, size - way), len(boundary.particles))


def _window(boundary: Boundary, middle: IntArray, separation: IntArray) -> IntArray:
    """Arcs around ``middle`` (k,), none that a point ``separation`` (k,) entries away lies on; shape (k, 7)."""
    width = np.minimum(_WINDOW, separation - _LEAST_APART)
    offset = np.clip(np.arange(-_WINDOW, _WINDOW + 1), -width[:, None], width[:, None])
    loop = boundary.loop_numbers[middle]
    first = boundary.starts[loop][:, None]
    size = np.diff(boundary.starts)[loop][:, None]
    return first + (middle[:, None] + offset - first) % size
