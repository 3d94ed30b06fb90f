"""What the page shows of the folder ``figures`` and of tables beside it, in which section and with which words.

Whoever adds a picture (``figures/NAME.png``) or a table (``NAME.csv`` in the output directory) adds a line here. A
picture without a line is shown among the further figures, under its file's name.
"""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from pfemcut.output.report.text import number


class Section(Enum):
    """Sections of the page that hold pictures, in order; the value is the anchor."""

    FORCES = "forces"
    FIELDS = "fields"
    TOOL = "along-the-tool"
    SURFACE = "machined-surface"
    LEDGERS = "ledgers"
    CONVERGENCE = "convergence"
    FURTHER = "further"


@dataclass(frozen=True)
class Picture:
    """A picture: file in the folder of the figures, section, and the caption under it."""

    file: str
    section: Section
    caption: str


@dataclass(frozen=True)
class Table:
    """A table: CSV file relative to the output directory, section, and the caption over it."""

    file: str
    section: Section
    caption: str


@dataclass(frozen=True)
class FoundTable:
    """The content of a table that a run has."""

    caption: str
    file: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left_out: int


PICTURES = (
    Picture("load.png", Section.FORCES, "Mean force of the grips against the elongation between them."),
    Picture(
        "damage.png",
        Section.FIELDS,
        "Fraction of broken bonds of the sites at the end, displacements enlarged; the dashed line through each hole "
        "or crack is along the fibre.",
    ),
    Picture(
        "forces.png",
        Section.FORCES,
        "Forces on the tool per mm of width against its travel. The figures are means over the shaded window, where "
        "dashed lines show them.",
    ),
    Picture(
        "chip.webp",
        Section.FIELDS,
        "Formation of the chip (temperature), seen from the tool. All frames have the colour scale of the last.",
    ),
    Picture("energies.png", Section.LEDGERS, "What the work of the grips became, stacked."),
    Picture("temperature.png", Section.FIELDS, "Temperature at the end."),
    Picture("plastic_strain.png", Section.FIELDS, "Equivalent plastic strain, averaged to the particles."),
    Picture("strain_rate.png", Section.FIELDS, "Equivalent plastic strain rate, over four decades."),
    Picture("von_mises.png", Section.FIELDS, "Von Mises stress of the stress averaged to the particles."),
    Picture("mesh_tip.png", Section.FIELDS, "Strain rate near the tip with the mesh over it."),
    Picture("mesh.png", Section.FIELDS, "Mesh of the cutting zone."),
    Picture("tool_von_mises.png", Section.TOOL, "Von Mises stress in the tool."),
    Picture("tool_principal.png", Section.TOOL, "Largest principal stress in the tool, tension positive."),
    Picture("tool_temperature.png", Section.TOOL, "Temperature of the tool."),
    Picture(
        "profiles.png",
        Section.TOOL,
        "Contact pressure, shear traction and temperature along the tool at the last instant, from the rake face's "
        "tangent point; each dot is a particle in contact.",
    ),
    Picture(
        "tool_profiles.png",
        Section.TOOL,
        "Along the tool, means over the instants recorded in the steady window; bands are one standard deviation to "
        "each side.",
    ),
    Picture(
        "residual.png",
        Section.SURFACE,
        "Residual stress, plastic strain and temperature below the machined surface; bands are one standard deviation "
        "along the window.",
    ),
    Picture(
        "residual_field.png",
        Section.SURFACE,
        "Residual stress along the cut at the end, and the window of the profiles.",
    ),
    Picture("burr.png", Section.SURFACE, "Exit burr, with its height and thickness."),
    Picture(
        "energy.png",
        Section.LEDGERS,
        "Above, what the tool's work became, stacked; below, the part that no account explains.",
    ),
    Picture(
        "heat.png",
        Section.LEDGERS,
        "Above, where the heat went, stacked; below, the part that no account explains.",
    ),
    Picture("particles.png", Section.CONVERGENCE, "Particles, and how many of them come and go in a step."),
    Picture(
        "convergence.png", Section.CONVERGENCE, "Newton iterations and size of each step, with those halved."
    ),
)

TABLES: tuple[Table, ...] = (
    Table(
        "tool_profiles.csv",
        Section.TOOL,
        "Profiles along the tool (mm, N/mm², mm/s, K): means over the recorded instants of the steady window",
    ),
    Table(
        "residual.csv",
        Section.SURFACE,
        "Profiles below the machined surface (mm, MPa, K) after unloading, and cooling if wished",
    ),
)

MOST_ROWS = 60


def found_pictures(figures: Path) -> dict[Section, list[Picture]]:
    """Return the pictures that are in the folder ``figures``, by section; unknown ones are further figures."""
    present = {path.name for path in figures.glob("*") if path.suffix in (".png", ".webp")}
    known = [picture for picture in PICTURES if picture.file in present]
    others = sorted(present - {picture.file for picture in PICTURES})
    known += [
        Picture(name, Section.FURTHER, Path(name).stem.replace("_", " ").capitalize() + ".")
        for name in others
    ]
    return {section: [each for each in known if each.section is section] for section in Section}


def found_tables(directory: Path) -> dict[Section, list[FoundTable]]:
    """Return the tables that a run has, by section; of long ones the first rows."""
    found: dict[Section, list[FoundTable]] = {section: [] for section in Section}
    for table in TABLES:
        path = directory / table.file
        if not os.path.isfile(path):
            continue
        with path.open(encoding="utf-8", newline="") as file:
            header, *rows = list(csv.reader(file)) or [[]]
        shown = tuple(tuple(_cell(text) for text in row) for row in rows[:MOST_ROWS])
        found[table.section].append(
            FoundTable(table.caption, table.file, tuple(header), shown, len(rows) - len(shown))
        )
    return found


def _cell(text: str) -> str:
    """A cell with numbers to four digits."""
    try:
        return number(float(text), 4)
    except (ValueError, OverflowError):
        return text
