"""The part of the chip behind its contact with the tool: where chip thickness and curl are measured.

Points are written in the rake frame: origin in the rake tangent point, first coordinate s up the rake face, second
n away from it into the chip. Stations lie at equal s between one depth of cut and ``reach`` depths beyond
the end of contact. A ray along n from inside the tool meets the chip's rake side at each station. A quadratic
fitted to these points gives the chip's own normal, which differs from the rake's where the chip curls away;
a ray along that normal leaves the chip at its free side.

The end of the chip, which was the workpiece's end face, isn't chip as the definitions mean it: stations closer to it
than one depth are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.results.derived.contact_length import contact_length
from pfemcut.results.derived.rays import first_crossing, loop_edges
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]

STATIONS = 32
FEWEST = 8


@dataclass(frozen=True)
class ChipSection:
    """Stations along the chip.

    Attributes
    ----------
    rake_side, free_side
        Points on the two surfaces of the chip in the rake frame (mm); shape (k, 2); k = 0 if the chip is too short.
    complete
        Whether the chip is long enough for all stations.
    """

    rake_side: Array
    free_side: Array
    complete: bool

    @property
    def thickness(self) -> Array:
        """Local thickness (mm), normal to the chip's rake side; shape (k,)."""
        return np.hypot(*(self.free_side - self.rake_side).T)


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
    nothing = ChipSection(np.empty((0, 2)), np.empty((0, 2)), False)
    edges = loop_edges(frame.loops)
    if edges.shape[0] == 0:
        return nothing
    points = to_rake_frame(frame.points, tool)
    starts, ends = points[edges[:, 0]], points[edges[:, 1]]
    end = contact_length(frame.contact)
    near, far = end + depth, end + reach * depth
    # The rest of the workpiece lies far ahead of the rake face: it may not pass for the end of the chip.
    by_the_rake = np.abs(starts[:, 1]) < 4.0 * depth
    tip = starts[by_the_rake, 0].max(initial=-np.inf)
    all_stations = near + (far - near) * (np.arange(STATIONS) + 0.5) / STATIONS
    stations = all_stations[all_stations <= tip - depth]
    if stations.size < FEWEST:
        return nothing

    start = -0.5 * depth
    origins = np.column_stack([stations, np.full(stations.size, start)])
    across = np.broadcast_to([0.0, 1.0], origins.shape)
    entry = start + first_crossing(origins, across, starts, ends, outward=False)
    found = entry < 4.0 * depth
    if np.count_nonzero(found) < FEWEST:
        return nothing
    rake_side = np.column_stack([stations[found], entry[found]])

    middle = rake_side[:, 0].mean()
    quadratic = np.polyfit(rake_side[:, 0] - middle, rake_side[:, 1], 2)
    slope = np.polyval(np.polyder(quadratic), rake_side[:, 0] - middle)
    normal = np.column_stack([-slope, np.ones_like(slope)]) / np.hypot(1.0, slope)[:, None]
    # The ray begins inside the chip, so that it doesn't leave through the roughness of the rake side.
    inside = 0.2 * depth
    distance = inside + first_crossing(rake_side + inside * normal, normal, starts, ends, outward=True)
    whole = np.isfinite(distance)
    if np.count_nonzero(whole) < FEWEST:
        return nothing
    free_side = rake_side[whole] + distance[whole, None] * normal[whole]
    return ChipSection(rake_side[whole], free_side, np.count_nonzero(whole) == STATIONS)
