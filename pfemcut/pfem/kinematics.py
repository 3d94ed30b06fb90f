"""Gradients and averages on linear triangles."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@njit(cache=True)
def shape_gradients(points, cells):  # type: ignore[no-untyped-def]
    """Gradients of the three linear shape functions of each triangle (1/mm); shape (m, 3, 2)."""
    gradients = np.empty((len(cells), 3, 2))
    for i in range(len(cells)):
        a, b, c = points[cells[i, 0]], points[cells[i, 1]], points[cells[i, 2]]
        double_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        # Each is perpendicular to the edge opposite to its vertex.
        gradients[i, 0, 0], gradients[i, 0, 1] = (b[1] - c[1]) / double_area, (c[0] - b[0]) / double_area
        gradients[i, 1, 0], gradients[i, 1, 1] = (c[1] - a[1]) / double_area, (a[0] - c[0]) / double_area
        gradients[i, 2, 0], gradients[i, 2, 1] = (a[1] - b[1]) / double_area, (b[0] - a[0]) / double_area
    return gradients


@njit(cache=True)
def deformation_gradient(gradients, cells, displacement):  # type: ignore[no-untyped-def]
    """Relative deformation gradient f = 1 + grad u of ``displacement`` (n, 2); shape (m, 2, 2)."""
    f = np.empty((len(cells), 2, 2))
    for i in range(len(cells)):
        for j in range(2):
            for k in range(2):
                total = 1.0 if j == k else 0.0
                for a in range(3):
                    total += displacement[cells[i, a], j] * gradients[i, a, k]
                f[i, j, k] = total
    return f


def element_mean(values: Array, cells: IntArray) -> Array:
    """Value at the Gauss points of a field on particles (n, ...); shape (m, ...)."""
    mean: Array = (values[cells[:, 0]] + values[cells[:, 1]] + values[cells[:, 2]]) / 3.0
    return mean


@njit(cache=True)
def lumped(values, cells, count):  # type: ignore[no-untyped-def]
    """A third of each element's ``values`` (m,) given to each of its particles, summed; shape (count,)."""
    total = np.zeros(count)
    for i in range(len(cells)):
        for a in range(3):
            total[cells[i, a]] += values[i] / 3.0
    return total


def nodal_average(values: Array, weights: Array, cells: IntArray, count: int) -> Array:
    """Average of element ``values`` (m,) around each particle, weighted by ``weights`` (m,); shape (count,)."""
    return lumped(values * weights, cells, count) / np.maximum(lumped(weights, cells, count), 1e-300)


def tributary_lengths(points: Array, edges: IntArray, count: int) -> Array:
    """Half the lengths (mm) of the boundary ``edges`` (b, 2) that meet in each particle; shape (count,)."""
    half = 0.5 * np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
    length = np.bincount(edges.ravel(), np.repeat(half, 2), minlength=count)
    return length.astype(np.float64, copy=False)
