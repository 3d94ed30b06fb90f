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


class BoundaryCrossing(Exception):
    """Two boundary edges cross or touch: the body overlaps itself."""


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
        If edges cross, or a point is not finite or coincides with another.
    """
    if not np.all(np.isfinite(points)):
        raise BoundaryCrossing("particle positions are not finite")
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
        raise BoundaryCrossing(_where(points, str(error))) from error
    if triangulation.piece_to_originals_count():
        raise BoundaryCrossing("a particle lies on a boundary edge")
    triangulation.erase_outer_triangles_and_holes()
    return triangulation.triangles_array()["vertices"].astype(np.int64)


def _where(points: Array, message: str) -> str:
    """The triangulation library's ``message`` in terms of positions: it names edges by their particles."""
    indices = [int(number) for number in re.findall(r"\d+", message.partition(" in ")[0].partition("\n")[0])]
    named = [index for index in indices if index < len(points)]
    if not named or not message.startswith("Intersecting"):
        return message.partition("\n")[0]
    x, y = points[named].mean(axis=0)
    return f"boundary edges cross near ({x:.4f}, {y:.4f}) mm"
