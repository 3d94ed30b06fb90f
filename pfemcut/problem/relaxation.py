"""What becomes of a body when its cut is over: the tool withdraws, the body cools down, the clamps let go.

Each is a stage of its own (:attr:`Problem.after`) without remeshing, whose steps grow as fast as they may: nothing
moves far any more, and conduction has all time scales from that of the cut to that of the whole body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.problem.conditions import (
    Convection,
    PrescribedMotion,
    PrescribedTemperature,
    Schedule,
    constant,
)
from pfemcut.problem.controls import Integrator, NewtonControls, TimeControls
from pfemcut.problem.problem import MovingTool, Problem

Array = NDArray[np.float64]

_UNLOADING_STEPS = 10.0  # of the largest length in the way of the tool
_UNLOADING_GROWTH = 1.25
_RELEASE_STEPS = 2
_HALVINGS = 60
_TOLERANCE = (
    1e-5  # of the momentum residual: without a tool only the supports' forces are left to compare it with
)


@dataclass(frozen=True)
class Withdrawal:
    """The tool goes back, equally far from its rake and its flank face.

    Attributes
    ----------
    distance
        mm.
    speed
        mm/s.
    """

    distance: float
    speed: float


@dataclass(frozen=True)
class Cooling:
    """The body cools down to the temperature of its surroundings.

    Attributes
    ----------
    temperature
        Of the surroundings (K).
    sinks
        Boundary parts that have it: there the body goes on, as a large piece that stays cold.
    free
        Boundary parts in air.
    coefficient
        Heat transfer coefficient there (N/(mm s K)); 0 insulates.
    time
        How long (s).
    steps
        Number of steps, which grow geometrically.
    """

    temperature: float
    sinks: tuple[str, ...]
    free: tuple[str, ...]
    coefficient: float
    time: float
    steps: int


@dataclass(frozen=True)
class Release:
    """The supports let go, but for what keeps the body from moving as a whole.

    Attributes
    ----------
    supports
        Motions of the body that remain.
    """

    supports: tuple[PrescribedMotion, ...]


def withdrawn(problem: Problem, last: Problem, how: Withdrawal) -> Problem:
    """The stage after ``last`` in which the tool withdraws.

    The penalty springs and the elastic deflection under the tool let go over about a micrometre, in steps that begin
    with a quarter of the cut's.
    """
    start = last.time.end
    end = start + how.distance / how.speed
    (tool,) = last.tool
    back = -(tool.shape.rake_normal + tool.shape.flank_normal)
    velocity = how.speed * back / np.hypot(*back)
    stage = _stage(problem, last, end, problem.time.step, (end - start) / _UNLOADING_STEPS, _UNLOADING_GROWTH)
    return _with_tool(stage, last, (float(velocity[0]), float(velocity[1])))


def cooled(problem: Problem, last: Problem, how: Cooling) -> Problem:
    """The stage after ``last`` in which the body cools down; the tool, if any, stands still."""
    first = min(problem.time.step, how.time / how.steps)
    growth = _growth(how.time / first, how.steps)
    stage = _stage(problem, last, last.time.end + how.time, first, how.time, growth, first_step_fraction=1.0)
    ambient = constant(how.temperature)
    return replace(
        _with_tool(stage, last, (0.0, 0.0)),
        temperatures=tuple(PrescribedTemperature(part, ambient) for part in how.sinks),
        convections=tuple(
            Convection(part, how.coefficient, ambient) for part in how.free if how.coefficient > 0.0
        ),
        fluxes=(),
        heat_bands=(),
    )


def released(problem: Problem, last: Problem, how: Release) -> Problem:
    """The stage after ``last`` in which the clamps let go; it takes a hundredth of the time until then."""
    lasts = 0.01 * last.time.end
    step = lasts / _RELEASE_STEPS
    stage = _stage(problem, last, last.time.end + lasts, step, step, 1.5, first_step_fraction=1.0)
    stage = _with_tool(stage, last, (0.0, 0.0))
    parts = set(problem.body.parts)
    return replace(
        stage,
        motions=(*(motion for motion in stage.motions if motion.part not in parts), *how.supports),
        temperatures=last.temperatures,
        convections=last.convections,
        fluxes=last.fluxes,
        heat_bands=last.heat_bands,
    )


def relaxed(problem: Problem, stages: tuple[Withdrawal | Cooling | Release, ...]) -> Problem:
    """``problem`` with what comes after it."""
    after: list[Problem] = []
    for how in stages:
        last = after[-1] if after else problem
        match how:
            case Withdrawal():
                after.append(withdrawn(problem, last, how))
            case Cooling():
                after.append(cooled(problem, last, how))
            case Release():
                after.append(released(problem, last, how))
    return replace(problem, after=tuple(after))


def _stage(
    problem: Problem,
    last: Problem,
    end: float,
    step: float,
    largest_step: float,
    growth: float,
    first_step_fraction: float = 0.25,
) -> Problem:
    """``last`` until ``end`` (s), without what only a cut needs, and with steps that grow whatever flows."""
    time = TimeControls(
        step=step,
        largest_step=max(largest_step, step),
        step_tolerance=math.inf,
        end=end,
        first_step_fraction=first_step_fraction,
        growth=growth,
        smallest_step_fraction=problem.time.smallest_step_fraction,
        integrator=Integrator.IMPLICIT,
        heat_source=problem.time.heat_source,
        inertia=False,
    )
    tolerance = min(problem.newton.tolerance, _TOLERANCE)
    return replace(
        last,
        time=time,
        newton=NewtonControls(tolerance, problem.newton.max_iterations),
        particles=replace(last.particles, remesh=False),
        cut=(),
        after=(),
    )


def _with_tool(stage: Problem, last: Problem, velocity: tuple[float, float]) -> Problem:
    """``stage`` with the tools of ``last`` moving with ``velocity`` (mm/s) from then on, and their supports."""
    start, end = last.time.end, stage.time.end
    of_tools = {
        part for body in last.others for tool in last.tool if tool.body == body.name for part in body.parts
    }

    def going_on(motion: PrescribedMotion) -> PrescribedMotion:
        if motion.part not in of_tools:
            return motion
        moved = motion.displacement(start)
        shift = velocity[motion.axis.value] * (end - start)
        return replace(motion, displacement=Schedule((start, end), (moved, moved + shift)))

    tools: tuple[MovingTool, ...] = tuple(tool.going_on(start, velocity) for tool in last.tool)
    return replace(stage, tool=tools, motions=tuple(map(going_on, stage.motions)))


def _growth(ratio: float, steps: int) -> float:
    """Ratio of steps of which ``steps`` make ``ratio`` (>= ``steps``) times the first."""

    def excess(more: float) -> float:
        return math.expm1(steps * math.log1p(more)) / more - ratio

    # Bisection: not worth loading scipy, which a check of a case would wait for.
    lowest, highest = 1e-9, ratio ** (1.0 / (steps - 1)) - 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (lowest + highest)
        if excess(middle) < 0.0:
            lowest = middle
        else:
            highest = middle
    return 1.0 + lowest
