"""How the triangles of one mesh overlap those of another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Overlap:
    """Pieces in which triangles of two sets overlap.

    Attributes
    ----------
    new, old
        The two triangles of each piece; shape (k,).
    area
        mm²; shape (k,).
    centroid
        mm; shape (k, 2).
    """

    new: IntArray
    old: IntArray
    area: Array
    centroid: Array


def overlap(new: Array, old: Array) -> Overlap:
    """Pieces common to the counter-clockwise triangles ``new`` (i, 3, 2) and ``old`` (j, 3, 2).

    Every pair is tested, so hand in few: the elements that a remesh changed and those that vanished.
    """
    i, j = _near_pairs(new, old)
    polygon = new[i]
    for side in range(3):
        polygon = _clip(polygon, old[j, side], old[j, (side + 1) % 3])
    # Relative to a corner, so that products do not cancel digits.
    origin = polygon[:, :1]
    p = polygon - origin
    q = np.roll(p, -1, axis=1)
    cross = p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]
    area = 0.5 * cross.sum(axis=1)
    real = area > 0.0
    moment = ((p + q) * cross[..., None]).sum(axis=1)[real] / 6.0
    centroid = origin[real, 0] + moment / area[real, None]
    return Overlap(i[real], j[real], area[real], centroid)


def _near_pairs(new: Array, old: Array) -> tuple[IntArray, IntArray]:
    """Pairs whose bounding boxes overlap."""
    boxes = new.min(axis=1), new.max(axis=1), old.min(axis=1), old.max(axis=1)
    first = np.concatenate([[0], np.cumsum(_count_near(*boxes))])
    return _fill_near(*boxes, first)


@njit(cache=True)
def _count_near(low, high, old_low, old_high):  # type: ignore[no-untyped-def]
    """How many old boxes each new box overlaps."""
    count = np.zeros(len(low), dtype=np.int64)
    for i in range(len(low)):
        for j in range(len(old_low)):
            count[i] += (
                (low[i, 0] < old_high[j, 0])
                & (high[i, 0] > old_low[j, 0])
                & (low[i, 1] < old_high[j, 1])
                & (high[i, 1] > old_low[j, 1])
            )
    return count


@njit(cache=True)
def _fill_near(low, high, old_low, old_high, first):  # type: ignore[no-untyped-def]
    """The overlapping pairs; those of new box i stand at first[i] to first[i + 1]."""
    new, old = np.empty(first[-1], dtype=np.int64), np.empty(first[-1], dtype=np.int64)
    for i in range(len(low)):
        at = first[i]
        for j in range(len(old_low)):
            if at == first[i + 1]:
                break
            if (
                (low[i, 0] < old_high[j, 0])
                & (high[i, 0] > old_low[j, 0])
                & (low[i, 1] < old_high[j, 1])
                & (high[i, 1] > old_low[j, 1])
            ):
                new[at], old[at] = i, j
                at += 1
    return new, old


def _clip(polygon: Array, start: Array, end: Array) -> Array:
    """The parts of convex polygons (k, v, 2) left of the lines through ``start`` and ``end`` (k, 2); (k, v + 1, 2).

    Polygons with fewer corners repeat one of them; what is empty becomes a point.
    """
    along = (end - start)[:, None]
    offset = polygon - start[:, None]
    height = along[..., 0] * offset[..., 1] - along[..., 1] * offset[..., 0]
    following, next_height = np.roll(polygon, -1, axis=1), np.roll(height, -1, axis=1)
    inside, next_inside = height >= 0.0, next_height >= 0.0
    crosses = inside != next_inside
    fraction = height / np.where(crosses, height - next_height, 1.0)
    crossing = polygon + fraction[..., None] * (following - polygon)
    # Each corner, then the crossing on the edge that it starts; the wanted ones move to the front.
    count, corners = height.shape
    points = np.stack([polygon, crossing], axis=2).reshape(count, 2 * corners, 2)
    wanted = np.stack([inside, crosses], axis=2).reshape(count, 2 * corners)
    order = np.argsort(~wanted, axis=1, kind="stable")[:, : corners + 1]
    slot = np.minimum(np.arange(corners + 1), np.maximum(wanted.sum(axis=1)[:, None] - 1, 0))
    order = np.take_along_axis(order, slot, axis=1)
    return np.take_along_axis(points, order[..., None], axis=1)
