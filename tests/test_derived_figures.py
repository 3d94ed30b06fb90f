"""Derived figures against cuts whose answers are known exactly."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from synthetic_cut import CUT, DEPTH, TIP, filled_frame, from_rake_frame, outline_frame, tool_of

from pfemcut.method import ContactView
from pfemcut.results.derived.chip_curl import REACH, curl_radius
from pfemcut.results.derived.chip_section import chip_section, to_rake_frame
from pfemcut.results.derived.chip_speed import chip_speed
from pfemcut.results.derived.chip_thickness import chip_thickness
from pfemcut.results.derived.columns import derived_columns
from pfemcut.results.derived.contact_length import contact_end_temperature, contact_length, tip_arc_contact
from pfemcut.results.derived.friction import apparent_friction
from pfemcut.results.derived.profiles import tool_profile
from pfemcut.results.derived.rays import first_crossing
from pfemcut.results.derived.shear_angle import shear_angle_of_band, shear_angle_of_ratio
from pfemcut.results.derived.stagnation import stagnation_height
from pfemcut.results.derived.steady_window import steady_window

RAKES = [0.0, 6.0, -10.0, 25.0]


@pytest.mark.parametrize("rake", RAKES)
@pytest.mark.parametrize("thickness", [0.12, 0.25])
def test_a_straight_chip_has_its_thickness(rake: float, thickness: float) -> None:
    frame = outline_frame(rake, thickness)
    found = chip_thickness(chip_section(frame, tool_of(rake), DEPTH))
    assert found.mean == pytest.approx(thickness, rel=1e-9)
    assert found.complete


@pytest.mark.parametrize("rake", RAKES)
@pytest.mark.parametrize("curl", [0.6, 2.0])
def test_a_curled_chip_has_the_thickness_of_the_ring_and_its_radius(rake: float, curl: float) -> None:
    # Measured along the rake's normal this ring would be 2 to 8 % too thick.
    frame = outline_frame(rake, 0.15, curl=curl)
    section = chip_section(frame, tool_of(rake), DEPTH)
    assert chip_thickness(section).mean == pytest.approx(0.15, rel=2e-3)
    assert section.complete
    far = chip_section(frame, tool_of(rake), DEPTH, REACH)
    assert curl_radius(far) == pytest.approx(curl, rel=1e-3)


@pytest.mark.parametrize("curl", [math.inf, 0.6])
def test_particles_are_measured_at_their_surface(curl: float) -> None:
    """A chip 0.15 mm thick, filled with particles 0.01 mm apart, the outermost half of that from its surface."""
    tool, half = tool_of(6.0), 0.005
    # What a mesh with nodes on the outermost particles would be: the same chip, thinner by a spacing.
    inner = outline_frame(6.0, 0.14, curl=curl - half)
    points = inner.points + half * tool.rake_normal
    cloud = replace(inner, points=points, surface_offset=half)
    section = chip_section(cloud, tool, DEPTH)
    assert chip_thickness(section).mean == pytest.approx(0.15, rel=2e-3)
    assert chip_thickness(chip_section(inner, tool, DEPTH)).mean == pytest.approx(0.14, rel=2e-3)
    far = chip_section(cloud, tool, DEPTH, REACH)
    assert 1.0 / curl_radius(far) == pytest.approx(1.0 / curl, rel=1e-3, abs=1e-6)
    assert np.abs(section.rake_side[:, 1]).max() < 1e-9 or math.isfinite(curl)


@pytest.mark.parametrize("rake", RAKES)
def test_contact_of_particles_reaches_half_a_spacing_farther(rake: float) -> None:
    frame, tool = outline_frame(rake, 0.15, contact=0.18), tool_of(rake)
    arc = tip_arc_contact(frame.contact, tool)
    assert contact_length(frame.contact, 0.005) == pytest.approx(0.185, rel=1e-9)
    assert tip_arc_contact(frame.contact, tool, 0.005) == pytest.approx(arc + 0.005)
    assert tip_arc_contact(frame.contact, tool, 1.0) == tool.tip_radius * tool.arc_angle
    none = ContactView(np.array([0]), np.array([-0.01]), np.array([0.0]), np.array([0.0]))
    assert (contact_length(none, 0.005), tip_arc_contact(none, tool, 0.005)) == (0.0, 0.0)


def test_curl_of_a_straight_chip_is_infinite_and_its_sign_says_which_way() -> None:
    assert abs(curl_radius(chip_section(outline_frame(6.0, 0.15), tool_of(6.0), DEPTH, REACH))) > 1e4
    section = chip_section(outline_frame(6.0, 0.15, curl=1.0), tool_of(6.0), DEPTH, REACH)
    towards = replace(section, rake_side=section.rake_side * [1.0, -1.0])
    assert curl_radius(towards) == pytest.approx(-1.0, rel=1e-3)


@pytest.mark.parametrize("rake", RAKES)
def test_chip_speed_is_that_along_the_chip_relative_to_the_tool(rake: float) -> None:
    frame, tool = outline_frame(rake, 0.15), tool_of(rake)
    up_the_rake = 1500.0 * tool.rake_direction + [-3000.0, 0.0]
    moving = replace(
        frame, point_fields={**frame.point_fields, "velocity": np.tile(up_the_rake, (len(frame.points), 1))}
    )
    section = chip_section(moving, tool, DEPTH)
    assert chip_speed(section, tool, (-3000.0, 0.0)) == pytest.approx(1500.0, rel=1e-9)
    assert math.isnan(
        chip_speed(chip_section(outline_frame(rake, 0.15, length=0.1), tool, DEPTH), tool, (0.0, 0.0))
    )


@pytest.mark.parametrize("rake", RAKES)
def test_a_body_that_touches_the_chip_is_not_taken_for_it(rake: float) -> None:
    """A tongue of the workpiece at rest, a thousandth of the chip's thickness off its free side."""
    frame, tool = outline_frame(rake, 0.15), tool_of(rake)
    count = len(frame.points)
    s = np.linspace(0.12, 0.5, 200)
    tongue = np.vstack(
        [
            from_rake_frame(tool, s, np.full(200, 0.15 + 1.5e-4)),
            from_rake_frame(tool, s[::-1], np.full(200, 0.4)),
        ]
    )
    points = np.vstack([frame.points, tongue])
    up_the_rake = 1500.0 * tool.rake_direction + [-3000.0, 0.0]
    velocity = np.vstack([np.tile(up_the_rake, (count, 1)), np.zeros_like(tongue)])
    touched = replace(
        frame, points=points, loops=(np.arange(len(points)),), point_fields={"velocity": velocity}
    )
    section, alone = (chip_section(each, tool, DEPTH) for each in (touched, frame))
    np.testing.assert_allclose(section.thickness, alone.thickness, rtol=1e-12)
    assert chip_speed(section, tool, (-3000.0, 0.0)) == pytest.approx(1500.0, rel=1e-9)


