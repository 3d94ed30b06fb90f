"""Segments of a serrated chip: spacing, peak and valley thickness, frequency (from the chip, and from the force).

**From the chip.** The thickness profile h(s): at distances s along the chip's rake side, from the rake tangent point
to the end of the chip, the distance to its free side, normal to the chord over a quarter depth (as for
:mod:`pfemcut.results.derived.chip_thickness`). Peaks and valleys are its local extremes that stand out by more than
5 % of the depth of cut; a segment lies between two valleys, so the one being formed and the first are not counted.

- degree of segmentation G = (h_peak - h_valley) / h_peak, of the mean peak and the mean valley (Schulz, Abele, Sahm
  2001, CIRP Annals 50, 45-48);
- spacing: mean distance between valleys along the rake side;
- frequency = V depth / (spacing × mean thickness between the first and the last valley): by conservation of volume
  the chip passes at V depth / thickness.

**From the force.** Its time history is resampled evenly and freed from its linear trend. The frequency is the highest
peak of its power spectrum (Hann's window) above two periods in the record; and one over the mean interval between
maxima that stand out by more than the history's standard deviation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import detrend, find_peaks

from pfemcut.method import Frame
from pfemcut.results.derived.chip_section import section_at, to_rake_frame
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]

PROMINENCE = 0.05
"""How far an extreme of the thickness stands out, in depths."""
SPACING = 0.02
"""Distance between the stations of the profile, in depths."""
SAMPLES = 4096
PADDING = 8
"""Zeros behind the force, in lengths of the record: they interpolate the spectrum."""
FEWEST_PERIODS = 2.0


@dataclass(frozen=True)
class Profile:
    """Thickness of the chip (mm) at places along its rake side (mm from the rake tangent point); shape (k,)."""

    along: Array
    thickness: Array


@dataclass(frozen=True)
class Segmentation:
    """Segments of a chip; all nan without two valleys.

    Attributes
    ----------
    count
        Segments between the first and the last valley.
    spacing, spacing_std
        Of valleys along the rake side: mean and standard deviation (mm).
    peak, valley
        Mean thickness at peaks and at valleys (mm).
    mean
        Mean thickness between the first and the last valley (mm).
    frequency
        Segments per second (1/s).
    """

    count: int
    spacing: float
    spacing_std: float
    peak: float
    valley: float
    mean: float
    frequency: float

    @property
    def degree(self) -> float:
        """Degree of segmentation, (peak - valley) / peak."""
        return (self.peak - self.valley) / self.peak


@dataclass(frozen=True)
class Oscillation:
    """Oscillation of a force; frequencies (1/s) are nan where there is none.

    Attributes
    ----------
    mean, std
        Of the force over time (N/mm).
    swing
        Mean of maxima less mean of minima (N/mm); nan with fewer than two of each.
    spectral_frequency, spectral_share
        Frequency of the highest peak of the spectrum, and the part of the force's variance within one
        resolution (two over the record) on either side of it.
    cycles, cycle_frequency
        Intervals between maxima, and one over their mean.
    """

    mean: float
    std: float
    swing: float
    spectral_frequency: float
    spectral_share: float
    cycles: int
    cycle_frequency: float


def thickness_profile(frame: Frame, tool: RigidWedge, depth: float) -> Profile:
    """The chip's thickness along its rake side, from one depth above the rake tangent point to one before its end."""
    points = to_rake_frame(frame.points, tool)
    nearest = [int(np.argmin(np.hypot(*points[loop].T))) for loop in frame.loops]
    at = [np.hypot(*points[loop[first]]) for loop, first in zip(frame.loops, nearest, strict=True)]
    chosen = int(np.argmin(at))
    line = np.roll(frame.loops[chosen], -nearest[chosen])
    edges = np.hypot(*np.diff(points[line], axis=0).T)
    stations = np.arange(depth, float(edges.sum()), SPACING * depth)
    section, along = section_at(frame, tool, depth, line, stations)
    # Beyond the first gap the rays run from the free side.
    gaps = np.flatnonzero(np.diff(along) > 1.5 * SPACING * depth)
    count = int(gaps[0]) + 1 if gaps.size else len(along)
    return Profile(along[:count], section.thickness[:count])


def segmentation(profile: Profile, depth: float, speed: float) -> Segmentation:
    """Segments of a chip with the thickness ``profile``, cut at ``depth`` (mm) with ``speed`` (mm/s)."""
    thickness, along = profile.thickness, profile.along
    limit = PROMINENCE * depth
    valleys, _ = find_peaks(-thickness, prominence=limit)
    if len(valleys) < 2:
        return Segmentation(0, *[math.nan] * 6)
    within = slice(int(valleys[0]), int(valleys[-1]) + 1)
    peaks = [int(a + np.argmax(thickness[a:b])) for a, b in zip(valleys[:-1], valleys[1:], strict=True)]
    spacing = np.diff(along[valleys])
    # The stations are evenly spaced.
    mean = float(thickness[within].mean())
    return Segmentation(
        count=len(peaks),
        spacing=float(spacing.mean()),
        spacing_std=float(spacing.std()),
        peak=float(thickness[peaks].mean()),
        valley=float(thickness[valleys].mean()),
        mean=mean,
        frequency=speed * depth / (float(spacing.mean()) * mean),
    )


def force_oscillation(time: Array, force: Array) -> Oscillation:
    """Oscillation of a ``force`` (n,) (N/mm) known at increasing ``time`` (n,) (s)."""
    even = np.linspace(time[0], time[-1], SAMPLES)
    values = np.interp(even, time, force)
    mean, std = float(values.mean()), float(values.std())
    free = detrend(values)
    length = float(time[-1] - time[0])
    power = np.abs(np.fft.rfft(free * np.hanning(SAMPLES), PADDING * SAMPLES)) ** 2
    frequency = np.fft.rfftfreq(PADDING * SAMPLES, even[1] - even[0])
    power[frequency < FEWEST_PERIODS / length] = 0.0
    maxima, _ = find_peaks(free, prominence=free.std() or 1.0)
    minima, _ = find_peaks(-free, prominence=free.std() or 1.0)
    total = float(power.sum())
    best = float(frequency[int(np.argmax(power))]) if total > 0.0 else math.nan
    near = np.abs(frequency - best) <= 2.0 / length
    swings = len(maxima) > 1 and len(minima) > 1
    return Oscillation(
        mean=mean,
        std=std,
        swing=float(values[maxima].mean() - values[minima].mean()) if swings else math.nan,
        spectral_frequency=best,
        spectral_share=float(power[near].sum()) / total if total > 0.0 else math.nan,
        cycles=max(len(maxima) - 1, 0),
        cycle_frequency=1.0 / float(np.diff(even[maxima]).mean()) if len(maxima) > 1 else math.nan,
    )
