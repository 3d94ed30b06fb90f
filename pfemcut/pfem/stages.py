"""From one stage of a problem to the next, such as from the cut to unloading."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.pfem.state import State
from pfemcut.problem import Problem

Array = NDArray[np.float64]


def entered(last: Problem, stage: Problem, state: State) -> State:
    """``state`` at the end of the stage ``last``, as ``stage`` begins with it.

    Steps begin anew, and from rest: the motion of the last stage says nothing about the next.
    """
    return replace(
        state,
        clock=replace(state.clock, next_dt=stage.time.first_step_fraction * stage.time.step),
        fields=replace(state.fields, last_displacement=np.zeros_like(state.fields.last_displacement)),
        last_reactions=matching_reactions(last, stage, state.last_reactions),
    )


def matching_reactions(stage: Problem, wanted: Problem, reactions: Array) -> Array:
    """``reactions`` (motions, 3) of one stage in the order of another's motions; zero for those it does not have."""
    found = {
        (motion.part, motion.axis, motion.corner): reaction
        for motion, reaction in zip(stage.motions, reactions, strict=True)
    }
    none = np.zeros(3)
    rows = [found.get((motion.part, motion.axis, motion.corner), none) for motion in wanted.motions]
    return np.array(rows).reshape(len(wanted.motions), 3)
