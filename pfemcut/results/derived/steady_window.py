"""The window of travel over which figures are averaged, and whether the cut is steady in it.

The window is the last max(0.1 mm, 25 % of travel), beginning after 0.2 mm of travel. The cut is steady if a straight
line fitted to the cutting force rises or falls by less than 2 % of the mean over the window, and if the force's
standard deviation is below 3 % of the mean.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHORTEST = 0.1
SHARE = 0.25
RUN_IN = 0.2
LARGEST_DRIFT = 0.02
LARGEST_SCATTER = 0.03


@dataclass(frozen=True)
class SteadyWindow:
    """The window and its verdict.

    Attributes
    ----------
    begin, end
        Travel (mm).
    weights
        Weight of each history row (travel that it stands for, over the window's), zero outside; shape (rows,).
    drift, scatter
        Change of the fitted line over the window and standard deviation of the cutting force, over its mean.
    steady
        Whether the cut is steady.
    reason
        Why it isn't, else empty.
    """

    begin: float
    end: float
    weights: Array
    drift: float
    scatter: float
    steady: bool
    reason: str

    def mean(self, values: Array) -> float:
        """Return the mean of a history column over the window; rows without a value (nan) are left out."""
        return self._moments(values)[0]

    def std(self, values: Array) -> float:
        """Return the standard deviation of a history column over the window."""
        return self._moments(values)[1]

    def _moments(self, values: Array) -> tuple[float, float]:
        use = (self.weights > 0.0) & np.isfinite(values)
        if not use.any():
            return float("nan"), float("nan")
        weights = self.weights[use] / self.weights[use].sum()
        mean = float(weights @ values[use])
        return mean, float(np.sqrt(weights @ (values[use] - mean) ** 2))


def steady_window(travel: Array, cutting_force: Array) -> SteadyWindow:
    """Return the window of a history.

    Rows are weighted with the travel that they stand for, so that a stretch of halved steps doesn't count double.
    A run too short for the window (less than 0.3 mm) is averaged over its second half and is not steady.

    Parameters
    ----------
    travel
        Travel (mm), never falling; shape (rows,), at least one row.
    cutting_force
        Cutting force (N/mm); shape (rows,).
    """
    end = float(travel[-1])
    begin = max(end - max(SHORTEST, SHARE * end), RUN_IN)
    tolerance = 1e-9 * max(end, 1.0)
    too_short = end < RUN_IN + SHORTEST - tolerance
    if too_short:
        begin = 0.5 * end
    weights = np.where(travel >= begin - tolerance, _shares(travel), 0.0)
    if weights.sum() <= 0.0:
        weights = np.zeros_like(travel)
        weights[-1] = 1.0
    weights = weights / weights.sum()
    use = weights > 0.0

    mean = float(weights @ cutting_force)
    scatter = float(np.sqrt(weights @ (cutting_force - mean) ** 2))
    slope = 0.0
    if np.count_nonzero(use) > 1:
        centred = travel - weights @ travel
        slope = float(weights @ (centred * (cutting_force - mean)) / (weights @ centred**2))
    scale = abs(mean) if mean != 0.0 else np.inf
    drift, scatter = abs(slope) * (end - begin) / scale, scatter / scale
    reason = ""
    if too_short:
        reason = f"the cut is {end:.3g} mm long; a steady window needs {RUN_IN + SHORTEST:g} mm"
    elif mean == 0.0:
        reason = "there is no cutting force"
    elif drift >= LARGEST_DRIFT:
        reason = f"the cutting force drifts by {drift:.1%} over the window (limit {LARGEST_DRIFT:.0%})"
    elif scatter >= LARGEST_SCATTER:
        reason = f"the cutting force scatters by {scatter:.1%} over the window (limit {LARGEST_SCATTER:.0%})"
    return SteadyWindow(begin, end, weights, drift, scatter, not reason, reason)


def _shares(travel: Array) -> Array:
    """Return the travel between the middles of neighbouring rows; shape of ``travel``."""
    if travel.size < 2:
        return np.ones_like(travel)
    middles = 0.5 * (travel[1:] + travel[:-1])
    borders = np.concatenate([travel[:1], middles, travel[-1:]])
    return np.asarray(np.diff(borders))
