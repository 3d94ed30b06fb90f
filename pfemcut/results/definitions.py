"""The figures of ``summary.json``: label, unit and definition of each, in the order of the report."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Taken(Enum):
    """How a figure comes from its history column."""

    WINDOW = "mean and standard deviation over the steady window"
    LAST = "last row"


@dataclass(frozen=True)
class Definition:
    """One figure.

    Attributes
    ----------
    name
        Key in ``summary.json`` and, unless the summary computes it, column of ``history.csv``.
    label
        What the report calls it.
    unit
        Unit; ``-`` for a pure number.
    meaning
        Definition in one sentence.
    taken
        How it comes from the history.
    """

    name: str
    label: str
    unit: str
    meaning: str
    taken: Taken = Taken.WINDOW


FIGURES = (
    Definition("cutting_force", "Cutting force", "N/mm", "Force on the tool against its motion, per width."),
    Definition(
        "thrust_force",
        "Thrust (feed) force",
        "N/mm",
        "Force that pushes the tool out of the workpiece, per width.",
    ),
    Definition("specific_energy", "Specific cutting energy", "N/mm²", "Cutting force over depth of cut."),
    Definition(
        "apparent_friction",
        "Apparent friction",
        "-",
        "Tangential over normal force on the rake face, from the two forces, so tip and flank are in it.",
    ),
    Definition(
        "chip_thickness",
        "Chip thickness",
        "mm",
        "Mean distance between the two chip surfaces, normal to the chip's rake side, "
        "from 1 to 2 depths of cut beyond the end of contact.",
    ),
    Definition(
        "chip_speed",
        "Chip speed",
        "mm/s",
        "Of the material along the chip, relative to the tool, where the thickness is measured.",
    ),
    Definition(
        "contact_length",
        "Contact length",
        "mm",
        "Along the tool from the tip circle's tangent point on the rake face to the last loaded particle.",
    ),
    Definition(
        "tip_arc_contact",
        "Loaded arc of the tip",
        "mm",
        "Along the tip circle from the rake tangent point to its last loaded particle.",
    ),
    Definition(
        "shear_angle",
        "Shear angle (chip ratio)",
        "degree",
        "atan(r cos γ / (1 − r sin γ)) with r = depth of cut / chip thickness and γ the rake angle.",
    ),
    Definition(
        "shear_angle_band",
        "Shear angle (strain-rate band)",
        "degree",
        "Line fitted to the ridge of the plastic strain rate between 0.3 and 0.9 depths above the tip.",
    ),
    Definition(
        "chip_curvature",
        "Chip curvature",
        "1/mm",
        "Of the circle through the chip's rake side from 1 to 6 depths beyond the end of contact; "
        "positive away from the rake.",
    ),
    Definition(
        "stagnation_height",
        "Stagnation height",
        "mm",
        "Above the tip's lowest point, where the sliding of the particles in contact changes sign.",
    ),
    Definition(
        "final_length",
        "Final length",
        "mm",
        "Of an impacting cylinder along its axis, over the outer particles plus one spacing.",
        Taken.LAST,
    ),
    Definition(
        "mushroom_diameter",
        "Mushroom diameter",
        "mm",
        "Twice the largest distance of a particle from the axis, plus one spacing.",
        Taken.LAST,
    ),
    Definition("max_temperature", "Maximum temperature", "K", "Of all particles of the workpiece."),
    Definition(
        "contact_end_temperature",
        "Temperature where contact ends",
        "K",
        "Of the last loaded particle on the rake face.",
    ),
    Definition(
        "hottest_along_rake",
        "Hottest point, up the rake face",
        "mm",
        "Distance of the hottest particle from the rake tangent point, along the rake face.",
    ),
    Definition(
        "hottest_from_rake",
        "Hottest point, off the rake face",
        "mm",
        "Distance of the hottest particle from the rake face.",
    ),
    Definition(
        "tool_max_temperature", "Maximum temperature of the tool", "K", "Of a tool that conducts heat."
    ),
    Definition(
        "tool_hottest_along_rake",
        "Hottest point of the tool's surface",
        "mm",
        "Distance from the rake tangent point along the rake face; negative on tip and flank.",
    ),
    Definition(
        "tool_hottest_depth",
        "Hottest point of the tool, depth",
        "mm",
        "Distance below the rake face's plane.",
    ),
    Definition(
        "tool_max_von_mises",
        "Largest von Mises stress in the tool",
        "MPa",
        "Of the stress averaged around each particle of a deformable tool.",
    ),
    Definition(
        "tool_von_mises_along_rake",
        "Where: up the rake face",
        "mm",
        "Of the largest von Mises stress, from the rake tangent point, in the tool without load.",
    ),
    Definition("tool_von_mises_depth", "Where: below the rake face", "mm", "Of the same point."),
    Definition(
        "tool_max_principal",
        "Largest principal stress in the tool",
        "MPa",
        "Tension positive, of the averaged stress.",
    ),
    Definition(
        "tool_principal_along_rake", "Where: up the rake face", "mm", "Of the largest principal stress."
    ),
    Definition("tool_principal_depth", "Where: below the rake face", "mm", "Of the same point."),
    Definition(
        "tool_min_principal",
        "Smallest principal stress in the tool",
        "MPa",
        "The largest compression, negative, of the averaged stress.",
    ),
    Definition("tool_compression_along_rake", "Where: up the rake face", "mm", "Of the largest compression."),
    Definition("tool_compression_depth", "Where: below the rake face", "mm", "Of the same point."),
    Definition(
        "tool_tip_deflection_x",
        "Deflection of the tip, x",
        "mm",
        "Mean over the tip circle, against the motion positive; from where the tool would be without load.",
    ),
    Definition("tool_tip_deflection_y", "Deflection of the tip, y", "mm", "Likewise, upwards positive."),
    Definition("peak_strain_rate", "Peak plastic strain rate", "1/s", "Largest of all elements."),
    Definition("max_eqps", "Maximum equivalent plastic strain", "-", "Largest of all elements."),
    Definition(
        "energy_error",
        "Energy ledger error",
        "-",
        "(tool work − sum of all sinks) / tool work, at the end.",
        Taken.LAST,
    ),
    Definition(
        "heat_error",
        "Heat ledger error",
        "-",
        "(sources − losses − heat content) / sources, at the end.",
        Taken.LAST,
    ),
    Definition(
        "area_drift",
        "Area drift",
        "-",
        "Sum over remeshes of (area after − before) over depth × travel.",
        Taken.LAST,
    ),
    Definition(
        "tool_heat_error",
        "Error of the tool's heat ledger",
        "-",
        "(received − lost to the holder − heat content) / received, at the end.",
        Taken.LAST,
    ),
    Definition("mass_drift", "Mass drift", "-", "Relative change of the integral of density.", Taken.LAST),
)