def test_a_rough_surface_changes_the_mean_thickness_little() -> None:
    frame = outline_frame(6.0, 0.15, curl=1.0)
    rough = (
        np.random.default_rng(0).normal(scale=0.002, size=(len(frame.points), 1)) * tool_of(6.0).rake_normal
    )
    found = chip_thickness(chip_section(replace(frame, points=frame.points + rough), tool_of(6.0), DEPTH))
    assert found.mean == pytest.approx(0.15, rel=0.02)


@pytest.mark.parametrize("rake", RAKES)
def test_a_short_chip_is_measured_in_part_and_flagged_or_not_at_all(rake: float) -> None:
    tool = tool_of(rake)
    part = chip_thickness(chip_section(outline_frame(rake, 0.15, length=0.25), tool, DEPTH))
    assert part.mean == pytest.approx(0.15, rel=1e-9)
    assert not part.complete
    none = chip_thickness(chip_section(outline_frame(rake, 0.15, length=0.15), tool, DEPTH))
    assert math.isnan(none.mean)
    assert not none.complete


def test_a_ray_through_a_shared_corner_meets_the_surface_once() -> None:
    starts, ends = np.array([[1.0, -1.0], [1.0, 0.0]]), np.array([[1.0, 0.0], [1.0, 1.0]])
    ray = np.zeros((1, 2)), np.array([[1.0, 0.0]])
    assert first_crossing(*ray, starts, ends, outward=True)[0].tolist() == [1.0]
    assert np.isinf(first_crossing(*ray, starts, ends, outward=False)[0]).all()


@pytest.mark.parametrize("rake", RAKES)
def test_contact_length_runs_from_the_tangent_point_and_the_tip_arc_the_other_way(rake: float) -> None:
    frame = outline_frame(rake, 0.15, contact=0.18)
    assert contact_length(frame.contact) == pytest.approx(0.18, rel=1e-9)
    assert tip_arc_contact(frame.contact, tool_of(rake)) == pytest.approx(
        0.5 * TIP * tool_of(rake).arc_angle, rel=0.1
    )


def test_particles_without_pressure_and_the_flank_do_not_count() -> None:
    tool = tool_of(0.0)
    arc = np.array([-0.2, -0.01, 0.05, 0.3])
    view = ContactView(np.arange(4), arc, np.array([5.0, 1.0, 1.0, 0.0]), np.zeros(4))
    assert contact_length(view) == 0.05
    assert tip_arc_contact(view, tool) == pytest.approx(TIP * tool.arc_angle)
    lonely = ContactView(np.arange(0), arc[:0], arc[:0], arc[:0])
    assert (contact_length(lonely), tip_arc_contact(lonely, tool)) == (0.0, 0.0)


def test_contact_end_temperature_is_that_of_the_last_loaded_particle() -> None:
    frame = outline_frame(6.0, 0.15)
    s = to_rake_frame(frame.points, tool_of(6.0))
    last = np.flatnonzero(np.hypot(s[:, 0] - 0.15, s[:, 1]) < 1e-9)[0]
    assert contact_end_temperature(frame) == frame.point_fields["temperature"][last]


def test_profile_is_sorted_along_the_tool() -> None:
    profile = tool_profile(outline_frame(0.0, 0.15))
    assert (np.diff(profile.arc_length) > 0.0).all()
    assert (np.diff(profile.pressure) < 0.0).all()
    assert profile.shear == pytest.approx(0.1 * profile.pressure)


