"""Contact length on the rake face, and the loaded arc of the tip (picture: docs/pictures/contact_length.png).

Both are measured along the tool surface from the rake tangent point, where the tip circle meets the rake face:
the contact length up the rake face to the last loaded particle, the tip arc round the tip to the last loaded
particle of the circle. A particle is loaded if its contact pressure is positive.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import ContactView, Frame
from pfemcut.tools.rigid_wedge import RigidWedge


def contact_length(contact: ContactView) -> float:
    """Return the distance (mm) from the rake tangent point to the last loaded particle on the rake face.

    Zero if no particle on the rake face is loaded.
    """
    arc = contact.arc_length[contact.pressure > 0.0]
    return float(max(arc.max(initial=0.0), 0.0))


def tip_arc_contact(contact: ContactView, tool: RigidWedge) -> float:
    """Return the length (mm) of the tip circle's arc from the rake tangent point to its last loaded particle.

    At most the whole arc; contact on the flank face doesn't count.
    """
    whole = tool.tip_radius * tool.arc_angle
    arc = contact.arc_length[contact.pressure > 0.0]
    return float(np.clip(-arc.min(initial=0.0), 0.0, whole))


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
