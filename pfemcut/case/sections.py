"""Sections that all kinds of case files share.

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

from pfemcut.contact.friction_laws import FrictionTable
from pfemcut.input_table import InputTable


def planned(*names: str) -> BeforeValidator:
    """Validator that says of ``names`` that they are known but not available yet."""

    def check(value: Any) -> Any:
        if value in names:
            raise ValueError(f"'{value}' is not available yet")
        return value

    return BeforeValidator(check)


def name_or_table(value: Any) -> Any:
    """``value`` if it can name or describe a material or another entry of a library."""
    if not isinstance(value, str | dict):
        raise ValueError(f"given {value!r}, must be a name in the library, a path or a table")
    return value


def as_tuples(value: Any) -> Any:
    """Lists as tuples, also within each other: TOML has no tuples, and the schema guesses no types."""
    return tuple(as_tuples(each) for each in value) if isinstance(value, list) else value


class Section(InputTable):
    """What all sections share."""


class Conduction(Section):
    """Heat conduction in a rigid tool: a block of its own, held at the tool's temperature on the holder's side."""

    conductivity: float = Field(gt=0, description="Thermal conductivity (N/(s K))")
    capacity: float = Field(gt=0, description="Specific heat (mm²/(s² K))")
    density: float = Field(gt=0, lt=1e-6, description="Density (tonne/mm³)")
    length: float = Field(
        default=2.0, gt=0, description="Length of rake and flank faces, from the tip to the holder (mm)"
    )
    fine_length: float = Field(
        default=0.3, gt=0, description="Length of the rake face along which the mesh is finest (mm)"
    )
    tip_size: float = Field(default=0.01, gt=0, description="Finest spacing (mm)")
    growth: float = Field(default=0.15, gt=0, le=1, description="Increase of the spacing per distance")

    @model_validator(mode="after")
    def _is_longer_than_fine(self) -> Self:
        if self.fine_length >= self.length:
            raise ValueError(
                f"fine_length: given {self.fine_length}, must be less than length = {self.length:g}"
            )
        return self


class ToolHeat(Section):
    """What all rigid tools have to do with heat."""

    temperature: float = Field(
        default=293.15,
        gt=0,
        description="Temperature of the tool (K), which takes heat through [contact] conductance; "
        "with [tool.conduction] that of its start and of its holder",
    )
    conduction: Conduction | None = Field(
        default=None, description="Table [tool.conduction]: heat conduction in the tool"
    )


class ConductanceTable(Section):
    """Conductance of the interface that depends on the contact pressure, value (p / reference_pressure)^exponent."""

    value: float = Field(ge=0, description="Conductance at the reference pressure (N/(mm s K))")
    reference_pressure: float = Field(gt=0, description="Reference pressure (MPa)")
    exponent: float = Field(default=0.95, ge=0, le=2, description="Exponent of the pressure (dimensionless)")


def _form(value: Any) -> str:
    # Not "table", which is the name of a friction law.
    return "by law" if isinstance(value, dict | BaseModel) else "number"


Friction = Annotated[
    Annotated[float, Field(ge=0, le=2), Tag("number")] | Annotated[FrictionTable, Tag("by law")],
    Discriminator(_form),
]
ConductanceOrTable = Annotated[
    Annotated[float, Field(ge=0), Tag("number")] | Annotated[ConductanceTable, Tag("by law")],
    Discriminator(_form),
]


class Contact(Section):
    """Contact between tool and workpiece."""

    friction: Friction = Field(
        default=0.0, description="Coulomb coefficient (dimensionless), or a table of a friction law"
    )
    reference_speed: float = Field(
        default=1.0, gt=0, description="Sliding speed that regularises friction (mm/s)"
    )
    penalty: float = Field(default=4e7, gt=0, description="Contact pressure per penetration (MPa/mm)")
    heat_partition: float = Field(
        default=0.5, ge=0, le=1, description="Fraction of the friction heat that enters the workpiece"
    )
    conductance: ConductanceOrTable = Field(
        default=0.0,
        description="Heat conductance of the interface (N/(mm s K); 1e-3 of the number in W/(m² K)), or a table; "
        "zero insulates",
    )


class SelfContact(Section):
    """Contact of a body with itself, such as chip with chip and chip with workpiece."""

    enabled: bool = Field(
        default=True, description="Whether it is treated; else the run ends where a body touches itself"
    )
    thickness: float | None = Field(
        default=None,
        gt=0,
        description="Distance at which surfaces touch (mm); unless given, a quarter of [mesh] chip_size in a cut, or "
        "of [mesh] size",
    )
    penalty: float | None = Field(
        default=None,
        gt=0,
        description="Contact pressure per closure (MPa/mm); unless given, Young's modulus / (20 thickness)",
    )
    friction: float = Field(default=0.0, ge=0, le=2, description="Coulomb coefficient (dimensionless)")
    reference_speed: float = Field(
        default=1.0, gt=0, description="Sliding speed that regularises friction (mm/s)"
    )
    conductance: ConductanceOrTable | None = Field(
        default=None,
        description="Heat conductance of the interface (N/(mm s K)), or a table; that of [contact] unless given",
    )


class Spacing(Section):
    """When particles are inserted and removed; factors are relative to the spacing h."""

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
    coarsening: Literal["none", "plastic-strain", "stress"] = Field(
        default="none",
        description="Error estimator (Zienkiewicz-Zhu) that removes particles where it finds no error in material "
        "without plastic flow that has left the fine zones",
    )
    coarsening_tolerance: float = Field(
        default=0.05,
        gt=0,
        le=1,
        description="Error, relative to the largest value of the field, below which the spacing may grow; "
        "the temperature's must be below a tenth of it",
    )
    coarsening_largest: float = Field(
        default=3.0, ge=1, le=20, description="Largest spacing by the estimator, relative to h"
    )
    volumetric_history: Literal["auto", "increment", "pressure", "element", "mixed"] = Field(
        default="auto",
        description="Source of an element's volume ratio: the particles' pressure, with the stabilisation on its "
        "increment or on the whole, the element before it, or the latter as long as the element does not change; "
        "auto takes the increment if remesh, else the element",
    )
    transfer: Literal["sample", "mean", "linear"] = Field(
        default="linear",
        description="What a changed element takes from the old ones in its place: the value at its Gauss point, or "
        "the mean over its area of values that are constant or linear in each",
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

    @model_validator(mode="after")
    def _does_not_fight_itself(self) -> Self:
        # Otherwise the halves of a split edge are collapsed at once, and a new particle removed.
        wrong = [
            f"{key}: given {given}, must be less than {limit_name} = {limit:g}"
            for key, given, limit_name, limit in (
                (
                    "boundary_removal",
                    self.boundary_removal,
                    "half of boundary_split",
                    self.boundary_split / 2.0,
                ),
                ("interior_removal", self.interior_removal, "interior_spacing", self.interior_spacing),
            )
            if given >= limit
        ]
        if wrong:
            raise ValueError("\n".join(wrong))
        return self


class Time(Section):
    """Time steps and integrator."""

    step: float = Field(gt=0, description="Nominal time step (s)")
    largest_step: float | None = Field(
        default=None,
        gt=0,
        description="Steps grow up to this where plastic flow allows it (s); the nominal step unless given",
    )
    step_tolerance: float = Field(
        default=0.1,
        gt=0,
        le=1,
        description="Part of the plastic power that a step longer than the nominal one may move between elements",
    )
    integrator: Literal["impl-ex", "implicit"] = Field(
        default="implicit", description="Integrator of the plastic flow in the momentum solve"
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

    @model_validator(mode="after")
    def _largest_is_not_below_nominal(self) -> Self:
        if self.largest_step is not None and self.largest_step < self.step:
            raise ValueError(
                f"largest_step: given {self.largest_step:g}, must be at least step = {self.step:g} (s)"
            )
        return self


class Solver(Section):
    """Newton iteration and stabilisation of the momentum solve."""

    tolerance: float = Field(default=1e-6, gt=0, lt=1, description="Relative tolerance of the residual")
    max_iterations: int = Field(default=15, ge=2, description="Iterations after which the step is halved")
    stabilisation: float = Field(
        default=1.0, gt=0, description="Factor alpha_s of the polynomial pressure projection"
    )
    stabilisation_modulus: Literal["auto", "elastic", "secant"] = Field(
        default="auto",
        description="Shear modulus that scales the projection: the material's, or in elements that flow the secant of "
        "stress over strain; auto takes the secant where the pressure's increment is stabilised, else the material's",
    )


class CuttingSolver(Solver):
    """The same for a cut, whose steps don't pass on what is left of the residual: one per mille moves no figure."""

    tolerance: float = Field(default=1e-3, gt=0, lt=1, description="Relative tolerance of the residual")


class Output(Section):
    """What is written, where and how often."""

    directory: str = Field(default="out", min_length=1, description="Folder of the results")
    every: int = Field(default=200, ge=1, description="Steps between frames of the fields")
    history_every: int = Field(default=1, ge=1, description="Steps between rows of history.csv")
    checkpoint_every: int = Field(default=500, ge=1, description="Steps between checkpoints")
    figures: bool = Field(default=True, description="Whether figures are drawn at the end")


Method = Annotated[Literal["pfem"], planned("sph", "lattice", "peridynamics")]
