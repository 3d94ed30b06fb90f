"""Length of the next step, from how much the plastic flow of a particle changed over the last one.

Backward Euler takes the flow at the end of a step for that of the whole step. So the part of the plastic power that a
step moved, between its elements or in time, measures its error of first order: half of it is the difference to the
mean of start and end. Steady cutting has a finite one, as particles cross the shear zone in a few steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pfemcut.problem import NewtonControls, TimeControls

Array = NDArray[np.float64]

_LEAST_RATIO = 0.5  # of a step to the one before, by its error
_MARGIN = 0.9  # of the step that would just meet the tolerance
_MANY_ITERATIONS = 0.6  # of those allowed: the next step is shorter
_SHORTER = 0.8


def flow_change(rate_before: Array, rate: Array, weights: Array) -> float:
    """Part of the plastic power that a step moved, 0 to 1.

    Parameters
    ----------
    rate_before, rate
        Plastic multiplier rate of the elements at the start and at the end (1/s); shape (m,).
    weights
        Flow stress times area (N); shape (m,).
    """
    total = float(np.sum(weights * np.maximum(rate, rate_before)))
    return float(np.sum(weights * np.abs(rate - rate_before))) / total if total > 0.0 else 0.0


def next_step(
    controls: TimeControls, step: float, change: float, iterations: int, newton: NewtonControls
) -> float:
    """Step (s) to try after one of length ``step`` (s) that moved ``change`` of the plastic power.

    The change is of first order in the step. A step that needed many ``iterations`` is not repeated, and one that was
    shortened to end the run on time is not handed in.
    """
    ratio = _MARGIN * controls.step_tolerance / max(change, 1e-12)
    ratio = min(max(ratio, _LEAST_RATIO), controls.growth)
    if iterations > _MANY_ITERATIONS * newton.max_iterations:
        ratio = min(ratio, _SHORTER)
    # Never below the nominal step: only a step that fails takes shorter ones.
    return min(max(ratio * step, min(step * controls.growth, controls.step)), controls.largest_step)
