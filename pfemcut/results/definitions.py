"""The figures of ``summary.json``: label, unit and definition of each, in the order of the report."""

from __future__ import annotations

from pfemcut.results.definition import Definition, Taken


def _left(name: str, label: str, unit: str, meaning: str) -> Definition:
    return Definition(name, label, unit, meaning, Taken.FRAME)


SURFACE_FIGURES = (
    _left(
        "residual_surface_xx",
        "Residual stress at the surface, xx",
        "MPa",
        "Along the cut, at depth 0; mean and standard deviation along the machined surface.",
    ),
    _left("residual_surface_zz", "Residual stress at the surface, zz", "MPa", "Likewise out of plane."),
    _left(
        "residual_surface_yy",
        "Residual stress at the surface, yy",
        "MPa",
        "Likewise normal to the surface: zero, if the mesh resolved it.",
    ),
    _left(
        "residual_compression",
        "Smallest residual stress, xx",
        "MPa",
        "Of the mean profile: the largest compression, if negative.",
    ),
    _left(
        "residual_compression_depth",
        "Where: below the surface",
        "mm",
        "Depth of the smallest residual stress.",
    ),
    _left(
        "residual_tension", "Largest residual stress, xx", "MPa", "Of the mean profile: the largest tension."
    ),
    _left(
        "residual_tension_depth", "Where: below the surface", "mm", "Depth of the largest residual stress."
    ),
    _left(
        "residual_affected_depth",
        "Depth affected by residual stress",
        "mm",
        "Below it the size of xx stays under a tenth of its largest.",
    ),
    _left(
        "surface_plastic_strain",
        "Plastic strain at the surface",
        "-",
        "Equivalent plastic strain at depth 0; mean and standard deviation along the machined surface.",
    ),
    _left(
        "deformed_depth", "Deformed depth", "mm", "Below it the equivalent plastic strain stays under 0.01."
    ),
    _left(
        "residual_section_force",
        "Force of a section",
        "N/mm",
        "Integral of xx from the bottom to the machined surface, which the clamps carry; 0 if they let go.",
    ),
    _left("residual_section_size", "Force of a section, of sizes", "N/mm", "The same of the size of xx."),
    _left(
        "residual_window_begin",
        "Window of the machined surface, begin",
        "mm",
        "x of its end near the tool: two depths of cut behind the tool's last place.",
    ),
    _left(
        "residual_window_end",
        "Window of the machined surface, end",
        "mm",
        "x of its end near the entry: the larger of 0.2 mm and two depths of cut from the edge.",
    ),
    _left("residual_warmest", "Temperature left", "K", "Largest of the mean profile."),
    _left(
        "burr_height",
        "Burr height",
        "mm",
        "From the end face, along the cut, to the neck at which the chip hangs on the burr.",
    ),
    _left(
        "burr_root_thickness",
        "Burr thickness at the root",
        "mm",
        "Vertical thickness where the burr leaves the end face.",
    ),
    _left(
        "burr_neck_thickness", "Burr thickness at the neck", "mm", "Vertical thickness where the chip begins."
    ),
    _left("burr_overhang", "Overhang", "mm", "Farthest material from the end face, with the chip."),
)


def _end(name: str, label: str, unit: str, meaning: str) -> Definition:
    return Definition(name, label, unit, meaning, Taken.END)


LAMINA_FIGURES = (
    _end(
        "young_modulus",
        "Young's modulus along the pull",
        "MPa",
        "Stress over the whole section against the strain of the middle half, before the first bond breaks.",
    ),
    _end("peak_load", "Peak load", "N", "Largest mean of the two grips' forces over a batch of steps."),
    _end("peak_elongation", "Elongation at the peak", "mm", "Of the plate between the grips."),
    *(
        definition
        for number, name in ((1, "First"), (2, "Second"))
        for definition in (
            _end(
                f"crack_{number}_start_x",
                f"{name} crack, start along the pull",
                "mm",
                "Middle of its first broken matrix bonds, from the plate's middle.",
            ),
            _end(f"crack_{number}_start_y", f"{name} crack, start across", "mm", "Likewise."),
            _end(
                f"crack_{number}_angle",
                f"{name} crack, angle",
                "degree",
                "From the pull, of the line that fits its broken bonds best.",
            ),
            _end(f"crack_{number}_length", f"{name} crack, length", "mm", "Along that line."),
        )
    ),
    _end(
        "parts",
        "Parts",
        "-",
        "Pieces that whole bonds hold together in the inner 95 % of the length; the grips hold all.",
    ),
    _end("broken_matrix_bonds", "Broken matrix bonds", "-", "Since the start."),
    _end("broken_fibre_bonds", "Broken fibre bonds", "-", "Since the start."),
    _end("fracture_energy", "Energy of broken bonds", "mJ", "What bonds held when they broke."),
)

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
        "from 1 to 2 depths of cut beyond the end of contact. Surfaces of particles without a mesh lie half a spacing "
        "outside of the outermost ones.",
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
        "Along the tool from the tip circle's tangent point on the rake face to the last loaded particle. "
        "Half a spacing farther for particles without a mesh.",
    ),
    Definition(
        "tip_arc_contact",
        "Loaded arc of the tip",
        "mm",
        "Along the tip circle from the rake tangent point to its last loaded particle. "
        "Half a spacing farther for particles without a mesh.",
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
    Definition(
        "profile_cutting_force",
        "Cutting force of the tool profiles",
        "N/mm",
        "What pressure and shear along the tool add up to at the instants that the profiles are means of.",
        Taken.INSTANTS,
    ),
    Definition(
        "profile_thrust_force", "Thrust force of the tool profiles", "N/mm", "Likewise.", Taken.INSTANTS
    ),
    Definition(
        "crater_wear_rate",
        "Largest wear rate on the rake face",
        "mm/s",
        "By Usui's law, with the constants of the case, of a fresh tool at the temperature of this cut.",
        Taken.INSTANTS,
    ),
    Definition(
        "crater_wear_position",
        "Where: up the rake face",
        "mm",
        "Of the largest mean wear rate, from the rake tangent point.",
        Taken.INSTANTS,
    ),
    Definition(
        "edge_wear_rate",
        "Largest wear rate on the edge",
        "mm/s",
        "Likewise, on the tip circle's arc.",
        Taken.INSTANTS,
    ),
    Definition(
        "flank_wear_rate",
        "Mean wear rate on the flank face",
        "mm/s",
        "Likewise, mean over the length of the flank that is in contact at any instant.",
        Taken.INSTANTS,
    ),
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
    *SURFACE_FIGURES,
    *LAMINA_FIGURES,
)
