"""Contact length on the rake face, and the loaded arc of the tip (picture: docs/pictures/contact_length.png).

Both are measured along the tool surface from the rake tangent point, where the tip circle meets the rake face:
the contact length up the rake face to the last loaded particle, the tip arc round the tip to the last loaded
particle of the circle. A particle is loaded if its contact pressure is positive. One without a mesh fills a cell round
it, so contact reaches farther than it by half a spacing, the frame's ``surface_offset``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import ContactView, Frame
from pfemcut.tools.rigid_wedge import RigidWedge


def contact_length(contact: ContactView, surface_offset: float = 0.0) -> float:
    """Return the distance (mm) from the rake tangent point to the last loaded particle on the rake face.

    Farther by ``surface_offset`` (mm). Zero if no particle on the rake face is loaded.
    """
    last = float(np.max(contact.arc_length[contact.pressure > 0.0], initial=0.0))
    return last + surface_offset if last > 0.0 else 0.0


def tip_arc_contact(contact: ContactView, tool: RigidWedge, surface_offset: float = 0.0) -> float:
    """Return the length (mm) of the tip circle's arc from the rake tangent point to its last loaded particle.

    Farther by ``surface_offset`` (mm), at most the whole arc; contact on the flank face doesn't count.
    """
    whole = tool.tip_radius * tool.arc_angle
    last = -float(np.min(contact.arc_length[contact.pressure > 0.0], initial=0.0))
    return min(last + surface_offset, whole) if last > 0.0 else 0.0


def contact_end_temperature(frame: Frame) -> float:
    """Return the temperature (K) of the last loaded particle on the rake face; nan without one."""
    contact = frame.contact
    loaded = np.flatnonzero((contact.pressure > 0.0) & (contact.arc_length > 0.0))
    if loaded.size == 0:
        return math.nan
    last = loaded[np.argmax(contact.arc_length[loaded])]
    return float(temperature(frame)[contact.particles[last]])


def temperature(frame: Frame) -> NDArray[np.float64]:
    """Return the particle temperatures (K) of a frame; shape (n,)."""
    return np.asarray(frame.point_fields["temperature"], dtype=np.float64)
