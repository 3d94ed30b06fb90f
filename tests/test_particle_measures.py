"""Measures of particles on fields and clouds that are known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from pfemcut.particles.measures import (
    Regularity,
    bands,
    families,
    gridded,
    noise,
    peaks_along,
    regularity,
)

Array = NDArray[np.float64]
SPACING = 0.02
SIZES: dict[int, tuple[float, ...]] = {2: (2.0, 1.0), 3: (0.4, 0.3, 0.3)}


def lattice(size: tuple[float, ...] = (2.0, 1.0)) -> Array:
    axes = [np.arange(0.5 * SPACING, length, SPACING) for length in size]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(size))


def stripes(points: Array, angles: tuple[float, ...], sigma: float, apart: float) -> Array:
    """Gaussian bands of height one, ``apart`` from each other, in each of the directions (degree)."""
    field = np.zeros(len(points))
    for angle in angles:
        turned = np.radians(angle)
        place = points @ np.array([-np.sin(turned), np.cos(turned)])
        away = (place + 0.5 * apart) % apart - 0.5 * apart
        field += np.exp(-0.5 * (away / sigma) ** 2)
    return field


def measured(points: Array) -> Regularity:
    """Of those that began three spacings or more away from all sides."""
    start = lattice(SIZES[points.shape[1]])
    inside = ((start > 3.0 * SPACING) & (start < np.array(SIZES[points.shape[1]]) - 3.0 * SPACING)).all(
        axis=1
    )
    return regularity(points, SPACING, 1.5 * SPACING, inside)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_lattice_is_regular(dimension: int) -> None:
    found = measured(lattice(SIZES[dimension]))
    assert found.mean == pytest.approx(1.0)
    assert found.variation == pytest.approx(0.0, abs=1e-12)
    assert (found.smallest, found.clustered) == (pytest.approx(1.0), 0.0)
    assert found.unevenness < 1e-12


def test_noise_and_clusters_are_measured() -> None:
    """Every tenth particle put a quarter of a spacing beside another one: a fifth of them are in clusters."""
    points = lattice()
    shifts = np.random.default_rng(1).normal(0.0, 0.05 * SPACING, points.shape)
    little, more = (measured(points + factor * shifts) for factor in (1.0, 2.0))
    assert 0.02 < little.variation < 0.6 * more.variation
    assert 0.005 < little.unevenness < 0.6 * more.unevenness
    points[::10] = points[1::10] - [0.0, 0.25 * SPACING]
    found = measured(points)
    assert found.clustered == pytest.approx(0.2, abs=0.03)
    assert found.smallest == pytest.approx(0.25)
    assert found.unevenness > 0.05


def test_even_deformation_is_no_unevenness() -> None:
    """Stretched by 1.4 at constant area the lattice has nearer neighbours; sums of volumes know nothing of it."""
    stretched = measured(lattice() * [1.4, 1.0 / 1.4])
    assert stretched.mean == pytest.approx(1.0 / 1.4)
    assert stretched.unevenness < 0.01


def test_only_the_chosen_are_measured() -> None:
    points = lattice()
    points[0] = points[1]
    others = np.arange(len(points)) > 1
    assert regularity(points, SPACING, 1.5 * SPACING, others).clustered == 0.0


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 110.0])
def test_width_and_direction_of_parallel_bands(angle: float) -> None:
    """Half width of a Gaussian band to 5 %, smoothing included; direction to 2 degrees; contrast is full."""
    sigma = 0.05
    points = lattice()
    found = bands(gridded(points, stripes(points, (angle,), sigma, 0.6), SPACING), 0.3, 12.0 * SPACING)
    smoothed = np.hypot(sigma, SPACING)
    assert found.width == pytest.approx(2.0 * np.sqrt(2.0 * np.log(2.0)) * smoothed, rel=0.05)
    assert len(found.angles) == 1
    assert abs((found.angles[0] - angle + 90.0) % 180.0 - 90.0) <= 2.0
    assert found.contrast > 0.97
    assert found.histogram.sum() == pytest.approx(1.0)


def test_crossing_bands_are_two_families() -> None:
    points = lattice()
    found = bands(gridded(points, stripes(points, (45.0, 135.0), 0.04, 0.5), SPACING), 0.3, 12.0 * SPACING)
    assert sorted(found.angles) == [pytest.approx(45.0, abs=2.0), pytest.approx(135.0, abs=2.0)]


def test_sharper_bands_are_narrower_and_stand_out_more() -> None:
    points = lattice()
    wide, narrow = (
        bands(gridded(points, 0.5 + stripes(points, (45.0,), sigma, 0.4), SPACING), 0.1, 12.0 * SPACING)
        for sigma in (0.12, 0.05)
    )
    assert narrow.width < 0.7 * wide.width
    assert narrow.contrast > wide.contrast


def test_an_even_field_has_no_bands() -> None:
    points = lattice()
    found = bands(gridded(points, np.ones(len(points)), SPACING), 0.1, 12.0 * SPACING)
    assert np.isnan(found.width)
    assert found.angles == ()
    assert found.histogram.sum() == 0.0


def test_directions_are_a_circle() -> None:
    direction = np.array([178.0, 2.0, 179.0, 1.0, 90.0])
    assert families(direction, np.array([1.0, 1.0, 1.0, 1.0, 2.0])) == (pytest.approx(0.0, abs=1.0), 90.0)


def test_peaks_along_a_line_are_counted() -> None:
    place = np.random.default_rng(2).uniform(0.0, 3.0, 2000)
    values = 1.0 + np.cos(2.0 * np.pi * (place - 0.3) / 0.6)
    assert peaks_along(place, values, 0.02, 0.5) == pytest.approx([0.3, 0.9, 1.5, 2.1, 2.7], abs=0.03)


def test_noise_sees_what_changes_from_particle_to_particle_only() -> None:
    """None in a linear field; of a random part its own deviation, and what it adds to the fits, to 10 %."""
    points = lattice()
    inside = np.all((points > 0.2) & (points < 0.8), axis=1)
    field = 1.0 + points @ [0.3, -0.2]
    assert noise(points, field, 3.0 * SPACING, inside) < 1e-12
    random = 0.05 * np.random.default_rng(5).normal(size=len(points))
    mean = float(field[inside].mean())
    assert noise(points, field + random, 3.0 * SPACING, inside) == pytest.approx(0.05 / mean, rel=0.1)
