"""How far heat comes into a tool during a cut, and what so short a cut can't tell of it."""

from __future__ import annotations

import math

import numpy as np

from pfemcut.problem import Problem

_HEATED_THROUGH = 0.5  # part of the tool's size that heat has to reach


def heated_depth(diffusivity: float, time: float) -> float:
    """2 sqrt(a t) (mm), where heat from a face that is kept hot is felt by 16 %; a in mm²/s.

    Carslaw and Jaeger, Conduction of Heat in Solids, 2nd ed., 1959, section 2.4: erfc(1) = 0.157.
    """
    return 2.0 * math.sqrt(diffusivity * time)


def tool_warnings(problem: Problem, time: float) -> list[str]:
    """What a cut of ``time`` (s) can't tell of the tools that take heat; none if no tool does."""
    found: list[str] = []
    for tool in problem.tool:
        for block in tool.conductor:
            diffusivity = block.conductivity / (block.density * block.capacity)
            found += _too_short(diffusivity, block.length, time)
        conducts = any(pair.law.conductance.value > 0.0 for pair in problem.pairs)
        for body in problem.others:
            if body.name == tool.body and conducts:
                start = np.array([body.temperature])
                capacity = body.material.density * body.material.capacity(start)[0]
                size = float(np.ptp(np.asarray(body.outline), axis=0).min())
                found += _too_short(float(body.material.conductivity(start)[0] / capacity), size, time)
    return found


def _too_short(diffusivity: float, size: float, time: float) -> list[str]:
    """A warning if a cut of ``time`` (s) does not heat a tool of ``size`` (mm) through, else none."""
    depth = heated_depth(diffusivity, time)
    if depth > _HEATED_THROUGH * size:
        return []
    return [
        f"the cut lasts {time:.2g} s, in which heat comes about {depth:.2g} mm far into the tool of {size:.2g} mm: "
        "its temperatures are those of a beginning cut"
    ]
