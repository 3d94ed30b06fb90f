"""Least squares with bounds for figures that are dear and noisy.

Every evaluation is a cut (or a few), so gradients are differences over a step that is wide against the noise of the
figures, all points of a gradient are asked for at once, and parameters are scaled to their bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from pfemcut.calibrate.parameters import Parameter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Computed:
    """Figures at one point of the parameters.

    Attributes
    ----------
    values
        In the order of the measured ones; nan if the point could not be computed. Shape (figures,).
    deviations
        Their noise, as standard deviations. Shape (figures,).
    """

    values: Array
    deviations: Array


KEPT = 0.25
"""Derivatives are kept as long as no parameter moved by more than this part of their step."""
_SHIFT = 1.0

Evaluate = Callable[[Sequence[tuple[float, ...]]], Sequence[Computed]]
"""From points (a value for each parameter) to figures; asked for each point once."""


@dataclass(frozen=True)
class Controls:
    """How the fit is searched.

    Attributes
    ----------
    difference
        Step of the differences, as a part of the range between the bounds.
    central
        Whether differences are taken to both sides where the bounds allow it.
    tolerance
        The search ends with a step below this part of the range.
    most_steps
        Steps of the search at most.
    """

    difference: float = 0.05
    central: bool = False
    tolerance: float = 2e-3
    most_steps: int = 20


@dataclass(frozen=True)
class Fit:
    """Where the search ended.

    Attributes
    ----------
    point
        Values of the parameters.
    computed
        Figures there.
    jacobian
        Derivatives of the figures over their uncertainties, by the parameters scaled to their bounds; shape
        (figures, parameters).
    converged
        Whether it ended by its tolerance.
    ending
        How it ended.
    steps
        Points that the search tried, without those of differences.
    """

    point: tuple[float, ...]
    computed: Computed
    jacobian: Array
    converged: bool
    ending: str
    steps: int


class NotComputed(Exception):
    """A point that the search can't do without could not be computed."""

    def __init__(self, point: tuple[float, ...]) -> None:
        self.point = point
        super().__init__(str(point))


class _Settled(Exception):
    """A trial lies so near to the point before it that the search ends; ``scaled`` is the better of both."""

    def __init__(self, scaled: Array) -> None:
        self.scaled = scaled
        super().__init__()


class Remembered:
    """An evaluation that is asked for each point once.

    Parameters
    ----------
    evaluate
        Computes points.
    """

    def __init__(self, evaluate: Evaluate) -> None:
        self._evaluate = evaluate
        self.found: dict[tuple[float, ...], Computed] = {}

    def __call__(self, points: Sequence[tuple[float, ...]]) -> list[Computed]:
        """Figures at the points."""
        new = [point for point in dict.fromkeys(points) if point not in self.found]
        if new:
            self.found |= dict(zip(new, self._evaluate(new), strict=True))
        return [self.found[point] for point in points]


def fitted(
    parameters: Sequence[Parameter],
    measured: Array,
    uncertainties: Array,
    evaluate: Evaluate,
    controls: Controls,
) -> Fit:
    """The parameters whose figures are nearest to the measured ones, in units of their uncertainties.

    Parameters
    ----------
    parameters
        The parameters, with a start.
    measured, uncertainties
        Measured figures and their standard deviations; shape (figures,), not fewer than parameters.
    evaluate
        Computes figures.
    controls
        How to search.

    Raises
    ------
    NotComputed
        If the start, or a point of a difference, could not be computed. Trial points that can't be are avoided.
    """
    remembered = Remembered(evaluate)

    def point_at(scaled: Array) -> tuple[float, ...]:
        return tuple(each.value(float(z)) for each, z in zip(parameters, scaled, strict=True))

    def residuals(scaled: Array) -> Array:
        (computed,) = remembered([point_at(scaled)])
        return np.asarray((computed.values - measured) / uncertainties)

    reached: list[Array] = []
    trials: list[Array] = []

    def tried(scaled: Array) -> Array:
        """Residuals of a trial; raises :class:`_Settled` where no parameter moved by as much as the tolerance.

        The criterion of ``least_squares`` itself, with the norms of step and point, depends on where the range begins
        and on how many parameters there are.
        """
        trials.append(scaled)
        found = residuals(scaled)
        for before in reached[-1:]:
            if np.abs(scaled - before).max() < controls.tolerance:
                # Not a number is no better.
                better = float(found @ found) < float(residuals(before) @ residuals(before))
                raise _Settled(scaled if better else before)
        return found

    taken: list[tuple[Array, Array]] = []

    def jacobian(scaled: Array) -> Array:
        """Differences, those of before where the point hardly moved; asked for at each point that is better."""
        reached.append(scaled.copy())
        if not taken or np.abs(scaled - taken[-1][0]).max() > KEPT * controls.difference:
            taken.append((scaled.copy(), differences(scaled)))
        return taken[-1][1].copy()

    def differences(scaled: Array) -> Array:
        pairs = [_pair(scaled, index, controls) for index in range(len(parameters))]
        points = [point_at(each) for pair in pairs for each in pair]
        figures = remembered(points)
        for point, computed in zip(points, figures, strict=True):
            if not np.isfinite(computed.values).all():
                raise NotComputed(point)
        columns = []
        for index, parameter in enumerate(parameters):
            low, high = points[2 * index : 2 * index + 2]
            # The step as it was taken: values are rounded.
            step = parameter.scaled(high[index]) - parameter.scaled(low[index])
            change = figures[2 * index + 1].values - figures[2 * index].values
            columns.append(change / step / uncertainties)
        return np.column_stack(columns)

    start = np.array([each.scaled(each.start) for each in parameters])
    if not np.isfinite(residuals(start)).all():
        raise NotComputed(point_at(start))
    # From 1 to 2 instead of 0 to 1: the first step may be as long as the variables, so that a start near the lower
    # bound would creep.
    try:
        found = least_squares(
            lambda shifted: tried(shifted - _SHIFT),
            start + _SHIFT,
            jac=lambda shifted: jacobian(shifted - _SHIFT),
            bounds=(_SHIFT, 1.0 + _SHIFT),
            method="trf",
            xtol=None,
            ftol=controls.tolerance**2,
            gtol=1e-12,
            max_nfev=controls.most_steps,
        )
        end, converged = found.x - _SHIFT, found.status > 0
        ending = {
            0: f"stopped after {controls.most_steps} steps, before it converged",
            1: "the gradient vanishes",
            2: "the misfit does not fall any more",
        }[int(found.status)]
    except _Settled as settled:
        end, converged = settled.scaled, True
        ending = f"steps are below {controls.tolerance:g} of the bounds' range"
    point = point_at(end)
    (computed,) = remembered([point])
    return Fit(point, computed, jacobian(end), converged, ending, len(trials))


def _pair(scaled: Array, index: int, controls: Controls) -> tuple[Array, Array]:
    """The two points whose difference is the derivative by parameter ``index``, both within the bounds."""
    low, high = scaled.copy(), scaled.copy()
    up, down = scaled[index] + controls.difference, scaled[index] - controls.difference
    if up <= 1.0:
        high[index] = up
    if down >= 0.0 and (controls.central or up > 1.0):
        low[index] = down
    return low, high
