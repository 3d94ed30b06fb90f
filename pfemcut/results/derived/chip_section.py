"""The part of the chip behind its contact with the tool: where thickness, speed and curl are measured.

Stations lie on the chip's rake side, at equal distances along this surface, between one depth of cut and ``reach``
depths beyond the end of contact. The chip's direction at a station is that of the chord over a quarter depth to each
side, which is exact for a straight and for a circular chip; normal to it a ray leaves the chip at its free side.
Points are written in the rake frame: origin in the rake tangent point, first coordinate s up the rake face, second
n away from it into the chip.

The surface of particles without a mesh lies outside of the outermost ones, by the frame's ``surface_offset``: both
sides are measured there.

The end of the chip, which was the workpiece's end face, isn't chip as the definitions mean it: stations closer to it
than one depth are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.results.derived.rays import first_crossing, loop_edges
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

STATIONS = 32
FEWEST = 8
HALF_CHORD = 0.25
"""Half the chord that gives the chip's direction, in depths."""
THICKEST = 4.0
"""Thickness beyond which it is not the chip that a ray crosses, in depths."""


@dataclass(frozen=True)
class ChipSection:
    """Stations along the chip.

    Attributes
    ----------
    rake_side, free_side
        Points on the two surfaces of the chip in the rake frame (mm); shape (k, 2); k = 0 if the chip is too short.
    direction
        Unit vector along the chip at each station, in the rake frame; shape (k, 2).
    velocity
        Mean velocity of the two surfaces (mm/s), in the rake frame; shape (k, 2).
    complete
        Whether the chip is long enough for all stations.
    """

    rake_side: Array
    free_side: Array
    direction: Array
    velocity: Array
    complete: bool

    @property
    def thickness(self) -> Array:
        """Local thickness (mm), normal to the chip's rake side; shape (k,)."""
        return np.hypot(*(self.free_side - self.rake_side).T)


_NOTHING = ChipSection(np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 2)), False)


def to_rake_frame(points: Array, tool: RigidWedge) -> Array:
    """Return ``points`` (n, 2) in the rake frame: along the rake face, and away from it."""
    offset = points - tool.rake_tangent_point
    return np.column_stack([offset @ tool.rake_direction, offset @ tool.rake_normal])


def chip_section(frame: Frame, tool: RigidWedge, depth: float, reach: float = 2.0) -> ChipSection:
    """Measure the chip from 1 to ``reach`` depths of cut beyond the end of contact.

    Parameters
    ----------
    frame
        The instant.
    tool
        The tool at that instant.
    depth
        Uncut chip thickness (mm).
    reach
        Far end of the stations, in depths beyond the end of contact.
    """
    surface = _surface_beyond_contact(frame)
    if surface.size < FEWEST:
        return _NOTHING
    points = to_rake_frame(frame.points, tool)
    line = points[surface]
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    stations = depth * (1.0 + (reach - 1.0) * (np.arange(STATIONS) + 0.5) / STATIONS)

    rake_side = _along(arc, line, stations)
    chord = _along(arc, line, stations + HALF_CHORD * depth) - _along(
        arc, line, stations - HALF_CHORD * depth
    )
    direction = chord / np.maximum(np.hypot(*chord.T), 1e-300)[:, None]
    normal = np.column_stack([-direction[:, 1], direction[:, 0]])
    edges = loop_edges([surface])
    # The ray begins inside the chip, so that it doesn't leave through the roughness of the rake side.
    inside = 0.2 * depth
    crossing, crossed = first_crossing(
        rake_side + inside * normal, normal, points[edges[:, 0]], points[edges[:, 1]], outward=True
    )
    distance = inside + crossing
    free_side = rake_side + np.where(np.isfinite(distance), distance, 0.0)[:, None] * normal
    # Not the nearest particle of all: where the chip touches the workpiece, that may be one of the workpiece.
    ends = np.column_stack([crossed, (crossed + 1) % len(surface)])
    apart = np.hypot(*(line[ends] - free_side[:, None, :]).transpose(2, 0, 1))
    nearest = ends[np.arange(len(ends)), np.argmin(apart, axis=1)]
    # From a station round the chip's end to the free side abreast: twice the way to the end, and the end face.
    way_round = arc[nearest] - stations
    valid = (distance < THICKEST * depth) & (way_round > 2.0 * depth + distance)
    if np.count_nonzero(valid) < FEWEST:
        return _NOTHING
    velocity = np.asarray(frame.point_fields["velocity"], dtype=np.float64)[surface]
    velocity = np.column_stack([velocity @ tool.rake_direction, velocity @ tool.rake_normal])
    beyond = frame.surface_offset * normal
    return ChipSection(
        (rake_side - beyond)[valid],
        (free_side + beyond)[valid],
        direction[valid],
        0.5 * (_along(arc, velocity, stations) + velocity[nearest])[valid],
        np.count_nonzero(valid) == STATIONS,
    )


def _surface_beyond_contact(frame: Frame) -> IntArray:
    """Boundary particles from the last loaded one on the rake face onwards, up the chip and round its end."""
    contact = frame.contact
    loaded = np.flatnonzero((contact.pressure > 0.0) & (contact.arc_length > 0.0))
    if loaded.size == 0:
        return np.empty(0, dtype=np.int64)
    last = contact.particles[loaded[np.argmax(contact.arc_length[loaded])]]
    for loop in frame.loops:
        at = np.flatnonzero(loop == last)
        if at.size:
            return np.roll(loop, -int(at[0]))
    return np.empty(0, dtype=np.int64)


def _along(arc: Array, line: Array, at: Array) -> Array:
    """Points on the polyline ``line`` (b, 2) at distances ``at`` (k,) from its start."""
    return np.column_stack([np.interp(at, arc, line[:, 0]), np.interp(at, arc, line[:, 1])])
