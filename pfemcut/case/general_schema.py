"""The case file of a general plane-strain problem: body, named boundary parts with conditions, tool, probes.

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from pfemcut.case.sections import (
    Contact,
    Method,
    Output,
    Section,
    SelfContact,
    Solver,
    Spacing,
    Time,
    ToolHeat,
    as_tuples,
    name_or_table,
)

Point = Annotated[tuple[float, float], BeforeValidator(as_tuples)]
Numbers = Annotated[tuple[float, ...], BeforeValidator(as_tuples)]
Names = Annotated[tuple[str, ...], BeforeValidator(as_tuples)]


class TimeTable(Section):
    """A value that changes in time, linear between the given instants and constant beyond them."""

    time: Numbers = Field(min_length=2, description="Increasing instants (s)")
    value: Numbers = Field(min_length=2, description="Values at these instants")

    @model_validator(mode="after")
    def _is_a_function(self) -> Self:
        if len(self.time) != len(self.value):
            raise ValueError(
                f"time has {len(self.time)} entries and value {len(self.value)}: must be as many"
            )
        if any(b <= a for a, b in zip(self.time, self.time[1:], strict=False)):
            raise ValueError("time: must increase")
        return self


Amount = float | TimeTable


class Components(Section):
    """Components in x and y; one that is left out is not prescribed (motion) or zero (load)."""

    x: Amount | None = Field(default=None, description="Component in x")
    y: Amount | None = Field(default=None, description="Component in y")


class GradientTable(Section):
    """A displacement that is linear in the initial position; a component without any entry is not prescribed."""

    centre: Point = Field(default=(0.0, 0.0), description="Initial position that does not move (mm)")
    xx: Amount | None = Field(default=None, description="Derivative of u_x by X (dimensionless)")
    xy: Amount | None = Field(default=None, description="Derivative of u_x by Y (dimensionless)")
    yx: Amount | None = Field(default=None, description="Derivative of u_y by X (dimensionless)")
    yy: Amount | None = Field(default=None, description="Derivative of u_y by Y (dimensionless)")


class ArcSide(Section):
    """A side of the outline that is a circular arc of less than half a turn."""

    side: int = Field(ge=0, description="Number of the side; side i starts at corner i")
    centre: Point = Field(description="Centre of the circle (mm)")


class BodyTable(Section):
    """The deforming body: an outline that is meshed, or a mesh file."""

    name: str = Field(default="body", min_length=1, description="Name in messages and outputs")
    outline: Annotated[tuple[Point, ...], BeforeValidator(as_tuples)] | None = Field(
        default=None, min_length=3, description="Corners, counter-clockwise (mm)"
    )
    parts: Annotated[tuple[str, ...], BeforeValidator(as_tuples)] | None = Field(
        default=None, description="Name of the boundary part of each side; side i starts at corner i"
    )
    arcs: Annotated[tuple[ArcSide, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Sides that are circular arcs"
    )
    mesh: str | None = Field(
        default=None, description="Mesh file that meshio reads; named groups of lines are the boundary parts"
    )
    material: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] = Field(
        description="Name in the library, path to a material file, or a table"
    )
    temperature: float | None = Field(
        default=None,
        gt=0,
        description="Initial temperature (K); the material's reference temperature unless given",
    )
    velocity: Point = Field(default=(0.0, 0.0), description="Initial velocity, with inertia (mm/s)")
    coarser: float = Field(
        default=1.0, gt=0, description="Factor on the spacing of [mesh] in the first mesh of this body"
    )
    remesh: bool = Field(default=True, description="Whether this body is triangulated anew, if [mesh] remesh")

    @model_validator(mode="after")
    def _has_one_geometry(self) -> Self:
        if (self.outline is None) == (self.mesh is None):
            raise ValueError("needs either outline or mesh")
        if self.outline is None:
            return self
        sides = len(self.outline)
        if self.parts is None or len(self.parts) != sides:
            raise ValueError(f"parts: must name each of the {sides} sides of the outline")
        if any(arc.side >= sides for arc in self.arcs):
            raise ValueError(f"arcs: side must be below {sides}")
        corners = zip(self.outline, (*self.outline[1:], self.outline[0]), strict=True)
        if not self.arcs and sum(a[0] * b[1] - a[1] * b[0] for a, b in corners) <= 0.0:
            raise ValueError("outline: corners must be counter-clockwise")
        return self


class Band(Section):
    """A heat flux on the piece of the part inside a band of x that moves."""

    flux: float = Field(description="Heat flux into the body (N/(mm s))")
    lower: float = Field(description="Lower end of the band at time zero (mm)")
    upper: float = Field(description="Upper end of the band at time zero (mm)")
    velocity: float = Field(default=0.0, description="Velocity of the band in x (mm/s)")


class ConvectionTable(Section):
    """Heat exchange with the surroundings."""

    coefficient: float = Field(gt=0, description="Heat transfer coefficient (N/(mm s K))")
    ambient: Amount = Field(description="Temperature of the surroundings (K)")


class BoundaryTable(Section):
    """Conditions on one boundary part; what is not given is free and adiabatic."""

    part: str = Field(description="Name of the boundary part")
    displacement: Components | None = Field(default=None, description="Displacement since time zero (mm)")
    velocity: Components | None = Field(default=None, description="Constant velocity (mm/s)")
    gradient: GradientTable | None = Field(
        default=None, description="Displacement since time zero that is linear in the initial position"
    )
    force: Components | None = Field(
        default=None, description="Force per width, spread evenly over the part (N/mm)"
    )
    traction: Components | None = Field(default=None, description="Traction per current length (MPa)")
    pressure: Amount | None = Field(default=None, description="Pressure normal to the current surface (MPa)")
    temperature: Amount | None = Field(default=None, description="Temperature (K)")
    flux: Amount | None = Field(default=None, description="Heat flux into the body (N/(mm s))")
    band: Band | None = Field(default=None, description="Heat flux in a moving band")
    convection: ConvectionTable | None = Field(default=None, description="Heat exchange")

    @model_validator(mode="after")
    def _moves_one_way(self) -> Self:
        if sum(each is not None for each in (self.displacement, self.velocity, self.gradient)) > 1:
            raise ValueError("displacement, velocity and gradient exclude each other")
        for component in (self.velocity.x, self.velocity.y) if self.velocity else ():
            if isinstance(component, TimeTable):
                raise ValueError("velocity: must be constant; prescribe a displacement that changes in time")
        return self


class RigidTool(ToolHeat):
    """A rigid wedge rounded by a tip circle, anywhere and moving anywhere."""

    rake: float = Field(default=0.0, gt=-90, lt=90, description="Rake angle (degrees)")
    clearance: float = Field(default=5.0, gt=-90, lt=90, description="Clearance angle (degrees)")
    tip_radius: float = Field(gt=0, description="Radius of the tip circle (mm)")
    centre: Point = Field(description="Centre of the tip circle at time zero (mm)")
    velocity: Point = Field(default=(0.0, 0.0), description="Velocity (mm/s)")


class Refinement(Section):
    """A finer spacing near a point or a segment."""

    start: Point = Field(description="Point, or one end of the segment (mm)")
    end: Point | None = Field(default=None, description="Other end of the segment (mm)")
    radius: float = Field(default=0.0, ge=0, description="Distance over which the size holds (mm)")
    size: float = Field(gt=0, description="Spacing there (mm)")
    growth: float = Field(default=0.1, gt=0, le=1, description="Increase of the spacing per distance")


class GeneralMesh(Spacing):
    """Particle spacing h, and when particles are inserted and removed."""

    size: float = Field(gt=0, description="Largest spacing (mm)")
    refine: Annotated[tuple[Refinement, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Finer regions"
    )
    velocity: Point = Field(default=(0.0, 0.0), description="Velocity of the finer regions (mm/s)")


class GeneralTime(Time):
    """Time steps and integrator."""

    end: float = Field(gt=0, description="Final time (s)")
    integrator: Literal["impl-ex", "implicit"] = Field(
        default="implicit", description="Integrator of the plastic flow in the momentum solve"
    )
    first_step_fraction: float = Field(
        default=1.0, gt=0, le=1, description="First step, as a fraction of the nominal one"
    )


class GeneralContact(Contact):
    """Contact between tool and body."""

    self: SelfContact | None = Field(
        default=None, description="Table [contact.self]: contact of the body with itself"
    )


class PairTable(Contact):
    """Contact between boundary parts of two bodies."""

    slave: Names = Field(min_length=1, description="Boundary parts whose particles are held off the others")
    master: Names = Field(min_length=1, description="Boundary parts of another body that they touch")
    points: Literal["nodes", "edges"] = Field(
        default="edges",
        description="Where contact acts: at the slave's particles, or at Gauss points of its edges",
    )
    smooth: bool = Field(
        default=False,
        description="Whether the master is a smooth curve through its particles, or its edges",
    )


def _one_or_more(value: Any) -> str:
    return "pairs" if isinstance(value, list | tuple) else "one law"


Contacts = Annotated[
    Annotated[GeneralContact, Tag("one law")]
    | Annotated[tuple[PairTable, ...], BeforeValidator(as_tuples), Tag("pairs")],
    Discriminator(_one_or_more),
]


class ProbeTable(Section):
    """A particle to follow: the one nearest the point at the start."""

    name: str = Field(pattern=r"^[A-Za-z]\w*$", description="Name of the columns in history.csv")
    point: Point = Field(description="Position at time zero (mm)")
    body: str = Field(default="", description="Name of the body whose particle it is; the first unless given")


class GeneralCase(Section):
    """A whole case file of a general problem."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["general"] = Field(description="Kind of problem")
    method: Method = Field(default="pfem", description="Numerical method")
    body: Annotated[tuple[BodyTable, ...], BeforeValidator(as_tuples)] = Field(
        min_length=1, description="Tables [[body]]: the deforming bodies, whose boundary parts differ in name"
    )
    boundary: Annotated[tuple[BoundaryTable, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[boundary]]: conditions by part"
    )
    tool: RigidTool | None = Field(default=None, description="Table [tool]: a rigid tool")
    contact: Contacts = Field(
        default_factory=GeneralContact,
        description="Table [contact]: contact with the tool; or tables [[contact]] between bodies",
    )
    mesh: GeneralMesh = Field(description="Table [mesh]: particle spacing")
    time: GeneralTime = Field(description="Table [time]: time steps")
    solver: Solver = Field(default_factory=Solver, description="Table [solver]")
    probe: Annotated[tuple[ProbeTable, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[probe]]: points to follow"
    )
    output: Output = Field(default_factory=Output, description="Table [output]")

    @model_validator(mode="after")
    def _names_match(self) -> Self:
        names = [each.name for each in self.probe]
        if len(set(names)) < len(names):
            raise ValueError("[[probe]] name: must differ from each other")
        bodies = [body.name for body in self.body]
        if len(set(bodies)) < len(bodies):
            raise ValueError("[[body]] name: must differ from each other")
        for each in self.probe:
            if each.body and each.body not in bodies:
                raise ValueError(f"[[probe]] body: unknown '{each.body}'")
        pairs = self.contact if isinstance(self.contact, tuple) else ()
        if pairs and self.tool is not None:
            raise ValueError("[[contact]] between bodies and a rigid [tool] exclude each other")
        # The parts of a mesh file are looked at when it is read.
        if any(body.parts is None for body in self.body):
            return self
        known = [part for body in self.body for part in dict.fromkeys(body.parts or ())]
        repeated = sorted({part for part in known if known.count(part) > 1})
        if repeated:
            raise ValueError(f"[[body]] parts: '{repeated[0]}' names parts of two bodies")
        used = [("[[boundary]] part", each.part) for each in self.boundary]
        used += [("[[contact]] slave", part) for pair in pairs for part in pair.slave]
        used += [("[[contact]] master", part) for pair in pairs for part in pair.master]
        for key, part in used:
            if part not in known:
                allowed = ", ".join(f"'{each}'" for each in known)
                raise ValueError(f"{key}: unknown '{part}'; allowed: {allowed}")
        return self
