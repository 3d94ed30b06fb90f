"""Stagnation height (mm): where the material on the tip parts into chip and machined surface.

The height, above the lowest point of the tip circle, at which the tangential velocity of the particles in contact
relative to the tool changes sign: above it they flow up the rake, below it under the tip.
"""

from __future__ import annotations

import math

import numpy as np

from pfemcut.method import Frame
from pfemcut.tools.rigid_wedge import RigidWedge


def stagnation_height(frame: Frame, tool: RigidWedge, tool_velocity: tuple[float, float]) -> float:
    """Return the stagnation height (mm); nan if the contact particles all flow the same way.

    Parameters
    ----------
    frame
        The instant.
    tool
        The tool at that instant.
    tool_velocity
        Velocity of the tool (mm/s).
    """
    contact = frame.contact
    order = np.argsort(contact.arc_length, kind="stable")
    particles = contact.particles[order]
    points = frame.points[particles]
    closest = tool.closest(points)
    tangent = np.column_stack([closest.normal[:, 1], -closest.normal[:, 0]])
    velocity = np.asarray(frame.point_fields["velocity"], dtype=np.float64)[particles]
    sliding = ((velocity - np.asarray(tool_velocity)) * tangent).sum(axis=1)
    turns = np.flatnonzero((sliding[:-1] <= 0.0) & (sliding[1:] > 0.0))
    if turns.size == 0:
        return math.nan
    low, high = turns[-1], turns[-1] + 1
    fraction = sliding[low] / (sliding[low] - sliding[high])
    on_tool = points - closest.gap[:, None] * closest.normal
    height = on_tool[:, 1] - (tool.centre[1] - tool.tip_radius)
    return float(height[low] + fraction * (height[high] - height[low]))
