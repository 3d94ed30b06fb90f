"""The section of explicit particle methods, and the case file of solids filled with particles.

Units: mm, tonne, s, K (so N, MPa, mJ).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from pfemcut.case.sections import Output, Section, as_tuples, name_or_table, planned

CuttingMethod = Annotated[Literal["pfem", "tlsph", "esph"], planned("sph", "lattice", "peridynamics")]
ParticleMethodName = Annotated[Literal["tlsph", "esph"], planned("lattice", "peridynamics")]

Point = Annotated[tuple[float, float] | tuple[float, float, float], BeforeValidator(as_tuples)]
Corners = Annotated[tuple[Point, Point], BeforeValidator(as_tuples)]


class ExplicitParticles(Section):
    """Kernel, viscosity and time steps of explicit particles."""

    smoothing: float = Field(
        default=1.5, ge=1, le=3, description="Smoothing length h of the kernel, over the spacing"
    )
    corrected: bool = Field(
        default=True, description="Whether kernel gradients are corrected to be exact for linear fields"
    )
    alpha: float = Field(default=0.5, ge=0, description="Linear artificial viscosity (dimensionless)")
    beta: float = Field(default=0.5, ge=0, description="Quadratic artificial viscosity (dimensionless)")
    zero_energy: float = Field(
        default=0.1, ge=0, description="Modulus of the control of zero-energy modes, over Young's modulus"
    )
    reference_update: float = Field(
        default=0.5,
        ge=0,
        description="Relative displacement of neighbours, over h, at which the present configuration becomes the "
        "reference; zero keeps the first one",
    )
    artificial_pressure: float = Field(
        default=0.3, ge=0, description="Artificial pressure gamma of Eulerian SPH (dimensionless)"
    )
    pinball: Annotated[tuple[float, float], BeforeValidator(as_tuples)] = Field(
        default=(0.0, 1.0),
        description="Factors k1 and k2 of pinballs between bodies, and with tlsph of a body with itself "
        "(dimensionless); k1 = 0 leaves Hertz's law alone",
    )
    courant: float = Field(default=0.3, gt=0, le=1, description="Time step over its limit of stability")
    mass_scaling: float = Field(
        default=1.0,
        ge=1,
        description="Factor on inertia, for longer time steps; look at kinetic_energy in the history",
    )
    batch: int = Field(
        default=50, ge=1, description="Time steps that count as one step of history and output"
    )


class Particles(ExplicitParticles):
    """Explicit particles of a cut, for other methods than the PFEM, whose sections then mean nothing."""

    conduction: bool = Field(
        default=True,
        description="Whether heat flows between particles and, by [contact] conductance, into the tool; "
        "false: adiabatic",
    )

    spacing: float | None = Field(
        default=None,
        gt=0,
        description="Distance of particles at the start (mm); a tenth of the depth of cut unless given",
    )
    filled_length: float | None = Field(
        default=None,
        gt=0,
        description="Length of the part of a cut's workpiece that is filled with particles, from the tool on (mm); "
        "all of it unless given",
    )
    filled_height: float | None = Field(
        default=None,
        gt=0,
        description="Height of the part of a cut's workpiece that is filled with particles, from the top down (mm); "
        "all of it unless given",
    )


class SolidsParticles(ExplicitParticles):
    """Spacing, kernel, viscosity and time steps of explicit particles."""

    conduction: bool = Field(
        default=False,
        description="Whether heat flows between particles, with tlsph of one body, with esph of all; false: adiabatic",
    )
    spacing: float = Field(gt=0, description="Distance of particles at the start (mm)")
    contact: Literal["auto", "kernel", "pinball"] = Field(
        default="auto",
        description="How bodies touch: by the sums over the kernel (esph only) or by pinballs; auto: kernel with esph, "
        "pinball with tlsph",
    )


class Cylinder(Section):
    """A cylinder along z."""

    radius: float = Field(gt=0, description="Radius (mm)")
    length: float = Field(gt=0, description="Length (mm)")
    base: Annotated[tuple[float, float, float], BeforeValidator(as_tuples)] = Field(
        default=(0.0, 0.0, 0.0), description="Middle of the lower end (mm)"
    )


class Solid(Section):
    """A body filled with particles: a box or a cylinder."""

    name: str = Field(min_length=1, description="Name")
    box: Corners | None = Field(
        default=None, description="Lowest and highest corner (mm), in the plane or in space"
    )
    cylinder: Cylinder | None = Field(default=None, description="Table [body.cylinder]: a cylinder along z")
    material: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] = Field(
        description="Name in the library, path to a material file, or a table"
    )
    temperature: float | None = Field(
        default=None,
        gt=0,
        description="Initial temperature (K); the material's reference temperature unless given",
    )
    velocity: Point | None = Field(default=None, description="Initial velocity (mm/s); rest unless given")
    rigid: bool = Field(default=False, description="Whether it keeps its velocity and shape for ever")

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        if (self.box is None) == (self.cylinder is None):
            raise ValueError("box: give either box or cylinder")
        return self


class Hold(Section):
    """Particles that keep their velocity."""

    box: Corners = Field(description="Lowest and highest corner of the region of held particles (mm)")
    axes: Literal["x", "y", "z", "xy", "xz", "yz", "xyz"] = Field(
        default="xyz", description="Components that are held"
    )


class PlaneWall(Section):
    """A rigid plane without friction."""

    point: Point = Field(description="A point of the plane (mm)")
    normal: Point = Field(description="Direction towards the bodies")
    penalty: float | None = Field(
        default=None,
        gt=0,
        description="Pressure per penetration (MPa/mm); Young's modulus over the spacing unless given",
    )


class ExplicitEnd(Section):
    """Explicit time steps, as long as stability allows."""

    end: float = Field(gt=0, description="Final time (s)")


class SolidsCase(Section):
    """A whole case file of solids."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["solids"] = Field(description="Kind of problem")
    method: ParticleMethodName = Field(default="tlsph", description="Numerical method")
    body: Annotated[tuple[Solid, ...], BeforeValidator(as_tuples)] = Field(
        min_length=1, description="Tables [[body]]"
    )
    hold: Annotated[tuple[Hold, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[hold]]"
    )
    wall: Annotated[tuple[PlaneWall, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[wall]]"
    )
    particles: SolidsParticles = Field(description="Table [particles]")
    time: ExplicitEnd = Field(description="Table [time]")
    output: Output = Field(default_factory=Output, description="Table [output]")

    @model_validator(mode="after")
    def _is_of_one_dimension(self) -> Self:
        points = [("[[body]] box", each.box[0]) for each in self.body if each.box]
        points += [("[[body]] box", each.box[1]) for each in self.body if each.box]
        points += [("[[body]] velocity", each.velocity) for each in self.body if each.velocity]
        points += [("[[hold]] box", corner) for each in self.hold for corner in each.box]
        points += [("[[wall]] point", each.point) for each in self.wall]
        points += [("[[wall]] normal", each.normal) for each in self.wall]
        wrong = [
            f"{key}: given {len(point)} components, must be {self.dimension}"
            for key, point in points
            if len(point) != self.dimension
        ]
        if wrong:
            raise ValueError("\n".join(wrong))
        return self

    @model_validator(mode="after")
    def _has_its_contact(self) -> Self:
        if self.method == "tlsph" and self.particles.contact == "kernel":
            raise ValueError(
                "[particles] contact: given 'kernel'; with method = 'tlsph' bodies touch by pinballs only"
            )
        return self

    @property
    def dimension(self) -> int:
        """2 if the first body is a box in the plane, else 3."""
        box = self.body[0].box
        return 3 if box is None else len(box[0])
