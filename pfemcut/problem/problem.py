"""The problem as a whole: body, tool, contact, conditions and controls. Units: mm, tonne, s, K (so N, MPa, mJ)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from meshing.initial import Arc
from meshing.mesh import Mesh
from meshing.sizes import SizeField
from pfemcut.contact.conductance import Conductance
from pfemcut.contact.friction import FrictionLaw
from pfemcut.materials.material import Material
from pfemcut.problem.conditions import (
    Convection,
    DistributedForce,
    HeatFlux,
    MovingHeatBand,
    PrescribedMotion,
    PrescribedTemperature,
    Pressure,
    Traction,
)
from pfemcut.problem.controls import NewtonControls, ParticleControls, StabilisationModulus, TimeControls
from pfemcut.problem.course import Course, course_of
from pfemcut.tools.rigid_wedge import RigidWedge

_SAME = 1e-12  # relative difference of times that are one


@dataclass(frozen=True)
class Body:
    """A meshed body.

    Attributes
    ----------
    name
        Name used in messages and outputs.
    outline
        Corners of the polygon, counter-clockwise (mm).
    parts
        Name of the boundary part of each polygon side; side ``i`` runs from corner ``i`` to ``i + 1``. With a
        ``given`` mesh, the names that its part numbers stand for.
    material
        Material of the whole body.
    temperature
        Initial temperature (K).
    velocity
        Initial velocity (mm/s), which counts only with inertia.
    arcs
        Sides that are circular arcs.
    given
        A mesh to start from instead of meshing the outline, none or one.
    remesh
        Whether its particles are triangulated anew, inserted and removed, if the problem's are.
    sizes
        Spacing of the initial mesh, if not that of the problem.
    """

    name: str
    outline: tuple[tuple[float, float], ...]
    parts: tuple[str, ...]
    material: Material
    temperature: float
    velocity: tuple[float, float] = (0.0, 0.0)
    arcs: tuple[Arc, ...] = ()
    given: tuple[Mesh, ...] = ()
    remesh: bool = True
    sizes: tuple[SizeField, ...] = ()


@dataclass(frozen=True)
class Probe:
    """A particle whose displacement and temperature the history follows: the one nearest ``point`` at the start.

    ``body`` is the number of the body whose particle it is.
    """

    name: str
    point: tuple[float, float]
    body: int = 0


@dataclass(frozen=True)
class Conductor:
    """The block of a rigid tool that conducts heat; its properties are constant.

    Attributes
    ----------
    density, capacity, conductivity
        tonne/mm³, mm²/(s² K), N/(s K).
    length
        Of the rake and flank faces, from the tip to the holder (mm).
    fine_length
        Length of the rake face along which the mesh is finest (mm).
    tip_size, growth
        Finest spacing (mm), and its increase per distance.
    """

    density: float
    capacity: float
    conductivity: float
    length: float
    fine_length: float
    tip_size: float
    growth: float


@dataclass(frozen=True)
class MovingTool:
    """A tool at time zero, and how it moves and conducts.

    Attributes
    ----------
    shape
        The tool at time zero.
    velocity
        Constant (mm/s), in this stage of the problem.
    temperature
        Of the tool, or at the start and of its holder if it conducts (K).
    conductor
        Its block if it conducts heat, else none: then it keeps its temperature.
    body
        Name of the body that it is, if it is deformable: then the shape is that of the tool without load.
    since, shift
        Time when the stage began (s), and the displacement until then (mm).
    """

    shape: RigidWedge
    velocity: tuple[float, float]
    temperature: float = 293.15
    conductor: tuple[Conductor, ...] = ()
    body: str = ""
    since: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)

    def displacement(self, time: float) -> NDArray[np.float64]:
        """Displacement from time zero to ``time`` (s), in this stage (mm); shape (2,)."""
        return np.asarray(self.shift) + np.asarray(self.velocity) * (time - self.since)

    def at(self, time: float) -> RigidWedge:
        """The tool at ``time`` (s)."""
        return self.shape.moved(self.displacement(time))

    def going_on(self, time: float, velocity: tuple[float, float]) -> MovingTool:
        """The tool in the stage that begins at ``time`` (s), moving with another ``velocity`` (mm/s)."""
        x, y = self.displacement(time)
        return replace(self, velocity=velocity, since=time, shift=(float(x), float(y)))


@dataclass(frozen=True)
class ContactLaw:
    """Penalty contact with friction and heat (paper, eqs. 14, 26, 29, 33).

    Attributes
    ----------
    penalty
        Pressure per penetration (MPa/mm).
    friction
        Law of the shear traction.
    reference_speed
        Regularisation speed V_ref of eq. 26 (mm/s).
    heat_partition
        Fraction of the friction heat that enters the workpiece.
    conductance
        Of heat through the interface; none unless given.
    """

    penalty: float
    friction: FrictionLaw
    reference_speed: float
    heat_partition: float
    conductance: Conductance = Conductance(0.0)

    def smoothed(self, factor: float) -> ContactLaw:
        """The law with ``factor`` times the regularisation speed."""
        return replace(self, reference_speed=factor * self.reference_speed)


class ContactIntegration(Enum):
    """Where contact between bodies acts: at the particles of the slave surface, or at Gauss points of its edges."""

    NODES = "nodes"
    EDGES = "edges"


@dataclass(frozen=True)
class ContactPair:
    """Two surfaces that may touch.

    Attributes
    ----------
    slave, master
        Boundary parts of the one and of the other; the slave's points are held off the master's surface.
    integration
        See the enumeration.
    smooth
        Whether the master's surface is a smooth curve instead of the polygon of its edges.
    law
        Law of this contact.
    """

    slave: tuple[str, ...]
    master: tuple[str, ...]
    law: ContactLaw
    integration: ContactIntegration = ContactIntegration.NODES
    smooth: bool = True


@dataclass(frozen=True)
class SelfContact:
    """Contact of bodies with themselves.

    Attributes
    ----------
    law
        Law of this contact.
    thickness
        Distance at which surfaces touch (mm).
    spacing
        Largest wished spacing of particles where surfaces face each other (mm).
    """

    law: ContactLaw
    thickness: float
    spacing: float


@dataclass(frozen=True)
class Cut:
    """What derived figures of an orthogonal cut refer to.

    Attributes
    ----------
    depth
        Uncut chip thickness (mm).
    speed
        Cutting speed (mm/s).
    surface
        Height of the uncut surface (mm).
    chip_length
        Length at which the chip is cut off (mm); inf if it is not.
    """

    depth: float
    speed: float
    surface: float
    chip_length: float = math.inf


@dataclass(frozen=True)
class Problem:
    """A complete problem for any method.

    Attributes
    ----------
    title
        One line for reports.
    body
        The deforming body; in a cut the workpiece.
    motions, forces, tractions, pressures, temperatures, fluxes, heat_bands, convections
        Boundary conditions by part name; a boundary without any is free and adiabatic.
    tool
        Tools, none or one.
    contact
        Law of contact between body and rigid tool.
    particles, time, newton
        Controls.
    stabilisation
        Factor alpha_s of the polynomial pressure projection (paper, eq. 40).
    cut
        Reference figures if the problem is a cut, else empty.
    probes
        Points to follow.
    stabilisation_modulus
        Shear modulus in the pressure projection.
    others
        Other deforming bodies.
    pairs
        Contacts between bodies.
    self_contact
        How bodies touch themselves; none if that is not treated.
    after
        The problems that take over when this one has ended, one after the other: later stages, with the same bodies.
    """

    title: str
    body: Body
    motions: tuple[PrescribedMotion, ...]
    tool: tuple[MovingTool, ...]
    contact: ContactLaw
    particles: ParticleControls
    time: TimeControls
    newton: NewtonControls
    stabilisation: float
    cut: tuple[Cut, ...] = ()
    forces: tuple[DistributedForce, ...] = ()
    tractions: tuple[Traction, ...] = ()
    pressures: tuple[Pressure, ...] = ()
    temperatures: tuple[PrescribedTemperature, ...] = ()
    fluxes: tuple[HeatFlux, ...] = ()
    heat_bands: tuple[MovingHeatBand, ...] = ()
    convections: tuple[Convection, ...] = ()
    probes: tuple[Probe, ...] = ()
    stabilisation_modulus: StabilisationModulus = StabilisationModulus.ELASTIC
    others: tuple[Body, ...] = ()
    pairs: tuple[ContactPair, ...] = ()
    self_contact: tuple[SelfContact, ...] = ()
    after: tuple[Problem, ...] = ()

    @property
    def end(self) -> float:
        """Final time of the last stage (s)."""
        return (self, *self.after)[-1].time.end

    @property
    def course(self) -> Course:
        """How far a run is at each time."""
        return course_of([stage.time for stage in (self, *self.after)])

    def ends_stage(self, time: float) -> bool:
        """Whether a stage ends at ``time`` (s)."""
        return any(abs(time - stage.time.end) <= _SAME * stage.time.end for stage in (self, *self.after))

    def cutting_at(self, time: float) -> bool:
        """Whether a step that ended at ``time`` (s) belongs to the first stage."""
        return self.ending(time) is self

    def ending(self, time: float) -> Problem:
        """The stage of a step that ended at ``time`` (s)."""
        stages = (self, *self.after)
        return next((stage for stage in stages if time <= stage.time.end * (1.0 + _SAME)), stages[-1])

    def beginning(self, time: float) -> Problem:
        """The stage of a step that begins at ``time`` (s)."""
        stages = (self, *self.after)
        return next((stage for stage in stages if time < stage.time.end * (1.0 - _SAME)), stages[-1])

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All deforming bodies."""
        return (self.body, *self.others)

    @property
    def alone(self) -> tuple[PartProblem, ...]:
        """The problem of each body alone."""
        found, first = [], 0
        for body in self.bodies:
            found.append(
                PartProblem(replace(self, body=body, others=(), pairs=()) if self.others else self, first)
            )
            first += len(body.parts)
        return tuple(found)

    @property
    def rigid_tools(self) -> tuple[MovingTool, ...]:
        """Tools that do not deform."""
        return tuple(tool for tool in self.tool if not tool.body)

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the boundary parts of all bodies, by part number."""
        return tuple(name for body in self.bodies for name in body.parts)


@dataclass(frozen=True)
class PartProblem:
    """The problem of one body alone, and the number in the whole of its first boundary part."""

    problem: Problem
    first_part: int
