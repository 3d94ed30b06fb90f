"""Segments of serrated chips against saw-tooth chips drawn to measure, and forces made of known oscillations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from synthetic_cut import CUT, DEPTH, TIP, contact_of, from_rake_frame, outline_frame, tool_of

from pfemcut.method import Array, Frame
from pfemcut.results.derived.segmentation import (
    Profile,
    Segmentation,
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


UNCUT = 0.11
"""Length of uncut surface that a tooth was made from (mm)."""


def serrated_frame(
    rake: float, rise: float, curl: float = np.inf, length: float = 0.9, lean: float = 0.0, lift: float = 0.0
) -> Frame:
    """The smooth chip of ``outline_frame`` with a saw-toothed free side, whose teeth hang over by ``lean`` (mm).

    The uncut surface ahead is lifted by ``lift`` (mm).
    """
    smooth, tool = outline_frame(rake, 0.1), tool_of(rake)
    s = np.linspace(0.0, length, 1800)

    def side(along: Array, distance: Array) -> Array:
        if not np.isfinite(curl):
            return from_rake_frame(tool, 0.15 + along, distance)
        angle = along / curl
        return from_rake_frame(
            tool, 0.15 + (curl - distance) * np.sin(angle), curl - (curl - distance) * np.cos(angle)
        )

    thickness = saw_tooth(s, rise)
    free_side = side(s + lean * (thickness - VALLEY) / (PEAK - VALLEY), thickness)[::-1]
    rake_side = np.vstack(
        [from_rake_frame(tool, np.linspace(0.0, 0.15, 60), np.zeros(60)), side(s, 0.0 * s)[1:]]
    )
    ahead = np.column_stack([np.linspace(-0.3, -3.0, 50), np.full(50, CUT.surface + lift)])
    block = np.array([[-3.0, -1.0], [3.0, -1.0], [3.0, -TIP]])
    points = np.vstack([rake_side, free_side, ahead, block])
    # What was the uncut surface: teeth at their distance in it, growing against the cutting direction.
    initial = points.copy()
    initial[: len(rake_side), 1] = CUT.surface - DEPTH
    initial[-len(block) - len(ahead) : -len(block), 1] = CUT.surface
    first = len(rake_side)
    initial[first : first + len(s)] = np.column_stack([UNCUT / PITCH * s[::-1], np.full(len(s), CUT.surface)])
    count = len(points)
    fields = {name: np.zeros(count) for name in smooth.point_fields} | {
        "velocity": np.zeros((count, 2)),
        "displacement": points - initial,
    }
    return replace(
        smooth,
        points=points,
        loops=(np.arange(count),),
        point_fields=fields,
        contact=contact_of(points, tool, 0.15),
    )


def measured(frame: Frame, rake: float) -> Segmentation:
    return segmentation(thickness_profile(frame, tool_of(rake), CUT), DEPTH, SPEED)


@pytest.mark.parametrize("rake", [0.0, 10.0])
@pytest.mark.parametrize(("rise", "lean"), [(0.5, 0.0), (0.8, 0.0), (0.8, 0.04)])
def test_a_straight_saw_tooth_chip_has_its_measures(rake: float, rise: float, lean: float) -> None:
    """To 1 %, as particles lie within 1 % of a tooth of its extremes; even where the teeth hang over their valleys."""
    found = measured(serrated_frame(rake, rise, lean=lean), rake)
    assert found.count >= 8
    assert found.spacing == pytest.approx(PITCH, rel=0.01)
    assert found.spacing_std < 0.02 * PITCH
    assert found.peak == pytest.approx(PEAK, rel=0.01)
    assert found.valley == pytest.approx(VALLEY, rel=0.02)
    assert found.degree == pytest.approx((PEAK - VALLEY) / PEAK, abs=0.01)
    assert found.uncut == pytest.approx(UNCUT, rel=0.01)
    assert found.frequency == pytest.approx(SPEED / UNCUT, rel=0.01)


def test_a_curled_saw_tooth_chip_has_its_measures_too() -> None:
    found = measured(serrated_frame(0.0, 0.5, curl=0.5), 0.0)
    assert found.count >= 6
    assert found.spacing == pytest.approx(PITCH, rel=0.02)
    assert found.degree == pytest.approx((PEAK - VALLEY) / PEAK, abs=0.02)
    assert found.frequency == pytest.approx(SPEED / UNCUT, rel=0.01)


def test_the_uncut_surface_is_no_chip_wherever_it_lies() -> None:
    """Even where no foot lies below 1.2 depths: nothing is thicker than a tooth, to 1 %."""
    profile = thickness_profile(serrated_frame(0.0, 0.5, lift=0.1), tool_of(0.0), CUT)
    assert profile.thickness.max() == pytest.approx(PEAK, rel=0.01)
    assert segmentation(profile, DEPTH, SPEED).count >= 8


@pytest.mark.parametrize("curl", [np.inf, 0.6])
def test_a_smooth_chip_has_no_segments(curl: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(__name__ + ".PEAK", VALLEY + 1e-9)
    found = measured(serrated_frame(0.0, 0.5, curl=curl), 0.0)
    assert found.count == 0
    assert math.isnan(found.degree)
    assert math.isnan(found.frequency)


def test_roughness_below_the_prominence_is_no_segment() -> None:
    along = np.linspace(0.1, 0.9, 400)
    rough = Profile(along, 0.15 + 0.002 * np.sin(along * 300.0), along)
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
