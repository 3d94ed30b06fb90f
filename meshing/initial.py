"""Initial graded mesh of a polygonal body (gmsh)."""

from __future__ import annotations

import gmsh
import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Boundary, Mesh, signed_areas
from meshing.sizes import SizeField

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def polygon_mesh(corners: Array, sizes: SizeField, parts: IntArray) -> Mesh:
    """Triangulate the polygon ``corners`` (k, 2), counter-clockwise, with spacing ``sizes``.

    Parameters
    ----------
    corners
        Corner positions (mm).
    sizes
        Wished spacing (mm).
    parts
        Part number of the side that starts at each corner; shape (k,).
    """
    gmsh.initialize(["pfemcut", "-v", "1"], readConfigFiles=False)
    try:
        for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.{option}", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay: the most regular triangles
        geometry = gmsh.model.geo
        tags = [geometry.addPoint(float(x), float(y), 0.0) for x, y in corners]
        sides = [geometry.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1], strict=True)]
        geometry.addPlaneSurface([geometry.addCurveLoop(sides)])
        geometry.synchronize()
        # Later gmsh versions hand over one argument more.
        gmsh.model.mesh.setSizeCallback(lambda _d, _t, x, y, *_: float(sizes(np.array([[x, y]]))[0]))
        gmsh.model.mesh.generate(2)
        return _collect(sides, parts)
    finally:
        gmsh.finalize()


def _collect(sides: list[int], parts: IntArray) -> Mesh:
    node_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(node_tags.max()) + 1, dtype=np.int64)
    number[node_tags] = np.arange(len(node_tags))
    points = coordinates.reshape(-1, 3)[:, :2].copy()
    _, triangles = gmsh.model.mesh.getElementsByType(2)
    cells = number[triangles].reshape(-1, 3)
    flipped = signed_areas(points, cells) < 0.0
    cells[flipped] = cells[flipped][:, [0, 2, 1]]

    particles, edge_parts = [], []
    for side, part in zip(sides, parts, strict=True):
        _, lines = gmsh.model.mesh.getElementsByType(1, side)
        starts = number[lines].reshape(-1, 2)[:, 0]  # gmsh lists a line's edges in its direction
        particles.append(starts)
        edge_parts.append(np.full(len(starts), part))
    loop = np.concatenate(particles)
    boundary = Boundary(loop, np.concatenate(edge_parts), np.array([0, len(loop)]))
    used = np.unique(cells)
    if len(used) != len(points):
        raise ValueError("the initial mesh has nodes that belong to no triangle")
    return Mesh(points, cells, boundary, np.arange(len(points)), len(points))
