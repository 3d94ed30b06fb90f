"""Bodies filled with particles on a square or cubic lattice."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def box_lattice(low: Array, high: Array, spacing: float) -> tuple[Array, float]:
    """Particles that fill a box, and the volume (mm^d) of each.

    The spacing is adjusted in each direction so that a whole number of cells fills the box; particles sit in their
    middles.

    Parameters
    ----------
    low, high
        Corners (mm); shape (d,).
    spacing
        Wished spacing (mm).
    """
    size = np.asarray(high, dtype=np.float64) - low
    counts = np.maximum(np.round(size / spacing).astype(int), 1)
    axes = [
        first + (np.arange(count) + 0.5) * length / count
        for first, length, count in zip(low, size, counts, strict=True)
    ]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(size))
    return points, float(np.prod(size / counts))


def cylinder_lattice(radius: float, length: float, spacing: float) -> tuple[Array, float]:
    """Particles that fill a cylinder round the z axis from z = 0 up, and the volume (mm³) of each.

    Those of a lattice centred on the axis whose middles lie inside; their volume is such that the total is the
    cylinder's own.
    """
    half = int(np.ceil(radius / spacing)) + 1
    across = (np.arange(-half, half) + 0.5) * spacing
    layers = max(round(length / spacing), 1)
    x, y = np.meshgrid(across, across, indexing="ij")
    inside = np.hypot(x, y) < radius
    disc = np.column_stack([x[inside], y[inside]])
    heights = (np.arange(layers) + 0.5) * length / layers
    points = np.column_stack([np.tile(disc, (layers, 1)), np.repeat(heights, len(disc))])
    return points, float(np.pi * radius**2 * length / len(points))
