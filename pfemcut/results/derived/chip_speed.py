"""Chip speed (mm/s): how fast the chip leaves, relative to the tool.

The mean over the stations of the chip section (1 to 2 depths beyond the end of contact) of the material's velocity
relative to the tool, along the chip. Material is conserved, so chip speed times chip thickness is cutting speed times
depth of cut; the chip ratio by speed, chip speed over cutting speed, checks the one by thickness.
"""

from __future__ import annotations

import math

import numpy as np

from pfemcut.results.derived.chip_section import ChipSection
from pfemcut.tools.rigid_wedge import RigidWedge


def chip_speed(section: ChipSection, tool: RigidWedge, tool_velocity: tuple[float, float]) -> float:
    """Return the mean speed along the chip relative to a tool with ``tool_velocity``; nan without stations."""
    if section.direction.shape[0] == 0:
        return math.nan
    velocity = np.asarray(tool_velocity)
    moving = np.array([velocity @ tool.rake_direction, velocity @ tool.rake_normal])
    return float(np.mean(np.sum((section.velocity - moving) * section.direction, axis=1)))
