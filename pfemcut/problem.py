"""What a solver is given: bodies, named boundary parts with conditions, tool, contact and controls.

Solvers take a :class:`Problem` and know nothing of case files; ``pfemcut.case.cutting`` translates an
orthogonal cutting case, other translators serve verification problems. Units: mm, tonne, s, K (so N, MPa, mJ).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from meshing.initial import Arc
from meshing.mesh import Mesh
from meshing.sizes import SizeField
from pfemcut.materials.material import Material
from pfemcut.tools.rigid_wedge import RigidWedge


class Axis(Enum):
    """Direction of a prescribed motion."""

    X = 0
    Y = 1


class Integrator(Enum):
    """How the momentum solve sees the plastic multiplier."""

    IMPL_EX = "impl-ex"
    IMPLICIT = "implicit"


class HeatSource(Enum):
    """Which plastic multiplier heats: the implicit one (default) or the extrapolated one (the paper's Box 4)."""

    IMPLICIT = "implicit"
    EXTRAPOLATED = "extrapolated"


class VolumetricHistory(Enum):
    """Where the volume ratio J of an element comes from at the start of a step.

    INCREMENT: recomputed from the particles' pressure, with the stabilisation on the pressure's increment, so that
    nothing is forgotten as long as elements do not change. PRESSURE: the same with the stabilisation on the whole
    pressure, which forgets in every step what it took (the rule of the study in the design). ELEMENT: the element's
    own, transferred from element to element. MIXED: the element's own as long as it joins the same particles, else
    from pressure.
    """

    INCREMENT = "increment"
    PRESSURE = "pressure"
    ELEMENT = "element"
    MIXED = "mixed"


class ErrorEstimator(Enum):
    """Element field whose Zienkiewicz-Zhu error decides where particles may go."""

    NONE = "none"
    PLASTIC_STRAIN = "plastic-strain"
    STRESS = "stress"


@dataclass(frozen=True)
class Coarsening:
    """Removal of particles where an error estimator finds nothing to resolve (paper, section 2.1 and Fig. 2).

    Attributes
    ----------
    estimator
        What is estimated.
    tolerance
        Error, relative to the field's largest value, at which the wished spacing holds; below, spacing grows.
    largest
        Largest spacing, relative to the wished one.
    """

    estimator: ErrorEstimator
    tolerance: float
    largest: float


class ElementTransfer(Enum):
    """What an element that a remesh changed takes from the old elements in its place.

    SAMPLE: the value at its Gauss point. MEAN: the mean over its area. LINEAR: the mean over its area of values that
    vary linearly in each old element.
    """

    SAMPLE = "sample"
    MEAN = "mean"
    LINEAR = "linear"


@dataclass(frozen=True)
class Schedule:
    """A value as a piecewise linear function of time, constant beyond its ends.

    Attributes
    ----------
    times
        Increasing times (s); a single one makes the value constant.
    values
        Values at these times.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def __call__(self, time: float) -> float:
        """The value at ``time`` (s)."""
        return float(np.interp(time, self.times, self.values))


def constant(value: float) -> Schedule:
    """A value that does not change."""
    return Schedule((0.0,), (value,))


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
    """

    name: str
    outline: tuple[tuple[float, float], ...]
    parts: tuple[str, ...]
    material: Material
    temperature: float
    velocity: tuple[float, float] = (0.0, 0.0)
    arcs: tuple[Arc, ...] = ()
    given: tuple[Mesh, ...] = ()


@dataclass(frozen=True)
class PrescribedMotion:
    """A displacement component prescribed on a boundary part, the same everywhere or linear along it.

    Attributes
    ----------
    part, axis
        Where, and which component.
    displacement
        mm since time zero.
    gradient
        Derivatives of the displacement by the initial position, x and y; none if the part moves as one.
    centre
        Initial position where the gradient adds nothing (mm).
    """

    part: str
    axis: Axis
    displacement: Schedule
    gradient: tuple[Schedule, ...] = ()
    centre: tuple[float, float] = (0.0, 0.0)

    def increment(self, start: float, end: float) -> NDArray[np.float64]:
        """Change from time ``start`` to ``end`` (s) of the displacement and of its gradient, x and y; shape (3,)."""
        schedules = (self.displacement, *(self.gradient or (constant(0.0), constant(0.0))))
        return np.array([schedule(end) - schedule(start) for schedule in schedules])

    def shape(self, initial: NDArray[np.float64]) -> NDArray[np.float64]:
        """What :meth:`increment` multiplies at the initial positions (n, 2): 1, X - X_c, Y - Y_c; shape (n, 3)."""
        return np.column_stack([np.ones(len(initial)), initial - np.asarray(self.centre)])


def fixed(part: str, axis: Axis) -> PrescribedMotion:
    """A boundary part held in one direction."""
    return PrescribedMotion(part, axis, constant(0.0))


@dataclass(frozen=True)
class DistributedForce:
    """A dead force (N per mm of width), spread evenly over the current length of a boundary part."""

    part: str
    x: Schedule
    y: Schedule


@dataclass(frozen=True)
class Traction:
    """A traction (MPa) per current length of a boundary part, in fixed directions."""

    part: str
    x: Schedule
    y: Schedule


@dataclass(frozen=True)
class Pressure:
    """A pressure (MPa) on a boundary part, normal to its current surface."""

    part: str
    pressure: Schedule


@dataclass(frozen=True)
class PrescribedTemperature:
    """A temperature (K) prescribed on a boundary part."""

    part: str
    temperature: Schedule


@dataclass(frozen=True)
class HeatFlux:
    """A heat flux into the body (N/(mm s) = mW/mm²) on a boundary part."""

    part: str
    flux: Schedule


@dataclass(frozen=True)
class MovingHeatBand:
    """A heat flux into the body (mW/mm²) on the piece of a boundary part in a band of x that moves.

    Attributes
    ----------
    lower, upper
        Ends of the band at time zero (mm).
    velocity
        Velocity of the band (mm/s).
    """

    part: str
    flux: float
    lower: float
    upper: float
    velocity: float


@dataclass(frozen=True)
class Convection:
    """A heat flux ``coefficient`` (N/(mm s K)) times (``ambient`` - temperature) on a boundary part."""

    part: str
    coefficient: float
    ambient: Schedule


@dataclass(frozen=True)
class Probe:
    """A particle whose displacement and temperature the history follows: the one nearest ``point`` at the start."""

    name: str
    point: tuple[float, float]


@dataclass(frozen=True)
class MovingTool:
    """A rigid tool at time zero and its constant velocity (mm/s)."""

    shape: RigidWedge
    velocity: tuple[float, float]

    def at(self, time: float) -> RigidWedge:
        """The tool at ``time`` (s)."""
        x, y = self.shape.centre
        vx, vy = self.velocity
        centre = (x + vx * time, y + vy * time)
        return RigidWedge(centre, self.shape.rake, self.shape.clearance, self.shape.tip_radius)


@dataclass(frozen=True)
class ContactLaw:
    """Penalty contact with regularised Coulomb friction (paper, eqs. 14, 26, 33).

    Attributes
    ----------
    penalty
        Pressure per penetration (MPa/mm).
    friction
        Coulomb coefficient.
    reference_speed
        Regularisation speed V_ref of eq. 26 (mm/s).
    heat_partition
        Fraction of the friction heat that enters the workpiece.
    """

    penalty: float
    friction: float
    reference_speed: float
    heat_partition: float


@dataclass(frozen=True)
class ParticleControls:
    """Insertion and removal of particles (paper, section 2.1 and Figs. 2 and 3).

    Lengths are relative to the local spacing h of ``sizes``.

    Attributes
    ----------
    sizes
        Wished spacing at time zero.
    sizes_velocity
        Velocity at which the size field moves, as with the tool (mm/s).
    remesh
        Whether particles are re-triangulated, inserted and removed at all.
    insert, remove
        Switches of insertion and removal.
    boundary_split
        A boundary edge longer than this times h is split.
    boundary_removal
        A boundary edge shorter than this times h is collapsed.
    interior_radius, interior_area
        An element is refined if its circumradius exceeds ``interior_radius`` h or its area
        ``interior_area`` h².
    interior_spacing
        A new particle keeps this times h from the others.
    interior_removal
        A particle closer than this times h to another is removed.
    coarsening
        Removal by error estimators.
    volumetric_history, transfer
        See the enumerations.
    power_tolerance
        Plastic power of one element, as a fraction of the body's, above which it is refined (eq. 1).
    power_smallest
        Plastic-power refinement stops at this times h.
    """

    sizes: SizeField
    sizes_velocity: tuple[float, float]
    remesh: bool
    insert: bool
    remove: bool
    boundary_split: float
    boundary_removal: float
    interior_radius: float
    interior_area: float
    interior_spacing: float
    interior_removal: float
    coarsening: Coarsening
    volumetric_history: VolumetricHistory
    transfer: ElementTransfer
    power_tolerance: float
    power_smallest: float


@dataclass(frozen=True)
class TimeControls:
    """Time stepping.

    Attributes
    ----------
    step
        Nominal step (s).
    end
        Final time (s).
    first_step_fraction
        The first step is this times ``step`` and grows from there.
    growth
        Largest ratio of a step to the one before.
    smallest_step_fraction
        A run whose step must fall below this times ``step`` stops with an error.
    integrator, heat_source
        See the enumerations.
    inertia
        Whether the momentum balance has its inertia term (backward Euler).
    """

    step: float
    end: float
    first_step_fraction: float
    growth: float
    smallest_step_fraction: float
    integrator: Integrator
    heat_source: HeatSource
    inertia: bool


@dataclass(frozen=True)
class NewtonControls:
    """Newton iteration of the momentum solve.

    Attributes
    ----------
    tolerance
        Relative tolerance of the residual norm.
    max_iterations
        A solve that needs more is retried with half the step.
    """

    tolerance: float
    max_iterations: int


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
    """

    depth: float
    speed: float
    surface: float


@dataclass(frozen=True)
class Problem:
    """A complete problem for any method.

    Attributes
    ----------
    title
        One line for reports.
    body
        The deforming body.
    motions, forces, tractions, pressures, temperatures, fluxes, heat_bands, convections
        Boundary conditions by part name; a boundary without any is free and adiabatic.
    tool
        Rigid tools, none or one.
    contact
        Law of contact between body and tool.
    particles, time, newton
        Controls.
    stabilisation
        Factor alpha_s of the polynomial pressure projection (paper, eq. 40).
    cut
        Reference figures if the problem is a cut, else empty.
    probes
        Points to follow.
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
