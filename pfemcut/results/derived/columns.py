"""The derived history columns of a cut: what the driver adds to the method's own columns in every history row."""

from __future__ import annotations

import math

from pfemcut.method import Frame
from pfemcut.problem import Cut
from pfemcut.results.derived.chip_curl import REACH, curl_radius
from pfemcut.results.derived.chip_section import chip_section
from pfemcut.results.derived.chip_speed import chip_speed
from pfemcut.results.derived.chip_thickness import chip_thickness
from pfemcut.results.derived.contact_length import contact_end_temperature, tip_arc_contact
from pfemcut.results.derived.extremes import hottest_point, peak_strain_rate
from pfemcut.results.derived.shear_angle import shear_angle_of_band, shear_angle_of_ratio
from pfemcut.results.derived.stagnation import stagnation_height
from pfemcut.results.derived.tool_state import tool_columns


def derived_columns(frame: Frame, cut: Cut) -> dict[str, float]:
    """Return the derived columns of one instant, always the same keys in the same order; nan where undefined."""
    tool = frame.tool[0]
    section = chip_section(frame, tool, cut.depth)
    thickness = chip_thickness(section)
    radius = curl_radius(chip_section(frame, tool, cut.depth, REACH))
    along, away = hottest_point(frame, tool)
    return {
        "chip_thickness": thickness.mean,
        "chip_complete": float(thickness.complete),
        "chip_speed": chip_speed(section, tool, (-cut.speed, 0.0)),
        "tip_arc_contact": tip_arc_contact(frame.contact, tool, frame.surface_offset),
        "shear_angle": shear_angle_of_ratio(cut.depth, thickness.mean, tool.rake),
        "shear_angle_band": shear_angle_of_band(frame, tool, cut.depth),
        # Curvature, not radius: the mean of radii that pass through infinity means nothing.
        "chip_curvature": math.nan if math.isnan(radius) else 1.0 / radius,
        "stagnation_height": stagnation_height(frame, tool, (-cut.speed, 0.0)),
        "peak_strain_rate": peak_strain_rate(frame),
        "contact_end_temperature": contact_end_temperature(frame),
        "hottest_along_rake": along,
        "hottest_from_rake": away,
        **tool_columns(frame),
    }
