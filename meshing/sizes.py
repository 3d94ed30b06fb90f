"""Graded size field: the wished particle spacing as a function of position."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class SpacingField(Protocol):
    """Wished particle spacing as a function of position."""

    def __call__(self, points: Array, /) -> Array:
        """Spacing (mm) at ``points`` (n, 2); shape (n,)."""


@dataclass(frozen=True)
class Capsule:
    """All points within ``radius`` of the segment from ``start`` to ``end`` (mm); a disc if both coincide."""

    start: tuple[float, float]
    end: tuple[float, float]
    radius: float

    def distance(self, points: Array) -> Array:
        """Distance of each of ``points`` (n, 2) to the capsule, zero inside; shape (n,)."""
        a = np.asarray(self.start)
        axis = np.asarray(self.end) - a
        length_squared = max(float(axis @ axis), 1e-300)
        along = np.clip((points - a) @ axis / length_squared, 0.0, 1.0)
        nearest = a + along[:, None] * axis
        return np.maximum(np.hypot(*(points - nearest).T) - self.radius, 0.0)

    def moved(self, shift: Array) -> Capsule:
        """The same capsule, translated by ``shift`` (2,)."""
        return replace(
            self,
            start=(self.start[0] + float(shift[0]), self.start[1] + float(shift[1])),
            end=(self.end[0] + float(shift[0]), self.end[1] + float(shift[1])),
        )


@dataclass(frozen=True)
class Box:
    """An axis-aligned rectangle; sides may lie at infinity."""

    lower: tuple[float, float]
    upper: tuple[float, float]

    def distance(self, points: Array) -> Array:
        """Distance of each of ``points`` (n, 2) to the box, zero inside; shape (n,)."""
        outside = np.maximum(np.asarray(self.lower) - points, points - np.asarray(self.upper))
        return np.hypot(*np.maximum(outside, 0.0).T)

    def moved(self, shift: Array) -> Box:
        """The same box, translated by ``shift`` (2,)."""
        return Box(
            (self.lower[0] + float(shift[0]), self.lower[1] + float(shift[1])),
            (self.upper[0] + float(shift[0]), self.upper[1] + float(shift[1])),
        )


@dataclass(frozen=True)
class SizeZone:
    """A region with its own spacing, which grows linearly with the distance from it.

    Attributes
    ----------
    region
        Where ``size`` holds.
    size
        Spacing inside the region (mm).
    growth
        Increase of the spacing per unit distance outside the region (dimensionless).
    still
        Whether it stays where it is when the field moves.
    """

    region: Capsule | Box
    size: float
    growth: float
    still: bool = False

    def moved(self, shift: Array) -> SizeZone:
        """The zone carried along by ``shift`` (2,), unless it stays."""
        return self if self.still else replace(self, region=self.region.moved(shift))


@dataclass(frozen=True)
class SizeField:
    """Particle spacing h(x): the smallest of all zones' wishes, at most ``far_size``.

    Attributes
    ----------
    zones
        The graded zones.
    far_size
        Upper bound of the spacing (mm).
    """

    zones: tuple[SizeZone, ...]
    far_size: float

    def __call__(self, points: Array) -> Array:
        """Spacing (mm) at ``points`` (n, 2); shape (n,)."""
        size = np.full(len(points), self.far_size)
        for zone in self.zones:
            np.minimum(size, zone.size + zone.growth * zone.region.distance(points), out=size)
        return size

    def scaled(self, factor: float) -> SizeField:
        """The size field with all spacings times ``factor``."""
        return SizeField(
            tuple(replace(zone, size=factor * zone.size, growth=factor * zone.growth) for zone in self.zones),
            factor * self.far_size,
        )

    def moved(self, shift: Array) -> SizeField:
        """The size field carried along by ``shift`` (2,), as when it follows the tool."""
        return SizeField(
            tuple(zone.moved(shift) for zone in self.zones),
            self.far_size,
        )
