"""Conditions on named boundary parts: motions, loads, heat. Units: mm, tonne, s, K (so N, MPa, mJ)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Axis(Enum):
    """Direction of a prescribed motion."""

    X = 0
    Y = 1


@dataclass(frozen=True)
class Schedule:
    """A value as a piecewise linear function of time, constant beyond its ends.

    Attributes
    ----------
    times
        Increasing times (s); a single one makes the value constant.
    values
        Values at these times.
    """

    times: tuple[float, ...]
    values: tuple[float, ...]

    def __call__(self, time: float) -> float:
        """The value at ``time`` (s)."""
        return float(np.interp(time, self.times, self.values))


def constant(value: float) -> Schedule:
    """A value that does not change."""
    return Schedule((0.0,), (value,))


@dataclass(frozen=True)
class PrescribedMotion:
    """A displacement component prescribed on a boundary part, the same everywhere or linear along it.

    Attributes
    ----------
    part, axis
        Where, and which component.
    displacement
        mm since time zero.
    gradient
        Derivatives of the displacement by the initial position, x and y; none if the part moves as one.
    centre
        Initial position where the gradient adds nothing (mm).
    corner
        Another part, if only the particles that both share move so.
    """

    part: str
    axis: Axis
    displacement: Schedule
    gradient: tuple[Schedule, ...] = ()
    centre: tuple[float, float] = (0.0, 0.0)
    corner: str = ""

    def increment(self, start: float, end: float) -> NDArray[np.float64]:
        """Change from time ``start`` to ``end`` (s) of the displacement and of its gradient, x and y; shape (3,)."""
        schedules = (self.displacement, *(self.gradient or (constant(0.0), constant(0.0))))
        return np.array([schedule(end) - schedule(start) for schedule in schedules])

    def shape(self, initial: NDArray[np.float64]) -> NDArray[np.float64]:
        """What :meth:`increment` multiplies at the initial positions (n, 2): 1, X - X_c, Y - Y_c; shape (n, 3)."""
        return np.column_stack([np.ones(len(initial)), initial - np.asarray(self.centre)])


def fixed(part: str, axis: Axis, corner: str = "") -> PrescribedMotion:
    """A boundary part, or its ``corner`` with another, held in one direction."""
    return PrescribedMotion(part, axis, constant(0.0), corner=corner)


@dataclass(frozen=True)
class DistributedForce:
    """A dead force (N per mm of width), spread evenly over the current length of a boundary part."""

    part: str
    x: Schedule
    y: Schedule


@dataclass(frozen=True)
class Traction:
    """A traction (MPa) per current length of a boundary part, in fixed directions."""

    part: str
    x: Schedule
    y: Schedule


@dataclass(frozen=True)
class Pressure:
    """A pressure (MPa) on a boundary part, normal to its current surface."""

    part: str
    pressure: Schedule


@dataclass(frozen=True)
class PrescribedTemperature:
    """A temperature (K) prescribed on a boundary part."""

    part: str
    temperature: Schedule


@dataclass(frozen=True)
class HeatFlux:
    """A heat flux into the body (N/(mm s) = mW/mm²) on a boundary part."""

    part: str
    flux: Schedule


@dataclass(frozen=True)
class MovingHeatBand:
    """A heat flux into the body (mW/mm²) on the piece of a boundary part in a band of x that moves.

    Attributes
    ----------
    lower, upper
        Ends of the band at time zero (mm).
    velocity
        Velocity of the band (mm/s).
    """

    part: str
    flux: float
    lower: float
    upper: float
    velocity: float


@dataclass(frozen=True)
class Convection:
    """A heat flux ``coefficient`` (N/(mm s K)) times (``ambient`` - temperature) on a boundary part."""

    part: str
    coefficient: float
    ambient: Schedule
