"""Profiles along the tool: temperature, normal and shear traction of the particles in contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Block, Frame
from pfemcut.results.derived.contact_length import temperature
from pfemcut.results.derived.tool_state import without_load
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ON_SURFACE = 0.02  # of the tip radius: the edges of a mesh may touch the tip circle from outside


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


def tool_surface_temperature(frame: Frame) -> tuple[Array, Array]:
    """Arc length (mm), rising, and temperature (K) of the surface of a tool that conducts heat; both empty without."""
    for tool, block in zip(frame.tool, frame.tool_blocks, strict=False):
        particles, arc = tool_surface(tool, block)
        return arc, np.asarray(block.point_fields["temperature"], dtype=np.float64)[particles]
    return np.empty(0), np.empty(0)


def tool_surface(tool: RigidWedge, block: Block) -> tuple[IntArray, Array]:
    """Particles of a tool's mesh on its rake face, edge and flank, and their arc lengths (mm), rising; (k,) each."""
    points = without_load(block)
    particles = np.flatnonzero(np.abs(tool.closest(points).gap) < _ON_SURFACE * tool.tip_radius)
    arc = tool.arc_length(points[particles])
    order = np.argsort(arc, kind="stable")
    return particles[order], arc[order]


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
