"""The case file of an orthogonal cut: its sections, keys, units, defaults and allowed ranges.

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from pfemcut.case.sections import (
    Contact,
    Method,
    Output,
    Section,
    Solver,
    Spacing,
    Time,
    ToolHeat,
    name_or_table,
    planned,
)


class Workpiece(Section):
    """The block that is cut: [0, length] x [0, height], fixed at the bottom and held at x = 0."""

    length: float = Field(gt=0, description="Length along the cut (mm)")
    height: float = Field(gt=0, description="Height (mm)")
    material: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] = Field(
        description="Name in the library, path to a material file, or a table"
    )
    temperature: float | None = Field(
        default=None,
        gt=0,
        description="Initial temperature (K); the material's reference temperature unless given",
    )


class Tool(ToolHeat):
    """The tool: a wedge rounded by a tip circle, advancing towards -x."""

    model: Annotated[Literal["rigid"], planned("deformable")] = Field(
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


class Mesh(Spacing):
    """Particle spacing h near the tool, and when particles are inserted and removed."""

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


class Case(Section):
    """A whole case file."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["cutting"] = Field(default="cutting", description="Kind of problem")
    method: Method = Field(default="pfem", description="Numerical method")
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
            )
            if given >= limit
        ]
        if wrong:
            raise ValueError("\n".join(wrong))
        return self
