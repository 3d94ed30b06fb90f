"""Temperature at the outer end of the shear band, for comparisons with papers that state it."""

from __future__ import annotations

import math

import numpy as np

from pfemcut.method import Frame
from pfemcut.results.definition import Definition
from pfemcut.results.derived.chip_section import to_rake_frame
from pfemcut.results.derived.contact_length import temperature
from pfemcut.tools.rigid_wedge import RigidWedge

FREE_SURFACE_TEMPERATURE = Definition(
    "free_surface_temperature",
    "Temperature where the shear band meets the free surface",
    "K",
    "Of the boundary element with the largest plastic strain rate between the uncut surface and the chip's free side; "
    "over the frames in the steady window.",
)


def free_surface_temperature(frame: Frame, tool: RigidWedge, depth: float) -> float:
    """Return the temperature (K) of the free surface where the shear band meets it; nan if nothing shears there.

    Among the elements with an edge's worth of particles on the boundary, at least half a depth off the rake face and
    from 0.7 to 3 depths above the lowest point of the tip, the one with the largest plastic strain rate is taken, and
    of it the mean temperature of its boundary particles.
    """
    if frame.cells.shape[0] == 0:
        return math.nan
    on_boundary = np.zeros(len(frame.points), dtype=bool)
    on_boundary[np.concatenate(frame.loops)] = True
    outer = on_boundary[frame.cells].sum(axis=1) >= 2
    centroid = frame.points[frame.cells].mean(axis=1)
    height = centroid[:, 1] - (tool.centre[1] - tool.tip_radius)
    off_rake = to_rake_frame(centroid, tool)[:, 1]
    zone = outer & (height > 0.7 * depth) & (height < 3.0 * depth)
    zone &= (off_rake > 0.5 * depth) & (off_rake < 5.0 * depth)
    rate = np.where(zone, frame.cell_fields["equivalent_plastic_strain_rate"], 0.0)
    if not rate.max() > 0.0:
        return math.nan
    corners = frame.cells[np.argmax(rate)]
    return float(temperature(frame)[corners[on_boundary[corners]]].mean())
