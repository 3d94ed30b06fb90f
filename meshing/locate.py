"""Finding points in a triangle mesh by barycentric coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_CHUNK = 4_000_000  # point-triangle pairs tested at once: bounds the memory to some 100 MB


@dataclass(frozen=True)
class Location:
    """Where points lie in a mesh.

    Attributes
    ----------
    cells
        Triangle of each point, the nearest one for points outside; shape (k,).
    barycentric
        Coordinates in it, clipped to the triangle; shape (k, 3).
    outside
        Whether the point lies outside all triangles; shape (k,).
    """

    cells: IntArray
    barycentric: Array
    outside: NDArray[np.bool_]


def locate(points: Array, cells: IntArray, queries: Array, tolerance: float = 1e-9) -> Location:
    """Locate ``queries`` (k, 2) among the triangles ``cells`` (m, 3) of ``points`` (n, 2).

    Every pair is tested, so hand in few queries or few triangles: a remesh changes some tens of triangles, whose
    new Gauss points lie in the triangles that vanished. The triangle with the largest smallest barycentric
    coordinate wins; it is the containing one, or the nearest in that measure.
    """
    a = points[cells[:, 0]]
    u, v = points[cells[:, 1]] - a, points[cells[:, 2]] - a
    inverse_area = 1.0 / (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    best = np.empty(len(queries), dtype=np.int64)
    coordinates = np.empty((len(queries), 3))
    rows = max(1, _CHUNK // max(1, len(cells)))
    for first in range(0, len(queries), rows):
        d = queries[first : first + rows, None, :] - a
        xi = (d[..., 0] * v[:, 1] - d[..., 1] * v[:, 0]) * inverse_area
        eta = (u[:, 0] * d[..., 1] - u[:, 1] * d[..., 0]) * inverse_area
        smallest = np.minimum(np.minimum(xi, eta), 1.0 - xi - eta)
        winner = np.argmax(smallest, axis=1)
        row = np.arange(len(winner))
        best[first : first + rows] = winner
        xi, eta = xi[row, winner], eta[row, winner]
        coordinates[first : first + rows] = np.column_stack([1.0 - xi - eta, xi, eta])
    outside = coordinates.min(axis=1) < -tolerance
    coordinates = np.maximum(coordinates, 0.0)
    coordinates /= coordinates.sum(axis=1, keepdims=True)
    return Location(best, coordinates, outside)
