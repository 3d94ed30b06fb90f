"""Finding points in a triangle mesh by barycentric coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


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
    best, coordinates = _locate(points, cells, queries)
    outside = coordinates.min(axis=1) < -tolerance
    coordinates = np.maximum(coordinates, 0.0)
    coordinates /= coordinates.sum(axis=1, keepdims=True)
    return Location(best, coordinates, outside)


@njit(cache=True)
def _locate(points, cells, queries):  # type: ignore[no-untyped-def]
    """Winning triangle of each query and its barycentric coordinates, not clipped."""
    low, high = _boxes(points, cells)
    best = np.zeros(len(queries), dtype=np.int64)
    coordinates = np.empty((len(queries), 3))
    for q in range(len(queries)):
        x, y = queries[q, 0], queries[q, 1]
        largest = -np.inf
        # Triangles whose box holds the query first; all of them only for a query that lies in none.
        for everywhere in (False, True):
            for i in range(len(cells)):
                if not everywhere and (x < low[i, 0]) | (x > high[i, 0]) | (y < low[i, 1]) | (y > high[i, 1]):
                    continue
                a, b, c = cells[i, 0], cells[i, 1], cells[i, 2]
                ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
                vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
                dx, dy = x - points[a, 0], y - points[a, 1]
                inverse_area = 1.0 / (ux * vy - uy * vx)
                xi = (dx * vy - dy * vx) * inverse_area
                eta = (ux * dy - uy * dx) * inverse_area
                smallest = min(xi, eta, 1.0 - xi - eta)
                if smallest > largest:
                    largest, best[q] = smallest, i
                    coordinates[q, 0], coordinates[q, 1], coordinates[q, 2] = 1.0 - xi - eta, xi, eta
            if largest >= 0.0:
                break
    return best, coordinates


@njit(cache=True)
def _boxes(points, cells):  # type: ignore[no-untyped-def]
    """Bounding boxes of the triangles, a trifle larger than they are."""
    low, high = np.empty((len(cells), 2)), np.empty((len(cells), 2))
    for i in range(len(cells)):
        for axis in range(2):
            a, b, c = points[cells[i, 0], axis], points[cells[i, 1], axis], points[cells[i, 2], axis]
            least, most = min(a, b, c), max(a, b, c)
            margin = 1e-9 * (most - least)
            low[i, axis], high[i, axis] = least - margin, most + margin
    return low, high
