"""Segments of serrated chips against saw-tooth chips drawn to measure, and forces made of known oscillations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from synthetic_cut import CUT, DEPTH, contact_of, from_rake_frame, outline_frame, tool_of

from pfemcut.method import Array, Frame
from pfemcut.results.derived.segmentation import (
    Profile,
    force_oscillation,
    segmentation,
    thickness_profile,
)

SPEED = 8000.0
PITCH, PEAK, VALLEY = 0.08, 0.13, 0.07


def saw_tooth(s: Array, rise: float = 0.5) -> Array:
    """Thickness that rises from valley to peak over the part ``rise`` of each pitch, and falls over the rest."""
    place = (s / PITCH) % 1.0
    return VALLEY + (PEAK - VALLEY) * np.where(place < rise, place / rise, (1.0 - place) / (1.0 - rise))


def serrated_frame(rake: float, rise: float, curl: float = np.inf, length: float = 0.9) -> Frame:
    """The smooth chip of ``outline_frame`` with a saw-toothed free side."""
    smooth, tool = outline_frame(rake, 0.1), tool_of(rake)
    s = np.linspace(0.0, length, 1800)
    bent = np.isfinite(curl)
    angle = s / curl if bent else 0.0 * s

    def side(distance: Array) -> Array:
        if not bent:
            return from_rake_frame(tool, 0.15 + s, distance)
        return from_rake_frame(
            tool, 0.15 + (curl - distance) * np.sin(angle), curl - (curl - distance) * np.cos(angle)
        )

    front = from_rake_frame(tool, np.linspace(0.0, 0.15, 60), np.zeros(60))
    free_in = from_rake_frame(
        tool, np.linspace(0.0, 0.149, 60), saw_tooth(np.linspace(-0.15, -0.001, 60), rise)
    )
    free_in = free_in[free_in[:, 1] > CUT.surface + 1e-6]
    loop = smooth.points
    tip = np.flatnonzero(np.hypot(*(loop - tool.rake_tangent_point).T) < 1e-9)[0]
    points = np.vstack([loop[:tip], front, side(0.0 * s)[1:], side(saw_tooth(s, rise))[::-1], free_in[::-1]])
    fields = {
        name: np.zeros((len(points), 2)) if name == "velocity" else np.zeros(len(points))
        for name in smooth.point_fields
    }
    return replace(
        smooth,
        points=points,
        loops=(np.arange(len(points)),),
        point_fields=fields,
        contact=contact_of(points, tool, 0.15),
    )


@pytest.mark.parametrize("rake", [0.0, 10.0])
@pytest.mark.parametrize("rise", [0.5, 0.8])
def test_a_straight_saw_tooth_chip_has_its_measures(rake: float, rise: float) -> None:
    """Spacing to 1 %, thicknesses to 2 % of the depth: a ray samples each tooth at steps of a fiftieth of it."""
    found = segmentation(thickness_profile(serrated_frame(rake, rise), tool_of(rake), DEPTH), DEPTH, SPEED)
    assert found.count >= 8
    assert found.spacing == pytest.approx(PITCH, rel=0.01)
    assert found.spacing_std < 0.03 * PITCH
    assert found.peak == pytest.approx(PEAK, abs=0.02 * DEPTH)
    assert found.valley == pytest.approx(VALLEY, abs=0.02 * DEPTH)
    assert found.degree == pytest.approx((PEAK - VALLEY) / PEAK, abs=0.02)
    assert found.mean == pytest.approx(0.5 * (PEAK + VALLEY), rel=0.01)
    assert found.frequency == pytest.approx(SPEED * DEPTH / (PITCH * 0.5 * (PEAK + VALLEY)), rel=0.02)


def test_a_curled_saw_tooth_chip_has_its_measures_too() -> None:
    found = segmentation(
        thickness_profile(serrated_frame(0.0, 0.5, curl=0.5), tool_of(0.0), DEPTH), DEPTH, SPEED
    )
    assert found.count >= 6
    assert found.spacing == pytest.approx(PITCH, rel=0.02)
    assert found.degree == pytest.approx((PEAK - VALLEY) / PEAK, abs=0.03)


@pytest.mark.parametrize("curl", [np.inf, 0.6])
def test_a_smooth_chip_has_no_segments(curl: float) -> None:
    frame = outline_frame(0.0, 0.15, curl=curl)
    found = segmentation(thickness_profile(frame, tool_of(0.0), DEPTH), DEPTH, SPEED)
    assert found.count == 0
    assert math.isnan(found.degree)
    assert math.isnan(found.frequency)


def test_roughness_below_the_prominence_is_no_segment() -> None:
    along = np.linspace(0.1, 0.9, 400)
    rough = Profile(along, 0.15 + 0.002 * np.sin(along * 300.0))
    assert segmentation(rough, DEPTH, SPEED).count == 0


def test_frequency_and_swing_of_an_oscillating_force() -> None:
    """Frequency to 2 % with seven and a half periods in the record; a drift is none of the oscillation."""
    steps = np.random.default_rng(1).uniform(0.5, 1.5, 1500)
    time = np.cumsum(steps) / steps.sum() * 1e-4
    frequency = 7.5e4
    force = 150.0 + 2e5 * time + 20.0 * np.sin(2.0 * np.pi * frequency * time)
    found = force_oscillation(time, force)
    assert found.spectral_frequency == pytest.approx(frequency, rel=0.02)
    assert found.spectral_share > 0.95
    assert found.cycle_frequency == pytest.approx(frequency, rel=0.02)
    assert found.cycles == 7
    assert found.swing == pytest.approx(40.0, rel=0.1)
    assert found.mean == pytest.approx(160.0, rel=0.02)


def test_a_constant_force_does_not_oscillate() -> None:
    time = np.linspace(0.0, 1e-4, 300)
    found = force_oscillation(time, np.full(300, 120.0))
    assert found.mean == 120.0
    assert found.cycles == 0
    assert math.isnan(found.swing)
