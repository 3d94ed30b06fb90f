"""Shear angle (degrees), by the chip ratio and by the band of high strain rate (docs/pictures/shear_angle.png)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.results.derived.chip_section import to_rake_frame
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]

LEVELS = 12
PASSES = 3


def shear_angle_of_ratio(depth: float, thickness: float, rake: float) -> float:
    """Return the shear angle of the chip ratio: atan(r cos γ / (1 − r sin γ)), r = depth / thickness.

    Parameters
    ----------
    depth, thickness
        Uncut and cut chip thickness (mm).
    rake
        Rake angle γ (degrees).
    """
    if not thickness > 0.0:
        return math.nan
    ratio, gamma = depth / thickness, math.radians(rake)
    return math.degrees(math.atan2(ratio * math.cos(gamma), 1.0 - ratio * math.sin(gamma)))


def shear_angle_of_band(frame: Frame, tool: RigidWedge, depth: float) -> float:
    """Return the angle between the cutting direction and a line fitted to the ridge of the strain rate.

    The primary zone is cut into levels between 0.3 and 0.9 depths above the lowest point of the tip (above the
    rounding of the tip, below the root of the free surface). On each level the ridge is the mean position of the
    elements weighted with area times the square of the strain rate, and a line is fitted to the ridge. Elements nearer
    to the rake face than 0.3 of their height are the secondary zone and left out; after the first fit only elements
    within a third of the depth of the line count. nan if a level is empty.
    """
    if frame.cells.shape[0] == 0:
        return math.nan
    corners = frame.points[frame.cells]
    centroid = corners.mean(axis=1)
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    lowest = np.asarray(tool.centre) - [0.0, tool.tip_radius]
    x, height = (centroid - lowest).T
    bottom, top = max(0.3 * depth, min(1.5 * tool.tip_radius, 0.6 * depth)), 0.9 * depth
    from_rake = to_rake_frame(centroid, tool)[:, 1]
    zone = (height > bottom) & (height < top) & (from_rake > 0.3 * height) & (x > -4.0 * depth)
    x, height = x[zone], height[zone]
    rate = frame.cell_fields["equivalent_plastic_strain_rate"][zone]
    weight = area[zone] * rate**2
    level = ((height - bottom) / (top - bottom) * LEVELS).astype(np.int64)

    near = np.ones(x.size, dtype=bool)
    line = np.zeros(2)
    for _ in range(PASSES):
        total, ridge_x, ridge_height = (
            np.bincount(level[near], weights=value[near], minlength=LEVELS)
            for value in (weight, weight * x, weight * height)
        )
        filled = total > 0.0
        if np.count_nonzero(filled) < LEVELS // 2:
            return math.nan
        line = np.polyfit(ridge_height[filled] / total[filled], ridge_x[filled] / total[filled], 1)
        near = np.abs(x - np.polyval(line, height)) < depth / 3.0 * math.hypot(1.0, line[0])
    return math.degrees(math.atan2(1.0, -line[0]))
