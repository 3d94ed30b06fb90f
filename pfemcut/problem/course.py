"""How far a run is at a simulated time, also where later stages last far longer than the cut and take fewer steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.problem.controls import TimeControls

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Course:
    """Part of a run that is done at some instants; linear between.

    Attributes
    ----------
    times
        Instants (s), rising from 0 to the end of the run.
    shares
        Parts, from 0 to 1.
    """

    times: tuple[float, ...]
    shares: tuple[float, ...]

    def share(self, time: float) -> float:
        """The part that is done at a time (s)."""
        return float(np.interp(time, self.times, self.shares))

    def shares_at(self, times: Array) -> Array:
        """The parts that are done at times (s) of any shape."""
        return np.asarray(np.interp(times, self.times, self.shares))


def straight(end: float) -> Course:
    """The course of a run whose steps take equal times, until ``end`` (s)."""
    return Course((0.0, end), (0.0, 1.0))


def course_of(stages: Sequence[TimeControls]) -> Course:
    """The course of stages one after the other, by the steps that each is expected to take.

    The first advances evenly; the steps of the later ones grow, so that time says nothing there.
    """
    first, *later = stages
    instants, steps = [0.0, first.end], [0.0, max(first.end / first.largest_step, 1.0)]
    for stage in later:
        step, end = stage.first_step_fraction * stage.step, stage.end
        while instants[-1] < end:
            instants.append(min(instants[-1] + step, end))
            steps.append(steps[-1] + 1.0)
            step = min(step * stage.growth, stage.largest_step)
    return Course(tuple(instants), tuple(each / steps[-1] for each in steps))
