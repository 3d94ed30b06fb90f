"""Forces on the parts of a rigid tool: what rake face, tip circle and flank face bear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.contact.penalty import facing_lengths
from pfemcut.method import Frame
from pfemcut.results.derived.rays import loop_edges
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ForceShares:
    """Cutting and thrust force (N/mm) on each part of the tool; shape (2,)."""

    rake: Array
    tip: Array
    flank: Array


def force_shares(frame: Frame, tool: RigidWedge, speed: float) -> ForceShares:
    """Sum the tractions of the particles in contact over their tributary lengths.

    Friction pushes the tool in the direction in which the particle slides over it.

    Parameters
    ----------
    frame
        With contact.
    tool
        Where it is in the frame.
    speed
        Of the tool towards -x (mm/s).
    """
    contact = frame.contact
    points = frame.points[contact.particles]
    length = facing_lengths(tool, frame.points, loop_edges(frame.loops))[contact.particles]
    normal = tool.closest(points).normal
    # Up the rake face, as the arc length.
    tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
    slip = np.asarray(frame.point_fields["velocity"])[contact.particles] + np.array([speed, 0.0])
    shear = contact.shear * np.sign(np.einsum("ki,ki->k", slip, tangent))
    force = length[:, None] * (shear[:, None] * tangent - contact.pressure[:, None] * normal)
    arc = contact.arc_length
    on_rake, on_flank = arc > 0.0, arc < -tool.tip_radius * tool.arc_angle
    return ForceShares(
        force[on_rake].sum(axis=0), force[~on_rake & ~on_flank].sum(axis=0), force[on_flank].sum(axis=0)
    )
