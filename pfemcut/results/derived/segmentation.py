"""Segments of a serrated chip: spacing, peak and valley thickness, frequency (from the chip, and from the force).

**From the chip.** Each particle of the chip's free side has a thickness h, its distance to the chip's rake side, and a
place s, the foot's distance from the rake tangent point along the rake side. The free side is what was the uncut
surface, which its particles' displacement tells; the rake side goes from the tool's tip to the middle of the end face.
Along the free side, peaks and valleys are the local extremes of h that stand out by more than 5 % of the depth of cut.
So a valley is measured at the root of the notch, even where the segment behind hangs over it. A segment lies between
two valleys; the one being formed and the first are not counted.

- degree of segmentation G = (h_peak - h_valley) / h_peak, of the mean peak and the mean valley (Schulz, Abele, Sahm
  2001, CIRP Annals 50, 45-48);
- spacing: mean distance between valleys along the rake side;
- frequency = V / the mean distance that the particles in the valleys had on the uncut surface.

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
from pfemcut.problem import Cut
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]

PROMINENCE = 0.05
"""How far an extreme of the thickness stands out, in depths."""
NEAR_SURFACE = 0.1
"""Depth below the uncut surface down to which a boundary particle belongs to the free side, in depths."""
ROOT = 1.2
"""Place up the rake face from which the chip is looked at, in depths: below is the root, which no tooth has left."""
END = 0.1
"""What is left out before the end of the chip, in depths."""
SAMPLES = 4096
PADDING = 8
"""Zeros behind the force, in lengths of the record: they interpolate the spectrum."""
FEWEST_PERIODS = 2.0


@dataclass(frozen=True)
class Profile:
    """Thickness of the chip (mm) at the particles of its free side, from the root to the end; shape (k,).

    ``along`` is the place of each along the rake side (mm from the rake tangent point); it may go back where the free
    side hangs over. ``origin`` is where it was along the uncut surface (mm).
    """

    along: Array
    thickness: Array
    origin: Array


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
    uncut
        Mean distance that valleys had on the uncut surface (mm).
    frequency
        Segments per second (1/s).
    """

    count: int
    spacing: float
    spacing_std: float
    peak: float
    valley: float
    uncut: float
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


def thickness_profile(frame: Frame, tool: RigidWedge, cut: Cut) -> Profile:
    """The chip's thickness along its free side, from 1.2 depths above the rake tangent point."""
    points = frame.points
    initial = points - np.asarray(frame.point_fields["displacement"], dtype=np.float64)
    below = cut.surface - initial[:, 1]
    away = [np.hypot(*(points[loop] - tool.rake_tangent_point).T) for loop in frame.loops]
    chosen = int(np.argmin([each.min() for each in away]))
    loop = np.roll(frame.loops[chosen], -int(np.argmin(away[chosen])))
    middle = np.flatnonzero(below[loop] < 0.5 * cut.depth)
    on_top = np.flatnonzero(below[loop] < NEAR_SURFACE * cut.depth)
    if not middle.size or middle[0] < 2 or not on_top.size:
        return Profile(np.empty(0), np.empty(0), np.empty(0))
    rake_side = points[loop[: middle[0]]]
    side = loop[on_top[0] : on_top[-1] + 1]
    thickness, along = distance_to_line(points[side], rake_side)
    # From the end of the chip to its root.
    lowest = int(np.argmin(along))
    root = np.flatnonzero(along[:lowest] < ROOT * cut.depth)
    last = int(root[0]) if root.size else lowest
    first = int(np.argmax(along < along[:last].max(initial=0.0) - END * cut.depth))
    chosen_side = slice(first, last)
    return Profile(
        along[chosen_side][::-1], thickness[chosen_side][::-1], initial[side[chosen_side], 0][::-1]
    )


def distance_to_line(points: Array, line: Array) -> tuple[Array, Array]:
    """Distance of each of ``points`` (n, 2) to the polyline ``line`` (b, 2), and how far along it the foot is; (n,)."""
    start, edge = line[:-1], np.diff(line, axis=0)
    length = np.hypot(*edge.T)
    before = np.concatenate([[0.0], np.cumsum(length)])[:-1]
    offset = points[:, None, :] - start
    place = np.clip(np.sum(offset * edge, axis=2) / np.maximum(length, 1e-300) ** 2, 0.0, 1.0)
    apart = np.hypot(*np.moveaxis(offset - place[:, :, None] * edge, 2, 0))
    nearest = np.argmin(apart, axis=1)
    rows = np.arange(len(points))
    return apart[rows, nearest], before[nearest] + place[rows, nearest] * length[nearest]


def segmentation(profile: Profile, depth: float, speed: float) -> Segmentation:
    """Segments of a chip with the thickness ``profile``, cut at ``depth`` (mm) with ``speed`` (mm/s)."""
    thickness, along = profile.thickness, profile.along
    limit = PROMINENCE * depth
    valleys, _ = find_peaks(-thickness, prominence=limit)
    if len(valleys) < 2:
        return Segmentation(0, *[math.nan] * 6)
    peaks = [int(a + np.argmax(thickness[a:b])) for a, b in zip(valleys[:-1], valleys[1:], strict=True)]
    spacing = np.abs(np.diff(along[valleys]))
    uncut = float(np.abs(np.diff(profile.origin[valleys])).mean())
    return Segmentation(
        count=len(peaks),
        spacing=float(spacing.mean()),
        spacing_std=float(spacing.std()),
        peak=float(thickness[peaks].mean()),
        valley=float(thickness[valleys].mean()),
        uncut=uncut,
        frequency=speed / uncut,
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
