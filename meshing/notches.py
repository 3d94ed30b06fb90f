"""Notches of the boundary that are squeezed shut: their walls grow together before they cross.

A free surface that is compressed forms a crease, whose walls meet near the root, within fewer edges than a search for
contact can tell apart. Where the walls beside the root have all but closed, they become one: the root goes, the
particles beside it merge, and the notch begins there. The enclosed area stays the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.boundary import Outline

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_CLOSED = np.cos(
    np.radians(7.0)
)  # of the angle between the walls; contact begins to hold them apart at 14 degrees
_FEWEST = 12  # entries of a loop that may lose some


def close_notches(outline: Outline, nearest: Array, locked: BoolArray) -> Outline:
    """Close notches whose walls meet at less than 7 degrees, or have crossed.

    Parameters
    ----------
    outline
        Boundary loops, the body on the left.
    nearest
        Distance (mm) below which the particles beside the root may merge, at each entry; shape (b,).
    locked
        Entries that stay; shape (b,).
    """
    loops, points = outline.topology, outline.points
    before, after = loops.preceding, loops.following
    one, other = points[before] - points, points[after] - points
    apart = np.hypot(*(one - other).T)
    size = np.hypot(*one.T) * np.hypot(*other.T)
    loop_size = np.repeat(np.diff(outline.starts), np.diff(outline.starts))
    shut = (np.sum(one * other, axis=1) > _CLOSED * size) & (apart < nearest) & (loop_size > _FEWEST)
    shut &= ~(locked | locked[before] | locked[after])
    shut &= (outline.parts == outline.parts[before]) & (outline.parts == outline.parts[after])
    if not shut.any():
        return outline
    # Of roots that would share particles only the narrowest.
    gap = np.where(shut, apart, np.inf)
    for step in (before, after):
        neighbour = step
        for _ in range(3):
            rival = gap[neighbour]
            shut &= (apart < rival) | ((apart == rival) & (np.arange(len(gap)) < neighbour))
            neighbour = step[neighbour]
    root = np.flatnonzero(shut)
    left, right = before[root], after[root]
    start, end = points[before[left]], points[after[right]]
    chord = end - start
    length = np.hypot(*chord.T)
    normal = np.column_stack([chord[:, 1], -chord[:, 0]]) / length[:, None]
    middle = 0.5 * (points[left] + points[right])
    # One particle in the place of three keeps the area between the chord and the boundary.
    corners = [start, points[left], points[root], points[right], end]
    twice = sum(_cross(a - start, b - start) for a, b in zip(corners[1:], corners[2:], strict=False))
    height = np.sum((middle - start) * normal, axis=1)
    merged = middle + (twice / length - height)[:, None] * normal
    near = np.hypot(*(merged - middle).T) < nearest[root]
    root, left, right, merged = root[near], left[near], right[near], merged[near]

    new, particles = points.copy(), outline.particles.copy()
    new[left] = merged
    particles[left] = -1
    parts = outline.parts.copy()
    parts[left] = outline.parts[right]
    keep = np.ones(len(points), dtype=bool)
    keep[root] = False
    keep[right] = False
    starts = np.concatenate([[0], np.cumsum(keep)])[outline.starts]
    return Outline(new[keep], particles[keep], parts[keep], starts)


def _cross(u: Array, v: Array) -> Array:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