def test_shear_angle_of_the_chip_ratio() -> None:
    assert shear_angle_of_ratio(0.1, 0.1, 0.0) == pytest.approx(45.0)
    # Without change of thickness the shear plane halves the angle between uncut material and rake face.
    assert shear_angle_of_ratio(0.1, 0.1, 10.0) == pytest.approx(45.0 + 5.0)
    assert shear_angle_of_ratio(0.1, 0.25, 0.0) == pytest.approx(math.degrees(math.atan(0.4)))
    assert math.isnan(shear_angle_of_ratio(0.1, math.nan, 0.0))


@pytest.mark.parametrize("rake", [0.0, 6.0, -10.0])
@pytest.mark.parametrize("angle", [25.0, 35.0, 45.0])
def test_shear_angle_of_the_band_is_that_of_the_ridge(rake: float, angle: float) -> None:
    frame = filled_frame(rake, 0.15, shear_angle=angle, spacing=0.01)
    assert shear_angle_of_band(frame, tool_of(rake), DEPTH) == pytest.approx(angle, abs=1.5)


def test_stagnation_height_is_where_the_sliding_changes_sign() -> None:
    frame = outline_frame(0.0, 0.15)
    # Sliding grows linearly with height and changes sign 0.01 mm above the lowest point.
    arc = frame.contact.arc_length
    tool = tool_of(0.0)
    height = frame.points[:, 1] + TIP
    normal = tool.closest(frame.points).normal
    tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
    velocity = 1e4 * (height - 0.01)[:, None] * tangent + [-CUT.speed, 0.0]
    moving = replace(frame, point_fields={**frame.point_fields, "velocity": velocity})
    assert arc.min() < -0.01
    assert stagnation_height(moving, tool, (-CUT.speed, 0.0)) == pytest.approx(0.01, rel=1e-6)
    assert math.isnan(stagnation_height(frame, tool, (0.0, -1.0)))


@pytest.mark.parametrize("rake", RAKES)
def test_apparent_friction_of_a_coulomb_contact_is_its_coefficient(rake: float) -> None:
    tool = tool_of(rake)
    force = 100.0 * (-tool.rake_normal) + 30.0 * tool.rake_direction
    assert apparent_friction(np.array(force[0]), np.array(force[1]), rake) == pytest.approx(0.3)


def travel_and_force(end: float, slope: float = 0.0, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    travel = np.linspace(0.0, end, 2001)[1:]
    ripple = noise * np.sqrt(2.0) * np.sin(np.arange(travel.size))
    return travel, 200.0 * (1.0 + slope * (travel - end) + ripple)


@pytest.mark.parametrize(("end", "begin"), [(1.0, 0.75), (0.36, 0.26), (0.3, 0.2)])
def test_window_is_the_last_quarter_at_least_a_tenth_and_never_the_first_two(
    end: float, begin: float
) -> None:
    window = steady_window(*travel_and_force(end))
    assert window.begin == pytest.approx(begin)
    assert window.steady
    assert window.mean(np.full(2000, 7.0)) == pytest.approx(7.0)


@pytest.mark.parametrize(
    ("slope", "noise", "reason"),
    [(0.12, 0.0, "drifts"), (0.06, 0.0, ""), (0.0, 0.034, "scatters"), (0.0, 0.026, "")],
)
def test_drift_and_scatter_have_their_limits(slope: float, noise: float, reason: str) -> None:
    window = steady_window(*travel_and_force(1.0, slope, noise))
    assert (window.steady, reason in window.reason) == (not reason, True)


def test_a_short_cut_is_averaged_but_not_steady() -> None:
    window = steady_window(*travel_and_force(0.1))
    assert not window.steady
    assert window.mean(np.full(2000, 3.0)) == pytest.approx(3.0)


def test_halved_steps_do_not_count_double() -> None:
    travel = np.concatenate([np.arange(0.0, 0.9, 0.01), np.arange(0.9, 1.0, 0.001), [1.0]])
    force = np.where(travel < 0.9, 100.0, 200.0)
    window = steady_window(travel, force)
    assert window.mean(force) == pytest.approx(100.0 + 100.0 * 0.4, rel=0.03)


def test_rows_without_a_value_are_left_out_of_the_mean() -> None:
    travel, force = travel_and_force(1.0)
    gaps = np.where(np.arange(2000) % 2 == 0, np.nan, 5.0)
    assert steady_window(travel, force).mean(gaps) == pytest.approx(5.0)


def test_derived_columns_are_cheap_and_keep_their_keys() -> None:
    frame = filled_frame(6.0, 0.15, spacing=0.014)
    columns = derived_columns(frame, CUT)
    assert columns["chip_thickness"] == pytest.approx(0.15, rel=1e-3)
    begin = time.perf_counter()
    for _ in range(5):
        derived_columns(frame, CUT)
    assert (time.perf_counter() - begin) / 5 < 0.05
    assert list(derived_columns(outline_frame(6.0, 0.15), CUT)) == list(columns)
