"""Observed order and grid convergence index of values on three levels of refinement.

Roache (1994), J. Fluids Eng. 116, 405: the index is the relative change between the two finest levels over r^p − 1,
times a factor of safety of 1.25 where the order p is observed on three levels. Celik et al. (2008), J. Fluids Eng. 130,
078001: the order from the ratio of the two changes, here with one ratio r between all levels, and which sequences do
not converge monotonically. For those an order would mean nothing and there is none here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

SAFETY = 1.25
"""Factor of safety with three levels."""
LARGEST_ORDER = 2.0
"""Of linear elements: a larger one is chance, and would make the index too small."""
SMALLEST_ORDER = 0.5
"""An order below this is far from that of any error term: the levels are too coarse for an extrapolation."""


class Behaviour(Enum):
    """How three values behave under refinement."""

    MONOTONE = "converges"
    OSCILLATING = "oscillates, changes fall"
    DIVERGING = "does not converge, changes grow"
    SWINGING = "oscillates, changes grow"
    SCATTER = "last change within the scatter"
    UNCHANGED = "does not change"
    UNKNOWN = "not computed on all levels"


@dataclass(frozen=True)
class Convergence:
    """What three levels say of a figure; nan where they say nothing.

    Attributes
    ----------
    behaviour
        How the values behave.
    order
        Observed order, of monotone convergence only.
    index
        Grid convergence index of the finest value, relative to it, with at most :data:`LARGEST_ORDER`.
    extrapolated
        Value at vanishing size after Richardson, with the same order; only with an order of :data:`SMALLEST_ORDER` or
        more.
    half_range
        Half of the range of the three values, relative to the finest: what is left to say of one that oscillates.
    """

    behaviour: Behaviour
    order: float
    index: float
    extrapolated: float
    half_range: float


def observed_order(coarse: float, middle: float, fine: float, ratio: float) -> float:
    """Observed order of monotone convergence, ln((middle − coarse) / (fine − middle)) / ln r; nan if it is none.

    Parameters
    ----------
    coarse, middle, fine
        Values on the levels.
    ratio
        Of the sizes of neighbouring levels, r > 1.
    """
    change, before = fine - middle, middle - coarse
    if not change * before > 0.0 or abs(change) >= abs(before):
        return math.nan
    return math.log(before / change) / math.log(ratio)


def grid_convergence_index(fine: float, coarser: float, ratio: float, order: float) -> float:
    """Index of the fine value, relative to it: safety |(fine − coarser) / fine| / (r^p − 1); nan without an order."""
    if fine == 0.0 or math.isnan(order):
        return math.nan
    return SAFETY * abs((fine - coarser) / fine) / (ratio**order - 1.0)


def convergence_of(values: Sequence[float], deviations: Sequence[float], ratio: float) -> Convergence:
    """What the three finest levels say.

    Parameters
    ----------
    values
        From the coarsest level to the finest; at least three, nan where there is none.
    deviations
        Standard deviation of each over the steady window; nan where there is none. A last change below the combined
        one of its two levels is scatter, from which no order follows.
    ratio
        See :func:`observed_order`.
    """
    coarse, middle, fine = values[-3:]
    half_range = math.nan
    if not all(math.isfinite(value) for value in (coarse, middle, fine)):
        return Convergence(Behaviour.UNKNOWN, math.nan, math.nan, math.nan, math.nan)
    if fine != 0.0:
        half_range = 0.5 * (max(coarse, middle, fine) - min(coarse, middle, fine)) / abs(fine)
    behaviour = _behaviour(middle - coarse, fine - middle, _combined(deviations[-2:]))
    if behaviour is not Behaviour.MONOTONE:
        return Convergence(behaviour, math.nan, math.nan, math.nan, half_range)
    order = observed_order(coarse, middle, fine, ratio)
    used = min(order, LARGEST_ORDER)
    index = grid_convergence_index(fine, middle, ratio, used)
    extrapolated = fine + (fine - middle) / (ratio**used - 1.0) if order >= SMALLEST_ORDER else math.nan
    return Convergence(behaviour, order, index, extrapolated, half_range)


def _behaviour(before: float, change: float, scatter: float) -> Behaviour:
    """From the changes between the levels and the scatter of the last one."""
    if before == 0.0 and change == 0.0:
        return Behaviour.UNCHANGED
    if abs(change) < scatter:
        return Behaviour.SCATTER
    falls = abs(change) < abs(before)
    if before * change > 0.0:
        return Behaviour.MONOTONE if falls else Behaviour.DIVERGING
    if before == 0.0:
        return Behaviour.DIVERGING
    return Behaviour.OSCILLATING if falls else Behaviour.SWINGING


def _combined(deviations: Sequence[float]) -> float:
    return math.hypot(*(each for each in deviations if math.isfinite(each)))
