"""The case file: its sections, keys, units, defaults and allowed ranges.

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator


def _planned(*names: str) -> BeforeValidator:
    """Validator that says of ``names`` that they are known but not available yet."""

    def check(value: Any) -> Any:
        if value in names:
            raise ValueError(f"'{value}' is not available yet")
        return value

    return BeforeValidator(check)


def _name_or_table(value: Any) -> Any:
    """``value`` if it can name or describe a material."""
    if not isinstance(value, str | dict):
        raise ValueError(f"given {value!r}, must be a name in the library, a path or a table")
    return value


class Section(BaseModel):
    """What all sections share: immutable, no unknown keys, no guessing of types, finite numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Workpiece(Section):
    """The block that is cut: [0, length] x [0, height], fixed at the bottom and held at x = 0."""

    length: float = Field(gt=0, description="Length along the cut (mm)")
    height: float = Field(gt=0, description="Height (mm)")
    material: Annotated[str | dict[str, Any], BeforeValidator(_name_or_table)] = Field(
        description="Name in the library, path to a material file, or a table"
    )
    temperature: float | None = Field(
        default=None,
        gt=0,
        description="Initial temperature (K); the material's reference temperature unless given",
    )


class Tool(Section):
    """The tool: a wedge rounded by a tip circle, advancing towards -x."""

    model: Annotated[Literal["rigid"], _planned("deformable")] = Field(
        default="rigid", description="How the tool is modelled"
    )
    rake: float = Field(default=0.0, gt=-45, lt=45, description="Rake angle (degrees)")
    clearance: float = Field(default=5.0, gt=0, lt=45, description="Clearance angle (degrees)")
    tip_radius: float = Field(gt=0, description="Radius of the tip circle (mm)")


class Cutting(Section):
    """The motion of the tool."""

    speed: float = Field(gt=0, description="Cutting speed (mm/s)")
    depth: float = Field(
        gt=0, description="Uncut chip thickness, top surface to lowest point of the tip (mm)"
    )
    travel: float = Field(gt=0, description="Travel of the tool from first contact (mm)")


class Contact(Section):
    """Contact between tool and workpiece."""

    friction: float = Field(default=0.0, ge=0, le=2, description="Coulomb coefficient (dimensionless)")
    reference_speed: float = Field(
        default=1.0, gt=0, description="Sliding speed that regularises friction (mm/s)"
    )
    penalty: float = Field(default=4e7, gt=0, description="Contact pressure per penetration (MPa/mm)")
    heat_partition: float = Field(
        default=0.5, ge=0, le=1, description="Fraction of the friction heat that enters the workpiece"
    )


class Mesh(Section):
    """Particle spacing h, and when particles are inserted and removed (factors are relative to h)."""

    tip_size: float = Field(default=0.005, gt=0, description="Spacing at the tool tip (mm)")
    shear_zone_size: float = Field(default=0.012, gt=0, description="Spacing in the primary shear zone (mm)")
    chip_size: float = Field(default=0.02, gt=0, description="Largest spacing in the chip (mm)")
    surface_size: float = Field(
        default=0.02, gt=0, description="Largest spacing below the machined surface (mm)"
    )
    far_size: float = Field(default=0.4, gt=0, description="Largest spacing anywhere (mm)")
    growth: float = Field(
        default=0.08, gt=0, le=1, description="Increase of the spacing per distance from a zone"
    )
    remesh: bool = Field(default=True, description="Whether particles are triangulated anew each step")
    insert: bool = Field(default=True, description="Whether particles are inserted")
    remove: bool = Field(default=True, description="Whether particles are removed")
    boundary_split: float = Field(
        default=1.45, gt=1, le=4, description="A boundary edge longer than this times h is split"
    )
    boundary_removal: float = Field(
        default=0.35, ge=0, lt=1, description="A boundary edge shorter than this times h is collapsed"
    )
    interior_radius: float = Field(
        default=0.95, gt=0.5, le=4, description="A triangle with a circumradius above this times h is refined"
    )
    interior_area: float = Field(
        default=0.65, gt=0.3, le=8, description="A triangle with an area above this times h² is refined"
    )
    interior_spacing: float = Field(
        default=0.55, gt=0, lt=1, description="A new particle keeps this times h from the others"
    )
    interior_removal: float = Field(
        default=0.45, ge=0, lt=1, description="A particle closer than this times h to another is removed"
    )
    power_tolerance: float = Field(
        default=0.004,
        gt=0,
        le=1,
        description="A triangle with more than this fraction of plastic power is refined",
    )
    power_smallest: float = Field(
        default=0.5, gt=0, le=1, description="Refinement by plastic power stops at this times h"
    )


