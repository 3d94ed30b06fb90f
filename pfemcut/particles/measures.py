"""What particles show, in figures: how regular they lie, and the bands in which a field localises.

**Regularity.** The distance to the nearest particle, over the spacing at the start: its coefficient of variation, and
the share of particles with another one nearer than half a spacing, which have clustered. Plastic flow changes these:
a lattice that is stretched to twice its length has neighbours at half the distance. The sum of volumes times kernel,
sum_j V_j W(x_j - x_i), does not see an even deformation: it is one inside of a body as long as particles lie evenly,
larger in clusters and smaller beside them.

**Bands** are ridges of a field of the plane: places where it falls to both sides. The field is put on a grid and
smoothed by a Gaussian whose standard deviation is a spacing, so a band can't come out narrower than 2.4 spacings. At a
ridge the field's most negative curvature is across the band; along that line the half width runs between the points
where the field has fallen half way from the ridge to the higher of the valleys on both sides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import griddata
from scipy.ndimage import gaussian_filter, map_coordinates, maximum_filter
from scipy.signal import find_peaks
from scipy.spatial import cKDTree

from pfemcut.particles.cells import pairs_in_cells
from pfemcut.particles.kernel import SUPPORT, normalisation, weights

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

CLUSTERED = 0.5
"""Distance to the nearest particle, in spacings, below which particles count as clustered."""
_CELLS_A_SPACING = 2.0
_BINS = 36
_APART = 20.0
"""Smallest angle between two families of bands (degree)."""


@dataclass(frozen=True)
class Regularity:
    """How regular particles lie; distances to the nearest one in spacings.

    Attributes
    ----------
    mean, variation
        Mean, and standard deviation over the mean.
    smallest
        The smallest.
    clustered
        Share of particles nearer than :data:`CLUSTERED` to another one.
    unevenness
        Standard deviation of the sum of volumes times kernel.
    """

    mean: float
    variation: float
    smallest: float
    clustered: float
    unevenness: float


@dataclass(frozen=True)
class Grid:
    """A field of the plane on a square grid.

    Attributes
    ----------
    low
        First point (mm); shape (2,).
    step
        Distance of points (mm).
    values
        The field at ``low + step (i, j)``, smoothed, and nan outside of the body; shape (nx, ny).
    """

    low: Array
    step: float
    values: Array


@dataclass(frozen=True)
class Bands:
    """Bands of a field, weighted by their heights above the valleys.

    Attributes
    ----------
    width
        Median half width (mm).
    contrast
        Median height of a ridge over the field at it: one if the valleys are empty.
    angles
        Directions of the families of bands (degree from the x axis, 0 to 180), strongest first.
    histogram
        Share of ridge points by direction, in bins of five degrees from 0 to 180; shape (36,).
    points
        Ridge points that were found (mm); shape (k, 2).
    """

    width: float
    contrast: float
    angles: tuple[float, ...]
    histogram: Array
    points: Array


def regularity(points: Array, spacing: float, smoothing_length: float, chosen: BoolArray) -> Regularity:
    """How regular the ``chosen`` (n,) of ``points`` (n, d) lie, which should be 2 h away from surfaces.

    All had the same volume, ``spacing`` to the power d, at the start, and have it still: metals change theirs little.

    Parameters
    ----------
    spacing, smoothing_length
        At the start, and h (mm).
    """
    distance = cKDTree(points).query(points[chosen], k=2)[0][:, 1] / spacing
    mean = float(distance.mean())
    total = _volume_sums(points, spacing, smoothing_length)[chosen]
    return Regularity(
        mean,
        float(distance.std()) / mean if mean else 0.0,
        float(distance.min()),
        float(np.mean(distance < CLUSTERED)),
        float(total.std()),
    )


def noise(points: Array, values: Array, reach: float, chosen: BoolArray) -> float:
    """How rough ``values`` (n,) are from particle to particle, over their mean, of the ``chosen`` (n,) of ``points``.

    The root mean square of the difference to the plane fitted to the values of the particles nearer than ``reach``
    (mm), each one left out of its own fit: no smooth field is rough. Particles with too few neighbours for a fit, less
    than four in the plane or six in space, are left out.
    """
    offsets, indices = pairs_in_cells(points, reach)
    count = len(points)
    owners = np.repeat(np.arange(count), np.diff(offsets))
    apart = points[indices] - points[owners]
    # Least squares: the plane's value at the particle solves for [1, dx, dy] together.
    basis = np.column_stack([np.ones(len(indices)), apart])
    size = basis.shape[1]
    matrix, right = np.empty((count, size, size)), np.empty((count, size))
    for a in range(size):
        right[:, a] = np.bincount(owners, basis[:, a] * values[indices], minlength=count)
        for b in range(size):
            matrix[:, a, b] = np.bincount(owners, basis[:, a] * basis[:, b], minlength=count)
    fits = chosen & (np.diff(offsets) >= 2 * points.shape[1])
    fitted = np.linalg.solve(matrix[fits], right[fits][:, :, None])[:, 0, 0]
    found = values[fits]
    return float(np.sqrt(np.mean((found - fitted) ** 2)) / found.mean())


def _volume_sums(points: Array, spacing: float, smoothing_length: float) -> Array:
    """Sum of V W at each of ``points``; shape (n,)."""
    count, dimension = points.shape
    offsets, indices = pairs_in_cells(points, SUPPORT * smoothing_length)
    owners = np.repeat(np.arange(count), np.diff(offsets))
    distance = np.sqrt(np.sum((points[indices] - points[owners]) ** 2, axis=1))
    kernel = np.bincount(owners, weights(distance, smoothing_length, dimension), minlength=count)
    return np.asarray(spacing**dimension * (normalisation(smoothing_length, dimension) + kernel))


def gridded(points: Array, values: Array, spacing: float) -> Grid:
    """``values`` (n,) at ``points`` (n, 2) on a grid of half a spacing (mm), smoothed by a Gaussian of one spacing.

    Where no particle is within one spacing the grid has nan; smoothing takes nothing from there.
    """
    step = spacing / _CELLS_A_SPACING
    low = points.min(axis=0)
    axes = [np.arange(first, last + step, step) for first, last in zip(low, points.max(axis=0), strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    found = np.nan_to_num(griddata(points, values, places, method="linear"))
    inside = cKDTree(points).query(places)[0] < spacing
    weight = gaussian_filter(inside.astype(np.float64), _CELLS_A_SPACING, mode="constant")
    smooth = gaussian_filter(np.where(inside, found, 0.0), _CELLS_A_SPACING, mode="constant")
    return Grid(low, step, np.where(inside, smooth / np.maximum(weight, 1e-12), np.nan))


def bands(grid: Grid, least: float, reach: float) -> Bands:
    """Bands of a field: ridges that stand out by at least ``least`` (the field's unit) above both valleys.

    Valleys are looked for up to ``reach`` (mm) on both sides of a ridge; where it is shorter, bands seem narrower.

    No band is width nan, contrast nan and no angles.
    """
    values = np.where(np.isfinite(grid.values), grid.values, 0.0)
    normal, ridge = _ridges(grid, values)
    place = np.argwhere(ridge).astype(np.float64)
    across = normal[ridge]
    samples = 0.25 * np.arange(np.ceil(4.0 * reach / grid.step) + 1.0)
    offsets = np.concatenate([-samples[:0:-1], samples])
    lines = place[:, None, :] + offsets[:, None] * across[:, None, :]
    outside = np.where(np.isfinite(grid.values), 0.0, 1.0)
    profile = map_coordinates(values, lines.transpose(2, 0, 1), order=1, mode="nearest")
    left = map_coordinates(outside, lines.transpose(2, 0, 1), order=1, mode="constant", cval=1.0) > 0.0
    found = [_half_width(*each) for each in zip(profile, left, strict=True)]
    width, height, peak = (np.array([each[k] for each in found], dtype=np.float64) for k in range(3))
    enough = np.isfinite(width) & (height >= least)
    direction = np.degrees(np.arctan2(across[:, 1], across[:, 0]) + 0.5 * np.pi) % 180.0
    histogram = np.histogram(direction[enough], bins=_BINS, range=(0.0, 180.0), weights=height[enough])[0]
    points = grid.low + grid.step * place[enough]
    if not enough.any():
        return Bands(np.nan, np.nan, (), histogram, points)
    return Bands(
        float(np.median(width[enough])) * 0.25 * grid.step,
        float(np.median(height[enough] / peak[enough])),
        families(direction[enough], height[enough]),
        histogram / histogram.sum(),
        points,
    )


def families(direction: Array, weight: Array) -> tuple[float, ...]:
    """Directions (degree, 0 to 180) where many of ``direction`` (n,) gather, by ``weight`` (n,), strongest first.

    Peaks of the density of directions, smoothed by a Gaussian of 8 degrees, that are at least a third of the highest
    and 20 degrees apart.
    """
    at = np.arange(180.0)
    apart = np.abs((at[:, None] - direction + 90.0) % 180.0 - 90.0)
    density = np.exp(-0.5 * (apart / 8.0) ** 2) @ weight
    # Directions are a circle: three turns, of which the middle one counts.
    peaks, _ = find_peaks(np.tile(density, 3), height=density.max() / 3.0, distance=_APART)
    peaks = np.unique(peaks[(peaks >= 180) & (peaks < 360)] - 180)
    return tuple(float(at[peak]) for peak in peaks[np.argsort(-density[peaks])])


def peaks_along(place: Array, values: Array, step: float, least: float) -> Array:
    """Places (mm) of the peaks of ``values`` (n,) along a line of particles at ``place`` (n,).

    The values are averaged in bins of ``step`` (mm) and smoothed over one bin; peaks stand out by ``least``.
    """
    edges = np.arange(place.min(), place.max() + step, step)
    count = np.histogram(place, edges)[0]
    total = np.histogram(place, edges, weights=values)[0]
    filled = count > 0
    middle = 0.5 * (edges[:-1] + edges[1:])
    mean = np.interp(middle, middle[filled], total[filled] / count[filled])
    peaks, _ = find_peaks(gaussian_filter(mean, 1.0, mode="nearest"), prominence=least)
    return np.asarray(middle[peaks])


def _ridges(grid: Grid, values: Array) -> tuple[Array, BoolArray]:
    """Unit vector across the band (nx, ny, 2), and whether a point is the highest across it."""
    first = np.gradient(values)
    (xx, xy), (_, yy) = (np.gradient(each) for each in first)
    curvature, vectors = np.linalg.eigh(np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2))
    across = vectors[..., 0]
    inside = np.isfinite(grid.values)
    deep = maximum_filter((~inside).astype(np.int8), size=int(2 * _CELLS_A_SPACING) + 1) == 0
    places = np.stack(np.meshgrid(*map(np.arange, values.shape), indexing="ij"), axis=-1).astype(np.float64)
    sides = [
        map_coordinates(values, (places + sign * across).transpose(2, 0, 1), order=1, mode="nearest")
        for sign in (-1.0, 1.0)
    ]
    ridge = deep & (curvature[..., 0] < 0.0) & (values > sides[0]) & (values >= sides[1])
    return across, ridge


def _half_width(profile: Array, outside: BoolArray) -> tuple[float, float, float]:
    """Width in samples at half height of the peak in the middle of ``profile`` (k,), its height, and its value.

    The line ends where it leaves the body (``outside``) or where the field has begun to rise again.
    """
    middle = len(profile) // 2
    peak = float(profile[middle])
    crossings, valleys = [], []
    sides = (profile[middle::-1], profile[middle:])
    ends = (outside[middle::-1], outside[middle:])
    for side, end in zip(sides, ends, strict=True):
        last = int(np.argmax(end)) if end.any() else len(side)
        rising = np.flatnonzero(side[1:last] > np.minimum.accumulate(side[: last - 1]) + 0.02 * peak)
        inner = side[: int(rising[0]) + 1 if len(rising) else last]
        valleys.append(float(inner.min()))
    valley = max(valleys)
    level = 0.5 * (peak + valley)
    for side in sides:
        below = np.flatnonzero(side < level)
        if not len(below) or below[0] == 0:
            return np.nan, 0.0, peak
        k = int(below[0])
        crossings.append(k - 1 + (side[k - 1] - level) / (side[k - 1] - side[k]))
    return float(sum(crossings)), peak - valley, peak
