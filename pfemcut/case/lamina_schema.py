"""The case file of a composite lamina in tension (``problem = "lamina"``).

Units: mm, tonne, s, K (so N, MPa, mJ); angles in degrees, from the direction of the pull.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from pfemcut.case.sections import Output, Section, as_tuples, name_or_table

Place = Annotated[tuple[float, float], BeforeValidator(as_tuples)]


class HoleTable(Section):
    """A round hole."""

    radius: float = Field(gt=0, description="Radius (mm)")
    centre: Place = Field(default=(0.0, 0.0), description="Middle, from that of the plate (mm)")


class LineCrackTable(Section):
    """A straight crack without width."""

    length: float = Field(gt=0, description="Length (mm)")
    angle: float = Field(default=90.0, ge=-180, le=180, description="Angle from the pull (degrees)")
    centre: Place = Field(default=(0.0, 0.0), description="Middle, from that of the plate (mm)")


class LaminaPlate(Section):
    """The plate, a rectangle with its middle at the origin that is pulled along x."""

    length: float = Field(gt=0, description="Length between the grips (mm)")
    width: float = Field(gt=0, description="Width (mm)")
    thickness: float = Field(default=1.0, gt=0, description="Thickness (mm)")
    fibre_angle: float = Field(ge=-180, le=180, description="Angle of the fibre from the pull (degrees)")
    grip: float | None = Field(
        default=None, gt=0, description="Length that each grip holds (mm); two spacings unless given"
    )
    material: Annotated[str | dict[str, Any], BeforeValidator(name_or_table)] = Field(
        description="Name in the library of laminae, path to a file, or a table"
    )


class Lattice(Section):
    """Lattice, failure of its bonds, and time steps."""

    spacing: float = Field(gt=0, description="Distance R of nearest sites (mm)")
    criterion: Literal["mixed-mode", "stretch", "none"] = Field(
        default="mixed-mode",
        description="When matrix bonds break: by the traction on a plane along the fibre, by their own stretch, or "
        "never",
    )
    growth: bool = Field(
        default=True,
        description="Whether bonds at a crack's tip break by the energy that the lattice releases, not by their own; "
        "mixed-mode only",
    )
    fibres_break: bool = Field(default=False, description="Whether fibre bonds break too")
    damping: float = Field(
        default=0.0,
        ge=0,
        le=0.2,
        description="Time constant of a dashpot beside each spring, over R / wave speed (dimensionless)",
    )
    courant: float = Field(
        default=0.5, gt=0, le=0.8, description="Time step over R / wave speed along the fibre"
    )
    mass_scaling: float = Field(default=1.0, ge=1, description="Factor on inertia, for longer time steps")
    batch: int = Field(
        default=100, ge=1, description="Time steps that count as one step of history and output"
    )


class PullTable(Section):
    """The motion of the grips, from the start at constant speed."""

    speed: float = Field(gt=0, description="Speed of the grips relative to each other (mm/s)")
    elongation: float = Field(gt=0, description="Final elongation between the grips (mm)")
    grips: Literal["clamped", "sliding"] = Field(
        default="clamped", description="Whether the plate slides in the grips across the pull"
    )
    protected: float = Field(
        default=0.0,
        ge=0,
        description="Distance from the grips within which no bond breaks (mm); rigid grips crack the corners of a "
        "plate that is pulled at an angle to its fibre",
    )


class LaminaCase(Section):
    """A whole case file of a lamina."""

    title: str = Field(default="", description="One line for reports")
    problem: Literal["lamina"] = Field(description="Kind of problem")
    method: Literal["pd-lattice"] = Field(default="pd-lattice", description="Numerical method")
    lamina: LaminaPlate = Field(description="Table [lamina]: the plate")
    hole: Annotated[tuple[HoleTable, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[hole]]"
    )
    crack: Annotated[tuple[LineCrackTable, ...], BeforeValidator(as_tuples)] = Field(
        default=(), description="Tables [[crack]]"
    )
    lattice: Lattice = Field(description="Table [lattice]")
    pull: PullTable = Field(description="Table [pull]")
    output: Output = Field(default_factory=Output, description="Table [output]")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        half = (0.5 * self.lamina.length, 0.5 * self.lamina.width)
        wrong = []
        for number, hole in enumerate(self.hole):
            if any(abs(x) + hole.radius >= limit for x, limit in zip(hole.centre, half, strict=True)):
                wrong.append(
                    f"hole[{number}]: given radius {hole.radius:g} round {list(hole.centre)}, must lie in the plate, "
                    f"which reaches to {list(half)}"
                )
        for number, crack in enumerate(self.crack):
            turn = math.radians(crack.angle)
            reach = (0.5 * crack.length * abs(math.cos(turn)), 0.5 * crack.length * abs(math.sin(turn)))
            if any(abs(x) + r >= limit for x, r, limit in zip(crack.centre, reach, half, strict=True)):
                wrong.append(
                    f"crack[{number}]: given length {crack.length:g} round {list(crack.centre)}, must lie in the "
                    f"plate, which reaches to {list(half)}"
                )
        smallest = min(self.lamina.length, self.lamina.width)
        if self.lattice.spacing > smallest / 8.0:
            wrong.append(
                f"[lattice] spacing: given {self.lattice.spacing:g}, must be at most an eighth of the plate's smaller "
                f"side, {smallest / 8.0:g}"
            )
        if self.pull.elongation > 0.1 * self.lamina.length:
            wrong.append(
                f"[pull] elongation: given {self.pull.elongation:g}, must be at most a tenth of the plate's length, "
                f"{0.1 * self.lamina.length:g}"
            )
        if self.pull.protected >= half[0]:
            wrong.append(
                f"[pull] protected: given {self.pull.protected:g}, must be less than half the plate's length, "
                f"{half[0]:g}"
            )
        if wrong:
            raise ValueError("\n".join(wrong))
        return self
