"""Constrained Delaunay triangulation of particles inside boundary loops.

The robust predicates and the triangulation are those of the library CDT (through ``pythoncdt``).
"""

from __future__ import annotations

import re
from typing import Any, cast

import numpy as np
import pythoncdt as cdt
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


# Boundary edges closer than this along their loop cross because the boundary folds, not by contact.
_FOLD = 4


class TriangulationFailed(Exception):
    """Points that can't be triangulated: not finite, coincident, on a boundary edge, or a boundary that folds."""


class BoundaryCrossing(Exception):
    """Two parts of the boundary far from each other cross or touch: the body touches itself."""


def constrained_delaunay(points: Array, edges: IntArray) -> IntArray:
    """Triangulate ``points`` (n, 2) so that ``edges`` (b, 2) are preserved exactly; keep triangles inside.

    Returns
    -------
    cells
        Counter-clockwise triangles inside the closed loops formed by ``edges``; shape (m, 3). Particles
        outside the loops appear in none.

    Raises
    ------
    BoundaryCrossing
        If edges that are far apart along their loop cross.
    TriangulationFailed
        If neighbouring edges cross, or a point is not finite, coincides with another or lies on an edge.
    """
    if not np.all(np.isfinite(points)):
        raise TriangulationFailed("particle positions are not finite")
    triangulation = cdt.Triangulation(
        cdt.VertexInsertionOrder.AUTO, cdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
    )
    try:
        # numpy 1's annotations don't say that an array is a buffer.
        triangulation.insert_vertices(cast(Any, np.ascontiguousarray(points, dtype=np.float64)))
        triangulation.insert_edges(cast(Any, np.ascontiguousarray(edges, dtype=np.uint32)))
    except RuntimeError as error:
        if type(error) is not RuntimeError:  # NotImplementedError and the like are no geometry
            raise
        raise _explained(points, edges, str(error)) from error
    if triangulation.piece_to_originals_count():
        raise TriangulationFailed("a particle lies on a boundary edge")
    triangulation.erase_outer_triangles_and_holes()
    return triangulation.triangles_array()["vertices"].astype(np.int64)


def _explained(points: Array, edges: IntArray, message: str) -> Exception:
    """The triangulation library's ``message`` in terms of positions: it names edges by their particles."""
    line = message.partition("\n")[0]
    pairs = re.findall(r"\((\d+), (\d+)\)", line)
    if not line.startswith("Intersecting") or len(pairs) != 2:
        return TriangulationFailed(line)
    (a, b), (c, d) = (tuple(map(int, pair)) for pair in pairs)
    x, y = points[[a, b, c, d]].mean(axis=0)
    where = f"boundary edges cross near ({x:.4f}, {y:.4f}) mm"
    first = np.flatnonzero(np.isin(edges[:, 0], (a, b)))
    second = np.flatnonzero(np.isin(edges[:, 0], (c, d)))
    apart = np.abs(first[:, None] - second)
    if np.minimum(apart, len(edges) - apart).min(initial=_FOLD) < _FOLD:
        return TriangulationFailed(f"{where}: the boundary folds")
    return BoundaryCrossing(where)
