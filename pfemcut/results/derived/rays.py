"""Intersection of rays with boundary loops, all rays against all edges at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def loop_edges(loops: Sequence[IntArray]) -> IntArray:
    """Return the edges of closed loops as pairs of point indices; shape (e, 2)."""
    if not loops:
        return np.empty((0, 2), dtype=np.int64)
    return np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])


def first_crossing(
    origins: Array, directions: Array, starts: Array, ends: Array, *, outward: bool
) -> tuple[Array, IntArray]:
    """Return the distance along each ray to the first edge that it crosses in the wished sense, and that edge.

    The body lies on the left of an edge, so a ray enters it where it crosses an edge from right to left.

    Parameters
    ----------
    origins, directions
        Rays: points and unit vectors; shape (r, 2).
    starts, ends
        Edges; shape (e, 2).
    outward
        Whether to look for crossings that leave the body, or for those that enter it.

    Returns
    -------
    Distances, inf where the ray crosses no such edge, and edges, arbitrary there; both (r,).
    """
    edge = ends - starts
    # origin + t direction = start + u edge, by Cramer's rule; shape (r, e).
    to_start = starts[None, :, :] - origins[:, None, :]
    turn = _cross(directions[:, None, :], edge[None, :, :])
    # The cross product of direction and edge is positive where the ray goes out across the edge.
    wished = turn > 0.0 if outward else turn < 0.0
    safe = np.where(turn == 0.0, 1.0, turn)
    t = _cross(to_start, edge[None, :, :]) / safe
    u = _cross(to_start, directions[:, None, :]) / safe
    # Half-open, so that a ray through a shared end point meets one edge, not two or none.
    hit = wished & (u >= 0.0) & (u < 1.0) & (t > 0.0)
    distance = np.where(hit, t, np.inf)
    edge_hit = np.argmin(distance, axis=1)
    return distance[np.arange(len(distance)), edge_hit], edge_hit


def _cross(a: Array, b: Array) -> Array:
    """Return the z component of the cross product."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
