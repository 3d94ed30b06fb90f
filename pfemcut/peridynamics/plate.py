"""A plate with holes and line cracks, and the sites of a lattice turned with the fibre that fill it.

The plate's middle is the origin, the pull is along x, and the fibre's angle is measured from x.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Hole:
    """A round hole: radius and middle (mm)."""

    radius: float
    centre: tuple[float, float]


@dataclass(frozen=True)
class LineCrack:
    """A straight crack without width: length, middle (mm) and angle from the pull (rad)."""

    length: float
    angle: float
    centre: tuple[float, float]

    @property
    def tips(self) -> Array:
        """Its two ends (mm); shape (2, 2)."""
        half = 0.5 * self.length * np.array([np.cos(self.angle), np.sin(self.angle)])
        return np.array([np.asarray(self.centre) - half, np.asarray(self.centre) + half])


@dataclass(frozen=True)
class Plate:
    """A rectangular plate between grips.

    Attributes
    ----------
    length, width, thickness
        Between the grips along x, along y, and out of the plane (mm).
    grip
        Length of the plate that each grip holds (mm).
    fibre_angle
        Of the fibre from x (rad).
    holes, cracks
        What is cut out.
    """

    length: float
    width: float
    thickness: float
    grip: float
    fibre_angle: float
    holes: tuple[Hole, ...]
    cracks: tuple[LineCrack, ...]


def lattice_sites(plate: Plate, spacing: float) -> Array:
    """Sites of a triangular lattice with one family of bonds along the fibre that lie in the plate; shape (n, 2).

    The origin is the middle of a triangle's height between two rows, so that the lattice is point-symmetric about it
    and rows along the edges of the plate lie about half a row inside. Sites are numbered row by row along the fibre.

    Parameters
    ----------
    plate
        The plate, with its gripped parts.
    spacing
        R (mm).
    """
    half = np.array([0.5 * plate.length + plate.grip, 0.5 * plate.width])
    reach = float(np.hypot(*half))
    height = np.sqrt(3.0) / 2.0 * spacing
    rows = np.arange(-int(reach / height) - 2, int(reach / height) + 3)
    columns = np.arange(-int(reach / spacing) - 2, int(reach / spacing) + 3)
    row, column = (each.ravel() for each in np.meshgrid(rows, columns, indexing="ij"))
    # Row r is shifted by a half of spacing more than row r - 1, up to whole spacings; rows r and -1 - r mirror.
    along = (column + 0.5 * (row % 2) - 0.25) * spacing
    across = (row + 0.5) * height
    cosine, sine = np.cos(plate.fibre_angle), np.sin(plate.fibre_angle)
    points = np.column_stack([along * cosine - across * sine, along * sine + across * cosine])
    kept = (np.abs(points) <= half * (1.0 + 1e-9)).all(axis=1)
    for hole in plate.holes:
        kept &= np.hypot(*(points - np.asarray(hole.centre)).T) >= hole.radius
    return points[kept]


def cut_by_cracks(plate: Plate, begins: Array, ends: Array) -> BoolArray:
    """Whether the straight lines from ``begins`` to ``ends`` (m, 2) cross one of the line cracks; shape (m,)."""
    cut = np.zeros(len(begins), dtype=bool)
    for crack in plate.cracks:
        one, other = crack.tips
        across = _side(one, other, begins) * _side(one, other, ends) <= 0.0
        between = _side(begins, ends, one) * _side(begins, ends, other) <= 0.0
        cut |= across & between
    return cut


def _side(begin: Array, end: Array, point: Array) -> Array:
    """Twice the area of the triangles begin, end, point: positive on the left of the line."""
    one, two = end - begin, point - begin
    return np.asarray(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])