class Time(Section):
    """Time steps and integrator."""

    step: float = Field(gt=0, description="Nominal time step (s)")
    integrator: Literal["impl-ex", "implicit"] = Field(
        default="impl-ex", description="Integrator of the plastic flow in the momentum solve"
    )
    heat_source: Literal["implicit", "extrapolated"] = Field(
        default="implicit", description="Plastic multiplier that heats"
    )
    inertia: bool = Field(default=False, description="Whether the momentum balance has its inertia term")
    first_step_fraction: float = Field(
        default=0.25, gt=0, le=1, description="First step, as a fraction of the nominal one"
    )
    growth: float = Field(default=1.25, gt=1, le=4, description="Largest ratio of a step to the one before")
    smallest_step_fraction: float = Field(
        default=1e-3, gt=0, le=1, description="A run that needs a smaller fraction of the nominal step stops"
    )


class Solver(Section):
    """Newton iteration and stabilisation of the momentum solve."""

    tolerance: float = Field(default=1e-6, gt=0, lt=1, description="Relative tolerance of the residual")
    max_iterations: int = Field(default=15, ge=2, description="Iterations after which the step is halved")
    stabilisation: float = Field(
        default=1.0, gt=0, description="Factor alpha_s of the polynomial pressure projection"
    )


class Output(Section):
    """What is written, where and how often."""

    directory: str = Field(default="out", min_length=1, description="Folder of the results")
    every: int = Field(default=200, ge=1, description="Steps between frames of the fields")
    history_every: int = Field(default=1, ge=1, description="Steps between rows of history.csv")
    checkpoint_every: int = Field(default=500, ge=1, description="Steps between checkpoints")
    figures: bool = Field(default=True, description="Whether figures are drawn at the end")


class Case(Section):
    """A whole case file."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["cutting"] = Field(default="cutting", description="Kind of problem")
    method: Annotated[Literal["pfem"], _planned("sph", "lattice", "peridynamics")] = Field(
        default="pfem", description="Numerical method"
    )
    workpiece: Workpiece = Field(description="Table [workpiece]: the block that is cut")
    tool: Tool = Field(description="Table [tool]")
    cutting: Cutting = Field(description="Table [cutting]: the motion of the tool")
    contact: Contact = Field(default_factory=Contact, description="Table [contact]")
    mesh: Mesh = Field(default_factory=Mesh, description="Table [mesh]: particle spacing")
    time: Time = Field(description="Table [time]: time steps")
    solver: Solver = Field(default_factory=Solver, description="Table [solver]")
    output: Output = Field(default_factory=Output, description="Table [output]")

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        wrong = [
            f"[{table}] {key}: given {given}, must be less than {limit_name} = {limit:g}"
            for table, key, given, limit_name, limit in (
                ("cutting", "depth", self.cutting.depth, "[workpiece] height", self.workpiece.height),
                ("cutting", "travel", self.cutting.travel, "[workpiece] length", self.workpiece.length),
                # Otherwise the halves of a split edge are collapsed at once, and a new particle removed.
                (
                    "mesh",
                    "boundary_removal",
                    self.mesh.boundary_removal,
                    "half of [mesh] boundary_split",
                    self.mesh.boundary_split / 2.0,
                ),
                (
                    "mesh",
                    "interior_removal",
                    self.mesh.interior_removal,
                    "[mesh] interior_spacing",
                    self.mesh.interior_spacing,
                ),
            )
            if given >= limit
        ]
        if wrong:
            raise ValueError("\n".join(wrong))
        return self
