"""The case file of an orthogonal cut: its sections, keys, units, defaults and allowed ranges.

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from pfemcut.case.particles import CuttingMethod, Particles
from pfemcut.case.sections import (
    Contact,
    CuttingSolver,
    Output,
    Section,
    SelfContact,
    Spacing,
    Time,
    ToolHeat,
    name_or_table,
)


class Workpiece(Section):
    """The block that is cut: [0, length] x [0, height], fixed at the bottom; at x = 0 it is held or free."""

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
    end: Literal["held", "free"] = Field(
        default="held",
        description="Whether u_x = 0 on x = 0; a free end is one through which the tool may leave (travel > length)",
    )


class ToolBody(Section):
    """The body of a deformable tool, whose supports move with the cutting speed."""

    material: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] = Field(
        description="Name in the library, path to a material file, or a table; elastic or elastic-plastic"
    )
    width: float = Field(default=1.0, gt=0, description="From the tip circle's centre to the back (mm)")
    height: float = Field(
        default=1.0, gt=0, description="From the lowest point of the tip circle to the top (mm)"
    )
    supports: Literal["top and back", "top", "back"] = Field(
        default="top and back", description="Sides that the tool is held at"
    )
    tip_size: float = Field(default=0.004, gt=0, description="Spacing of the mesh at the tip (mm)")
    face_size: float = Field(
        default=0.01,
        gt=0,
        description="Largest spacing on the first three depths of cut of the rake face (mm)",
    )
    growth: float = Field(default=0.15, gt=0, le=1, description="Increase of the spacing per distance")
    contact_points: Literal["nodes", "edges"] = Field(
        default="nodes",
        description="Where contact acts: at the particles of the workpiece, or at Gauss points of its edges",
    )
    smooth: bool = Field(
        default=True,
        description="Whether contact sees a smooth curve through the tool's particles, or its edges",
    )


class Tool(ToolHeat):
    """The tool: a wedge rounded by a tip circle, advancing towards -x."""

    model: Literal["rigid", "deformable"] = Field(default="rigid", description="How the tool is modelled")
    body: ToolBody | None = Field(
        default=None, description="Table [tool.body]: the body of a deformable tool"
    )
    rake: float = Field(default=0.0, gt=-45, lt=45, description="Rake angle (degrees)")
    clearance: float = Field(default=5.0, gt=0, lt=45, description="Clearance angle (degrees)")
    tip_radius: float = Field(gt=0, description="Radius of the tip circle (mm)")
    wear: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] | None = Field(
        default=None,
        description="Constants of Usui's wear rate: name in the library, path to a file, or a table "
        "`{ A = …, B = … }`, see [tool_profiles.md](tool_profiles.md); they change no result of the run",
    )

    @model_validator(mode="after")
    def _has_a_body_if_it_deforms(self) -> Self:
        wrong = []
        if self.model == "deformable" and self.body is None:
            wrong.append("model: 'deformable' needs a table [tool.body]")
        if self.model == "deformable" and self.conduction is not None:
            wrong.append("conduction: a deformable tool conducts by its material")
        if self.model == "rigid" and self.body is not None:
            wrong.append("body: only of a deformable tool")
        if self.body is not None and self.body.height <= 2.0 * self.tip_radius:
            wrong.append(f"body: height must be more than two tip radii, {2.0 * self.tip_radius:g}")
        if self.body is not None and self.body.width <= 2.0 * self.tip_radius:
            wrong.append(f"body: width must be more than two tip radii, {2.0 * self.tip_radius:g}")
        if wrong:
            raise ValueError("\n".join(wrong))
        return self


class Cutting(Section):
    """The motion of the tool."""

    speed: float = Field(gt=0, description="Cutting speed (mm/s)")
    depth: float = Field(
        gt=0, description="Uncut chip thickness, top surface to lowest point of the tip (mm)"
    )
    travel: float = Field(gt=0, description="Travel of the tool from first contact (mm)")
    chip_length: float | None = Field(
        default=None,
        gt=0,
        description="Length of the chip, along its rake side from the tool's tip, at which it is cut off whenever it "
        "is a quarter longer (mm), with its mass, heat and energy booked; not cut off unless given",
    )


class After(Section):
    """What comes after the cut: the tool withdraws, and the workpiece cools down and is let go if wished."""

    withdrawal: float | None = Field(
        default=None,
        gt=0,
        description="Way of the tool, equally far from rake and flank face (mm); two depths of cut unless given",
    )
    cool: bool = Field(
        default=True,
        description="Whether the workpiece cools down, with bottom and held end at the surroundings' temperature",
    )
    temperature: float | None = Field(
        default=None,
        gt=0,
        description="Of the surroundings (K); the workpiece's initial temperature unless given",
    )
    cooling_time: float | None = Field(
        default=None,
        gt=0,
        description="How long it cools (s); unless given, 20 times the square of the height (of the travel if that is "
        "more) over the diffusivity",
    )
    cooling_steps: int = Field(
        default=60, ge=5, le=2000, description="Steps of the cooling, which grow geometrically"
    )
    convection: float = Field(
        default=0.0,
        ge=0,
        description="Heat transfer coefficient of the other faces (N/(mm s K); 1e-3 of the number in W/(m² K))",
    )
    release: bool = Field(
        default=False,
        description="Whether bottom and held end are let go at last, but for the two lower corners",
    )


class Mesh(Spacing):
    """Particle spacing h near the tool, and when particles are inserted and removed."""

    tip_size: float = Field(default=0.005, gt=0, description="Spacing at the tool tip (mm)")
    shear_zone_size: float = Field(default=0.012, gt=0, description="Spacing in the primary shear zone (mm)")
    chip_size: float = Field(default=0.02, gt=0, description="Largest spacing in the chip (mm)")
    surface_size: float = Field(
        default=0.02, gt=0, description="Largest spacing below the machined surface (mm)"
    )
    surface_length: float | None = Field(
        default=None,
        gt=0,
        description="How far behind the tool surface_size holds, the spacing growing beyond (mm); all the way unless "
        "given",
    )
    far_size: float = Field(default=0.4, gt=0, description="Largest spacing anywhere (mm)")
    growth: float = Field(
        default=0.08, gt=0, le=1, description="Increase of the spacing per distance from a zone"
    )


class CuttingContact(Contact):
    """Contact between tool and workpiece."""

    self: SelfContact = Field(
        default_factory=SelfContact, description="Table [contact.self]: contact of the workpiece with itself"
    )


class Case(Section):
    """A whole case file."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["cutting"] = Field(default="cutting", description="Kind of problem")
    method: CuttingMethod = Field(default="pfem", description="Numerical method")
    workpiece: Workpiece = Field(description="Table [workpiece]: the block that is cut")
    tool: Tool = Field(description="Table [tool]")
    cutting: Cutting = Field(description="Table [cutting]: the motion of the tool")
    after: After | None = Field(default=None, description="Table [after]: unloading and cooling")
    contact: CuttingContact = Field(default_factory=CuttingContact, description="Table [contact]")
    mesh: Mesh = Field(default_factory=Mesh, description="Table [mesh]: particle spacing")
    particles: Particles | None = Field(
        default=None, description="Table [particles]: explicit particles; of the other methods than the PFEM"
    )
    time: Time = Field(description="Table [time]: time steps")
    solver: CuttingSolver = Field(default_factory=CuttingSolver, description="Table [solver]")
    output: Output = Field(default_factory=Output, description="Table [output]")

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        wrong = [
            f"[{table}] {key}: given {given}, must be less than {limit_name} = {limit:g}"
            for table, key, given, limit_name, limit in (
                ("cutting", "depth", self.cutting.depth, "[workpiece] height", self.workpiece.height),
                ("cutting", "travel", self.cutting.travel, "[workpiece] length", self.workpiece.length),
            )
            if given >= limit and not (key == "travel" and self.workpiece.end == "free")
        ]
        if wrong:
            raise ValueError("\n".join(wrong))
        return self
