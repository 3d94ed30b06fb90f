"""Particles on the boundary: short edges collapse, long ones split, and the enclosed area stays the same.

Removal and insertion follow the distance criterion of the paper (section 2.1, Figs. 2 and 3, right); insertion
where the tool stretches the boundary is what makes the cut. Both conserve the area of the body: a collapsed edge
leaves one particle on the line that keeps the area, and what an insertion off the chord gives or takes is
returned by a slight normal shift of free boundary particles nearby.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Boundary, boundary_area

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
PlaceBoundary = Callable[[Array, Array], Array]

_SHARP = np.cos(np.radians(40.0))  # a boundary that turns more than this at a particle has a corner there
_LEVEL = 1e-9  # sine of the turn below which a particle lies on a straight line, to round-off
_RETURN_WIDTH = 6  # free particles on each side over which the area of one insertion is returned


@dataclass(frozen=True)
class Outline:
    """Boundary loops with coordinates, while they are being edited.

    Attributes
    ----------
    points
        Position of each loop entry (mm); shape (b, 2).
    particles
        Old particle index of each entry, -1 for a new particle; shape (b,).
    parts, starts
        As in :class:`meshing.mesh.Boundary`.
    """

    points: Array
    particles: IntArray
    parts: IntArray
    starts: IntArray

    @property
    def topology(self) -> Boundary:
        """The loops, numbered by entry."""
        return Boundary(np.arange(len(self.points)), self.parts, self.starts)

    @property
    def area(self) -> float:
        """Enclosed area (mm²)."""
        return boundary_area(self.points, self.topology)


def corners(outline: Outline) -> BoolArray:
    """Entries at which the boundary turns sharply or changes its part; shape (b,)."""
    loops = outline.topology
    backward = outline.points - outline.points[loops.preceding]
    forward = outline.points[loops.following] - outline.points
    cosine = np.sum(backward * forward, axis=1)
    lengths = np.hypot(*backward.T) * np.hypot(*forward.T)
    return (cosine < _SHARP * lengths) | (outline.parts != outline.parts[loops.preceding])


def collapse_short_edges(outline: Outline, shortest: Array, locked: BoolArray) -> Outline:
    """Replace both ends of edges shorter than ``shortest`` (b,) by one particle that keeps the area.

    With the edge's neighbours a and d, the new particle lies on the parallel to a-d at the distance that keeps
    the area of the polygon, abreast of the edge's middle. ``locked`` entries and corners stay: an edge between one of
    them and a particle on a straight line goes with that particle.
    """
    loops = outline.topology
    following, points = loops.following, outline.points
    ends = points[following]
    length = np.hypot(*(ends - points).T)
    fixed = locked | corners(outline)
    straight = ~fixed & _straight(outline)
    one_stays = (fixed & straight[following]) | (fixed[following] & straight)
    # Edges that may not go don't compete with those that may.
    kept = (fixed | fixed[following]) & ~one_stays
    ratio = np.where(kept, np.inf, length / np.maximum(shortest, 1e-300))
    # Only the shortest of five consecutive edges may go, so that no two collapses share a particle.
    forward1, forward2 = ratio[following], ratio[following[following]]
    backward1, backward2 = ratio[loops.preceding], ratio[loops.preceding[loops.preceding]]
    smallest = (ratio < forward1) & (ratio < forward2) & (ratio <= backward1) & (ratio <= backward2)
    loop_size = np.repeat(np.diff(outline.starts), np.diff(outline.starts))
    go = (ratio < 1.0) & smallest & (loop_size > 6)
    if not go.any():
        return outline

    b = np.flatnonzero(go & one_stays)
    dropped = np.where(fixed[b], following[b], b)
    b = np.flatnonzero(go & ~one_stays)
    c = following[b]
    a, d = points[loops.preceding[b]], points[following[c]]
    chord = d - a
    chord_length = np.hypot(*chord.T)
    along = chord / chord_length[:, None]
    normal = np.column_stack([along[:, 1], -along[:, 0]])
    pb, pc = points[b] - a, points[c] - a
    twice_area = _cross(pb, pc) + _cross(pc, chord)
    middle = 0.5 * (pb + pc)
    merged = a + np.sum(middle * along, axis=1)[:, None] * along
    merged += (twice_area / chord_length)[:, None] * normal
    # Where the boundary folds on itself the parallel can lie far away: leave such edges alone.
    near = np.hypot(*(merged - a - middle).T) < 0.5 * shortest[b]
    b, c, merged = b[near], c[near], merged[near]

    new_points, particles = points.copy(), outline.particles.copy()
    new_points[b] = merged
    particles[b] = -1
    keep = np.ones(len(points), dtype=bool)
    keep[c] = False
    keep[dropped] = False
    # The merged particle starts the edge that c started.
    parts = outline.parts.copy()
    parts[b] = outline.parts[c]
    return Outline(new_points[keep], particles[keep], parts[keep], _starts_after(keep, outline.starts))


def split_long_edges(outline: Outline, longest: Array, place: PlaceBoundary, free: BoolArray) -> Outline:
    """Split edges longer than ``longest`` (b,); ``place`` puts the new particles on the surface.

    Parameters
    ----------
    place
        Called once with the ends (k, 2) and (k, 2) of all edges that split; returns the new positions (k, 2).
    free
        Entries that may shift along their normal to give back the area, none near a tool or a support; shape (b,).
    """
    following = outline.topology.following
    ends = outline.points[following]
    split = np.flatnonzero(np.hypot(*(ends - outline.points).T) > longest)
    if len(split) == 0:
        return outline
    a, b = outline.points[split], ends[split]
    new = place(a, b)
    gained = 0.5 * _cross(new - a, b - a)
    amplitude, normal = _return_area(outline, split, -gained, free)
    shift = amplitude[:, None] * normal
    grown = Outline(
        np.insert(outline.points + shift, split + 1, new, axis=0),
        np.insert(outline.particles, split + 1, -1),
        np.insert(outline.parts, split + 1, outline.parts[split]),
        outline.starts + np.searchsorted(split, outline.starts),
    )
    # What is left of second order is given back one way, so that returns of opposite sign don't cancel.
    direction = np.insert(np.abs(amplitude)[:, None] * normal, split + 1, 0.0, axis=0)
    return _restore_area(grown, direction, outline.area)


def _return_area(outline: Outline, edges: IntArray, deficit: Array, free: BoolArray) -> tuple[Array, Array]:
    """Shifts (b,) of free entries near ``edges`` along the normals (b, 2) that enclose ``deficit`` (mm²) more."""
    loops = outline.topology
    tangent = outline.points[loops.following] - outline.points[loops.preceding]
    weight_length = 0.5 * np.hypot(*tangent.T)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / (2.0 * weight_length)[:, None]
    shift = np.zeros(len(free))
    movable = np.flatnonzero(free & ~corners(outline))
    if len(movable) < 2:
        movable = np.flatnonzero(free)
    width = min(_RETURN_WIDTH, len(movable) // 2)
    if width == 0:
        return shift, normal
    first = np.searchsorted(movable, edges, side="right")
    window = np.arange(-width, width)
    neighbours = movable[(first[:, None] + window) % len(movable)]
    bump = np.cos(0.5 * np.pi * (window + 0.5) / (width + 0.5)) ** 2
    amplitude = deficit / np.sum(bump * weight_length[neighbours], axis=1)
    np.add.at(shift, neighbours, amplitude[:, None] * bump)
    return shift, normal


def _restore_area(outline: Outline, direction: Array, area: float) -> Outline:
    """Shift the entries along ``direction`` (b, 2) so far that the enclosed area is ``area`` exactly."""
    if not direction.any():
        return outline
    following = outline.topology.following
    points = outline.points
    for _ in range(3):  # the area is quadratic in the scale and nearly linear: Newton converges at once
        missing = area - Outline(points, outline.particles, outline.parts, outline.starts).area
        slope = 0.5 * float(
            np.sum(_cross(direction, points[following]) + _cross(points, direction[following]))
        )
        if slope == 0.0:
            break
        points = points + (missing / slope) * direction
    return Outline(points, outline.particles, outline.parts, outline.starts)


def _straight(outline: Outline) -> BoolArray:
    """Entries at which the boundary does not turn; shape (b,)."""
    loops = outline.topology
    backward = outline.points - outline.points[loops.preceding]
    forward = outline.points[loops.following] - outline.points
    return np.abs(_cross(backward, forward)) <= _LEVEL * np.hypot(*backward.T) * np.hypot(*forward.T)


def _starts_after(keep: BoolArray, starts: IntArray) -> IntArray:
    """First entries of the loops after dropping entries that are not kept."""
    return np.concatenate([[0], np.cumsum(keep)])[starts]


def _cross(u: Array, v: Array) -> Array:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
