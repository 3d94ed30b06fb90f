"""The verbs that every method (PFEM, later SPH and others) offers to the driver, and what passes between them.

The driver writes history, fields, checkpoints and reports from these alone, so it is written once for all methods.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class RunStopped(Exception):
    """A run that can't go on: the message says where and why. State stays that of the last finished step."""


class CutEnded(Exception):
    """The cut came to a physical end before its travel (the chip touched the workpiece); outputs stay valid."""


@dataclass(frozen=True)
class Measures:
    """The core columns of one history row. Forces are on the tool per mm of width; energies per mm of width."""

    step: int
    time: float
    dt: float
    travel: float
    cutting_force: float
    thrust_force: float
    contact_length: float
    max_temperature: float
    max_eqps: float
    tool_work: float
    plastic_work: float
    friction_work: float
    elastic_energy: float
    kinetic_energy: float
    energy_error: float
    nodes: int


@dataclass(frozen=True)
class ContactView:
    """Particles of the body that touch the tool.

    Attributes
    ----------
    particles
        Indices into ``Frame.points``; shape (k,).
    arc_length
        Position along the tool (mm), see :meth:`RigidWedge.arc_length`; shape (k,).
    pressure, shear
        Normal and shear traction (MPa), pressure positive in compression; shape (k,).
    """

    particles: IntArray
    arc_length: Array
    pressure: Array
    shear: Array

    @staticmethod
    def none() -> ContactView:
        """No contact."""
        return ContactView(np.empty(0, dtype=np.int64), np.empty(0), np.empty(0), np.empty(0))


@dataclass(frozen=True)
class Block:
    """A meshed tool or another body.

    Attributes
    ----------
    points, cells
        Particle positions (mm; (n, 2)) and triangles (m, 3).
    point_fields, cell_fields
        Fields by standard name. ``displacement`` of a deformable tool is that from where it would be without load.
    name
        Of the body.
    """

    points: Array
    cells: IntArray
    point_fields: Mapping[str, NDArray[np.generic]]
    cell_fields: Mapping[str, Array] = field(default_factory=dict)
    name: str = "tool"


@dataclass(frozen=True)
class Frame:
    """Everything that outputs show of one instant.

    Attributes
    ----------
    step, time, travel
        Instant (-, s, mm).
    points
        Particle positions (mm); shape (n, 2).
    cells
        Triangles as particle indices, counter-clockwise; shape (m, 3); m = 0 for meshless methods.
    loops
        Closed boundary loops as particle indices, the body on the left; empty for meshless methods.
    point_fields
        Fields on particles by standard name: ``velocity`` (n, 2), ``pressure`` (n,), ``temperature`` (n,),
        ``particle_id`` (n,).
    cell_fields
        Fields on elements: ``equivalent_plastic_strain``, ``equivalent_plastic_strain_rate``, ``von_mises`` (m,),
        ``cauchy_stress`` (m, 4: xx, yy, zz, xy), ``plastic_power`` (m,) per volume.
    tool
        Tools at this instant, none or one.
    contact
        Particles in contact with the tool.
    tool_blocks
        Meshes of the tools that have one.
    others
        Bodies besides the first that are no tools.
    surface_offset
        How far the surface lies outside of the boundary loops (mm): half a spacing for particles that each fill a cell
        round them, zero for a mesh.
    """

    step: int
    time: float
    travel: float
    points: Array
    cells: IntArray
    loops: tuple[IntArray, ...]
    point_fields: Mapping[str, NDArray[np.generic]]
    cell_fields: Mapping[str, Array]
    tool: tuple[RigidWedge, ...]
    contact: ContactView
    tool_blocks: tuple[Block, ...] = ()
    others: tuple[Block, ...] = ()
    surface_offset: float = 0.0


class Method(Protocol):
    """A method in the middle of a run."""

    @property
    def finished(self) -> bool:
        """Whether the final time is reached."""

    def advance(self) -> None:
        """Advance one step.

        Raises
        ------
        RunStopped
            If the run can't go on.
        CutEnded
            If the cut came to a physical end.
        """

    def measure(self) -> Measures:
        """The core history columns after the last step."""

    def own_measures(self) -> Mapping[str, float]:
        """The method's own history columns, always the same keys in the same order."""

    def timing(self) -> Mapping[str, float]:
        """Wall seconds of the last step by phase, always the same keys in the same order."""

    def frame(self) -> Frame:
        """The fields after the last step."""

    def state(self) -> Mapping[str, NDArray[np.generic]]:
        """All arrays (0-d for scalars) that :meth:`restore` of the same class needs."""
