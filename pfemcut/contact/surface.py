"""The surface of a meshed body as contact sees it: a smooth curve through boundary particles, and feet on it.

Between the middles of two boundary edges the curve is the quadratic B-spline arc of the three particles (P. Wriggers,
L. Krstulovic-Opara, J. Korelc, Int. J. Numer. Meth. Engng 51, 2001, 1469-1495, smooth their C1 segments alike), so the
normal, and the share of each particle in a force, are continuous where a node passes from one arc to the next. On
a straight boundary it is the boundary. With ``smooth=False`` the arcs are the edges themselves (paper, eqs. 16-21).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshing.mesh import Boundary
from pfemcut.tools.rigid_wedge import ToolContact

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_SHARP = np.cos(np.radians(40.0))  # at a particle where the boundary turns more the curve has a corner
_ITERATIONS = 20
_CONVERGED = 1e-13
_OVERHANG = (
    0.1  # of its first and last arc by which a chain is longer, so that a point on its end does not chatter
)
_PROLONGED = 0.5  # of an edge: how far a point may slide past the end of the only edge that it looks at
_WINDOW = 3  # arcs on each side of the nearest particle's among which the foot is looked for

# Shape functions of an arc, rows for 1, t, t²: B-spline arc, half edges at the ends of a chain, whole edge.
SPLINE = np.array([[0.5, 0.5, 0.0], [-1.0, 1.0, 0.0], [0.5, -1.0, 0.5]])
_FIRST_HALF = np.array([[1.0, 0.0, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 0.0]])
_LAST_HALF = np.array([[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [0.0, 0.0, 0.0]])
_EDGE = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])


class Surface(Protocol):
    """What can say how far points are from it: a rigid tool, or the surface of a body."""

    def closest(self, points: Array) -> ToolContact:
        """Signed distance, normal and curvature at ``points`` (n, 2)."""


@dataclass(frozen=True)
class Arcs:
    """The arcs of a surface, which depend on the mesh but not on where its particles are.

    Attributes
    ----------
    nodes
        Particles of each arc; shape (a, 3).
    basis
        Their shape functions, coefficients of 1, t, t² in rows; shape (a, 3, 3).
    first, last
        First and last arc of the chain that each belongs to; shape (a,).
    closed
        Whether its chain is closed; shape (a,).
    """

    nodes: IntArray
    basis: Array
    first: IntArray
    last: IntArray
    closed: BoolArray

    @property
    def begins_chain(self) -> BoolArray:
        """Arcs that an open chain begins with; shape (a,)."""
        return ~self.closed & (self.first == np.arange(len(self.first)))

    @property
    def ends_chain(self) -> BoolArray:
        """Arcs that an open chain ends with; shape (a,)."""
        return ~self.closed & (self.last == np.arange(len(self.last)))

    def around(self, middle: IntArray, width: int = _WINDOW) -> IntArray:
        """Arcs up to ``width`` beside each of ``middle`` (k,) along its chain; shape (k, 2 width + 1)."""
        wanted = middle[:, None] + np.arange(-width, width + 1)
        first, last = self.first[middle][:, None], self.last[middle][:, None]
        wrapped = first + (wanted - first) % (last - first + 1)
        return np.where(self.closed[middle][:, None], wrapped, np.clip(wanted, first, last))

    def at(self, arcs: IntArray, t: Array) -> tuple[Array, Array, Array]:
        """Shape functions of ``arcs`` (...) at t (...) and their first and second derivatives; (..., 3) each."""
        constant, linear, square = np.moveaxis(self.basis[arcs], -2, 0)
        t = t[..., None]
        return constant + t * (linear + t * square), linear + 2.0 * t * square, 2.0 * square


@dataclass(frozen=True)
class Foot:
    """Nearest points on a surface.

    Attributes
    ----------
    arc, t
        Arc and coordinate on it; shape (k,).
    gap
        Signed distance, negative inside the body; the distance where the foot is the end of a chain; shape (k,).
    beyond
        Whether the foot is the end of a chain, or where the search ended: no contact there; shape (k,).
    """

    arc: IntArray
    t: Array
    gap: Array
    beyond: BoolArray


def surface_arcs(points: Array, boundary: Boundary, parts: IntArray, smooth: bool = True) -> Arcs:
    """Arcs of the boundary edges with a part number in ``parts``; corners are those at ``points`` (n, 2)."""
    nodes, basis, lengths, closed = [], [], [], []
    for chain, is_closed in _chains(points, boundary, np.isin(boundary.parts, parts)):
        if not smooth:
            ahead = np.roll(chain, -1) if is_closed else chain[1:]
            behind = chain if is_closed else chain[:-1]
            nodes.append(np.column_stack([behind, ahead, ahead]))
            basis.append(np.tile(_EDGE, (len(behind), 1, 1)))
        elif is_closed:
            nodes.append(np.column_stack([np.roll(chain, 1), chain, np.roll(chain, -1)]))
            basis.append(np.tile(SPLINE, (len(chain), 1, 1)))
        else:
            inner = np.column_stack([chain[:-2], chain[1:-1], chain[2:]])
            nodes.append(np.vstack([chain[[0, 1, 1]], inner, chain[[-2, -1, -1]]]))
            basis.append(np.concatenate([[_FIRST_HALF], np.tile(SPLINE, (len(inner), 1, 1)), [_LAST_HALF]]))
        lengths.append(len(nodes[-1]))
        closed.append(is_closed)
    starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    return Arcs(
        np.vstack(nodes).astype(np.int64),
        np.concatenate(basis),
        np.repeat(starts[:-1], lengths),
        np.repeat(starts[1:] - 1, lengths),
        np.repeat(np.array(closed, dtype=bool), lengths),
    )


def _chains(points: Array, boundary: Boundary, chosen: BoolArray) -> list[tuple[IntArray, bool]]:
    """Particles of each run of ``chosen`` (b,) edges between corners, and whether it is a closed loop."""
    following = boundary.following
    along = points[boundary.particles[following]] - points[boundary.particles]
    along = along / np.hypot(*along.T)[:, None]
    turns = np.sum(along * along[boundary.preceding], axis=1) < _SHARP
    begins = chosen & (~chosen[boundary.preceding] | turns)
    chains: list[tuple[IntArray, bool]] = []
    for a, b in zip(boundary.starts[:-1], boundary.starts[1:], strict=True):
        if not begins[a:b].any():
            if chosen[a]:
                chains.append((boundary.particles[a:b], True))
            continue
        for start in a + np.flatnonzero(begins[a:b]):
            entries = [int(start)]
            while chosen[entries[-1]]:
                entries.append(int(following[entries[-1]]))
                if begins[entries[-1]]:
                    break
            chains.append((boundary.particles[entries], False))
    return chains


def feet(arcs: Arcs, points: Array, queries: Array, candidates: IntArray) -> Foot:
    """Nearest point to each of ``queries`` (k, 2) on its ``candidates`` (k, w), a run of neighbouring arcs.

    Newton's method for r . x'(t) = 0 (eq. 21 on a curve), kept on the arc; ``points`` (n, 2) are all particles. A
    single candidate is prolonged by half its length.
    """
    inner = _PROLONGED if candidates.shape[1] == 1 else 0.0
    lowest = np.where(arcs.begins_chain[candidates], -_OVERHANG, -inner)
    highest = np.where(arcs.ends_chain[candidates], 1.0 + _OVERHANG, 1.0 + inner)
    return Foot(*_feet(arcs.nodes, arcs.basis, points, queries, candidates, lowest, highest))


@njit(cache=True)
def _feet(nodes, basis, points, queries, candidates, lowest, highest):  # type: ignore[no-untyped-def]
    count, width = candidates.shape
    arc, t = np.empty(count, dtype=np.int64), np.empty(count)
    gap, beyond = np.empty(count), np.empty(count, dtype=np.bool_)
    c = np.empty((3, 2))  # coefficients of 1, s, s² of the position on an arc
    for k in range(count):
        nearest = np.inf
        for w in range(width):
            candidate = candidates[k, w]
            low, high = lowest[k, w], highest[k, w]
            for i in range(3):
                for x in range(2):
                    c[i, x] = 0.0
                    for a in range(3):
                        c[i, x] += basis[candidate, i, a] * points[nodes[candidate, a], x]
            # The chord from s = 0 to s = 1 gives the start.
            cx, cy = c[1, 0] + c[2, 0], c[1, 1] + c[2, 1]
            rx, ry = queries[k, 0] - c[0, 0], queries[k, 1] - c[0, 1]
            s = min(max((rx * cx + ry * cy) / max(cx * cx + cy * cy, 1e-300), low), high)
            for _ in range(_ITERATIONS):
                rx = queries[k, 0] - (c[0, 0] + s * (c[1, 0] + s * c[2, 0]))
                ry = queries[k, 1] - (c[0, 1] + s * (c[1, 1] + s * c[2, 1]))
                tx, ty = c[1, 0] + 2.0 * s * c[2, 0], c[1, 1] + 2.0 * s * c[2, 1]
                speed = tx * tx + ty * ty
                curve = speed - 2.0 * (rx * c[2, 0] + ry * c[2, 1])
                before = s
                s = min(max(s + (rx * tx + ry * ty) / max(curve, 0.1 * speed, 1e-300), low), high)
                if abs(s - before) < _CONVERGED:
                    break
            rx = queries[k, 0] - (c[0, 0] + s * (c[1, 0] + s * c[2, 0]))
            ry = queries[k, 1] - (c[0, 1] + s * (c[1, 1] + s * c[2, 1]))
            distance = np.hypot(rx, ry)
            if distance < nearest:
                nearest = distance
                tx, ty = c[1, 0] + 2.0 * s * c[2, 0], c[1, 1] + 2.0 * s * c[2, 1]
                speed = tx * tx + ty * ty
                arc[k], t[k] = candidate, s
                # At the end of the run the foot is not where the surface is nearest, unless it lies there by chance.
                ends = (s == low and candidate == candidates[k, 0]) or (
                    s == high and candidate == candidates[k, width - 1]
                )
                beyond[k] = ends and abs(rx * tx + ry * ty) > 1e-9 * speed
                gap[k] = distance if beyond[k] else (rx * ty - ry * tx) / np.sqrt(speed)
    return arc, t, gap, beyond


@dataclass(frozen=True)
class BodySurface:
    """A body's surface at one instant: arcs and the positions of all particles (mm), (n, 2)."""

    arcs: Arcs
    points: Array

    def nearest_arcs(self, queries: Array, width: int = _WINDOW) -> IntArray:
        """Arcs near each of ``queries`` (k, 2), neighbours in a row; shape (k, 2 width + 1)."""
        return self.arcs.around(self._tree.query(queries)[1].astype(np.int64), width)

    def about(self, queries: Array, reach: float) -> BoolArray:
        """Which of ``queries`` (k, 2) may be closer than ``reach`` (mm): all that are, and some more; shape (k,)."""
        ends = self.corners
        longest = float(np.hypot(*(ends[:, 2] - ends[:, 0]).T).max())
        distance: Array = self._tree.query(queries, distance_upper_bound=reach + longest)[0]
        return np.isfinite(distance)

    @cached_property
    def _tree(self) -> cKDTree:
        """Search tree of the middles of the arcs."""
        shape, _, _ = self.arcs.at(np.arange(len(self.arcs.nodes)), np.full(len(self.arcs.nodes), 0.5))
        return cKDTree(np.einsum("aj,aji->ai", shape, self.corners))

    @property
    def corners(self) -> Array:
        """Positions of the arcs' particles (mm); shape (a, 3, 2)."""
        return self.points[self.arcs.nodes]

    def foot(self, queries: Array) -> Foot:
        """Nearest points of the whole surface to ``queries`` (k, 2)."""
        return feet(self.arcs, self.points, queries, self.nearest_arcs(queries))

    def closest(self, points: Array) -> ToolContact:
        """Signed distance, normal and curvature at ``points`` (k, 2), as of a rigid tool."""
        foot = self.foot(points)
        _, slope, bend = self.arcs.at(foot.arc, foot.t)
        corners = self.corners[foot.arc]
        tangent = np.einsum("ka,kai->ki", slope, corners)
        second = np.einsum("ka,kai->ki", bend, corners)
        speed = np.hypot(*tangent.T)
        normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / speed[:, None]
        own = -np.sum(second * normal, axis=1) / speed**2
        return ToolContact(foot.gap, normal, own / (1.0 + own * foot.gap))
