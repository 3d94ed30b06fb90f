"""Values of linear fields at many points of a mesh, found with a grid of buckets."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def bucket_triangles(points, cells):  # type: ignore[no-untyped-def]
    """A uniform grid of about as many buckets as triangles, with the triangles whose bounding box meets each.

    Returns
    -------
    origin, spacing
        Lower corner and bucket size in x and y; both (2,).
    counts
        Number of buckets in x and y; (2,).
    starts, members
        Triangles of bucket (i, j) at ``members[starts[k]:starts[k + 1]]``, k = i + counts[0] j.
    """
    m = len(cells)
    origin, top = points[0].copy(), points[0].copy()
    for i in range(len(points)):
        for k in range(2):
            origin[k] = min(origin[k], points[i, k])
            top[k] = max(top[k], points[i, k])
    extent = np.maximum(top - origin, 1e-300)
    size = np.sqrt(extent[0] * extent[1] / m)
    counts = np.empty(2, dtype=np.int64)
    for k in range(2):
        counts[k] = min(max(int(extent[k] / size), 1), 4096)
    spacing = extent / counts
    low, high = np.empty((m, 2), dtype=np.int64), np.empty((m, 2), dtype=np.int64)
    starts = np.zeros(counts[0] * counts[1] + 1, dtype=np.int64)
    for i in range(m):
        for k in range(2):
            values = points[cells[i], k]
            low[i, k] = min(int((values.min() - origin[k]) / spacing[k]), counts[k] - 1)
            high[i, k] = min(int((values.max() - origin[k]) / spacing[k]), counts[k] - 1)
        for b in range(low[i, 1], high[i, 1] + 1):
            for a in range(low[i, 0], high[i, 0] + 1):
                starts[a + counts[0] * b + 1] += 1
    starts = np.cumsum(starts)
    members = np.empty(starts[-1], dtype=np.int64)
    filled = starts[:-1].copy()
    for i in range(m):
        for b in range(low[i, 1], high[i, 1] + 1):
            for a in range(low[i, 0], high[i, 0] + 1):
                bucket = a + counts[0] * b
                members[filled[bucket]] = i
                filled[bucket] += 1
    return origin, spacing, counts, starts, members


@njit(cache=True)
def interpolate(points, cells, values, queries, overhang):  # type: ignore[no-untyped-def]
    """Linear ``values`` (n, c) of the triangles ``cells`` of ``points`` at ``queries`` (k, 2).

    A query outside of all triangles takes the continued values of a triangle near it, of which it lies outside by at
    most ``overhang`` in barycentric coordinates.

    Returns
    -------
    found
        Values; zero where there is no such triangle; shape (k, c).
    inside
        Whether there is; shape (k,).
    """
    origin, spacing, counts, starts, members = bucket_triangles(points, cells)
    found = np.zeros((len(queries), values.shape[1]))
    inside = np.zeros(len(queries), dtype=np.bool_)
    for q in range(len(queries)):
        x, y = queries[q, 0], queries[q, 1]
        a = min(max(int(np.floor((x - origin[0]) / spacing[0])), 0), counts[0] - 1)
        b = min(max(int(np.floor((y - origin[1]) / spacing[1])), 0), counts[1] - 1)
        bucket = a + counts[0] * b
        best, winner, first, second = -overhang, -1, 0.0, 0.0
        for k in range(starts[bucket], starts[bucket + 1]):
            i = members[k]
            px, py = points[cells[i, 0], 0], points[cells[i, 0], 1]
            ux, uy = points[cells[i, 1], 0] - px, points[cells[i, 1], 1] - py
            vx, vy = points[cells[i, 2], 0] - px, points[cells[i, 2], 1] - py
            double_area = ux * vy - uy * vx
            xi = ((x - px) * vy - (y - py) * vx) / double_area
            eta = (ux * (y - py) - uy * (x - px)) / double_area
            least = min(xi, eta, 1.0 - xi - eta)
            if least > best:
                best, winner, first, second = least, i, xi, eta
                if least >= 0.0:
                    break
        if winner >= 0:
            inside[q] = True
            for c in range(values.shape[1]):
                found[q, c] = (
                    (1.0 - first - second) * values[cells[winner, 0], c]
                    + first * values[cells[winner, 1], c]
                    + second * values[cells[winner, 2], c]
                )
    return found, inside
