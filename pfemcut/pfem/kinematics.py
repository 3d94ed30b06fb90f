"""Gradients and averages on linear triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import signed_areas

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def shape_gradients(points: Array, cells: IntArray) -> Array:
    """Gradients of the three linear shape functions of each triangle (1/mm); shape (m, 3, 2)."""
    x = points[cells]
    edge = np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1)  # edge opposite to each vertex
    gradient = np.stack([-edge[..., 1], edge[..., 0]], axis=2)
    return gradient / (2.0 * signed_areas(points, cells))[:, None, None]


def deformation_gradient(gradients: Array, cells: IntArray, displacement: Array) -> Array:
    """Relative deformation gradient f = 1 + grad u of ``displacement`` (n, 2); shape (m, 2, 2)."""
    f = np.einsum("mai,maj->mij", displacement[cells], gradients)
    f[:, 0, 0] += 1.0
    f[:, 1, 1] += 1.0
    return f


def element_mean(values: Array, cells: IntArray) -> Array:
    """Value at the Gauss points of a field on particles (n, ...); shape (m, ...)."""
    return values[cells].mean(axis=1)


def lumped(values: Array, cells: IntArray, count: int) -> Array:
    """A third of each element's ``values`` (m,) given to each of its particles, summed; shape (count,)."""
    total = np.bincount(cells.ravel(), np.repeat(values / 3.0, 3), minlength=count)
    return total.astype(np.float64, copy=False)


def nodal_average(values: Array, weights: Array, cells: IntArray, count: int) -> Array:
    """Average of element ``values`` (m,) around each particle, weighted by ``weights`` (m,); shape (count,)."""
    return lumped(values * weights, cells, count) / np.maximum(lumped(weights, cells, count), 1e-300)


def tributary_lengths(points: Array, edges: IntArray, count: int) -> Array:
    """Half the lengths (mm) of the boundary ``edges`` (b, 2) that meet in each particle; shape (count,)."""
    half = 0.5 * np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
    length = np.bincount(edges.ravel(), np.repeat(half, 2), minlength=count)
    return length.astype(np.float64, copy=False)
