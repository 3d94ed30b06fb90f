"""Profiles along the tool: temperature, normal and shear traction of the particles in contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.results.derived.contact_length import temperature

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ToolProfile:
    """Particles in contact, sorted along the tool surface.

    Attributes
    ----------
    arc_length
        Position (mm): zero at the rake tangent point, positive up the rake face; shape (k,).
    pressure, shear
        Normal and shear traction (MPa); shape (k,).
    temperature
        Temperature of the workpiece (K); shape (k,).
    """

    arc_length: Array
    pressure: Array
    shear: Array
    temperature: Array


def tool_profile(frame: Frame) -> ToolProfile:
    """Return the profiles of ``frame``, with the particles of zero pressure left out."""
    contact = frame.contact
    loaded = np.flatnonzero(contact.pressure > 0.0)
    order = loaded[np.argsort(contact.arc_length[loaded], kind="stable")]
    return ToolProfile(
        contact.arc_length[order],
        contact.pressure[order],
        contact.shear[order],
        temperature(frame)[contact.particles[order]],
    )
