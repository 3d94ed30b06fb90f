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
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_CLOSED = np.cos(
    np.radians(7.0)
)  # of the angle between the walls; contact begins to hold them apart at 14 degrees
_APART = 4  # entries from one root to the next
_FEWEST = 12  # entries of a loop that may lose some


def close_notches(outline: Outline, nearest: Array, locked: BoolArray) -> Outline:
    """Close notches whose walls meet at less than 7 degrees, or have crossed.

    Parameters
    ----------
    outline
        Boundary loops, the body on the left.
    nearest
        Distance (mm) below which the particles beside the root merge, at each entry; shape (b,). Where the walls'
        edges differ more in length, the shorter one's end joins the other wall.
    locked
        Entries that stay; shape (b,).
    """
    root = _shut_roots(outline, locked)
    if not root.size:
        return outline
    loops, points = outline.topology, outline.points
    left, right = loops.preceding[root], loops.following[root]
    merging = np.hypot(*(points[left] - points[right]).T) < nearest[root]
    nearer = np.hypot(*(points[left] - points[root]).T) < np.hypot(*(points[right] - points[root]).T)
    # One particle, near ``middle`` between ``start`` and ``end``, stands for all between them.
    moved = np.where(merging | nearer, left, right)
    start = points[np.where(merging | nearer, loops.preceding[left], left)]
    end = points[np.where(merging | ~nearer, loops.following[right], right)]
    middle = np.where(merging[:, None], 0.5 * (points[left] + points[right]), points[moved])
    chord = end - start
    length = np.hypot(*chord.T)
    normal = np.column_stack([chord[:, 1], -chord[:, 0]]) / length[:, None]
    # It keeps the area between the chord and the boundary; corners that coincide add nothing.
    first = np.where((merging | nearer)[:, None], points[left], start)
    last = np.where((merging | ~nearer)[:, None], points[right], end)
    corners = [first, points[root], last, end]
    twice = sum(_cross(a - start, b - start) for a, b in zip(corners, corners[1:], strict=False))
    height = np.sum((middle - start) * normal, axis=1)
    new = middle + (twice / length - height)[:, None] * normal
    near = np.hypot(*(new - middle).T) < nearest[root]
    root, right, moved, new, merging = (each[near] for each in (root, right, moved, new, merging))

    positions, particles = points.copy(), outline.particles.copy()
    positions[moved] = new
    particles[moved] = -1
    keep = np.ones(len(points), dtype=bool)
    keep[root] = False
    keep[right[merging]] = False
    starts = np.concatenate([[0], np.cumsum(keep)])[outline.starts]
    return Outline(positions[keep], particles[keep], outline.parts[keep], starts)


def _shut_roots(outline: Outline, locked: BoolArray) -> IntArray:
    """Entries at the root of a notch to close, no two near each other: of rivals the one with the narrowest notch."""
    loops, points = outline.topology, outline.points
    before, after = loops.preceding, loops.following
    one, other = points[before] - points, points[after] - points
    cosine = np.sum(one * other, axis=1) / (np.hypot(*one.T) * np.hypot(*other.T))
    loop_size = np.repeat(np.diff(outline.starts), np.diff(outline.starts))
    shut = (cosine > _CLOSED) & (loop_size > _FEWEST)
    shut &= ~(locked | locked[before] | locked[after])
    # All that meet belong to one part: the merged particle then starts what either would have.
    for entry in (before, before[before], after):
        shut &= outline.parts == outline.parts[entry]
    openness = np.where(shut, 1.0 - cosine, np.inf)
    number = np.arange(len(openness))
    for step in (before, after):
        rival = step
        for _ in range(_APART):
            shut &= (openness < openness[rival]) | ((openness == openness[rival]) & (number < rival))
            rival = step[rival]
    return np.flatnonzero(shut)


def _cross(u: Array, v: Array) -> Array:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
