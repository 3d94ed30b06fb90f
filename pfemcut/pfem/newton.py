"""Newton's method with a residual line search for the momentum equation of one step, contact included."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.fem.momentum_system import MomentumSystem, NodalForces
from pfemcut.problem import NewtonControls

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_SMALLEST_FRACTION = 1.0 / 64.0  # of the Newton correction, in the line search
_SMALLEST_JACOBIAN = 0.2  # an element that keeps less of its area in one step has inverted, nearly
_SMOOTHING = 1024.0  # first V_ref over its own, where friction does not converge as it is
_RATIO = 4.0  # of one V_ref to the next, closer where that does not converge
_SMALLEST_RATIO = 1.2  # closer than this it is given up
_SMOOTHEST = 1e6  # V_ref over its own; smoother than this it is given up
_UNAIDED = 10  # iterations with friction as it is; a solve that needs more seldom ends
_STAGE_TOLERANCE = 1e-3  # relative, of the residual with smoother friction


class StepFailed(Exception):
    """The step did not converge or would invert an element; a shorter one may."""


class NotConverged(StepFailed):
    """The iteration did not converge.

    Attributes
    ----------
    iterations
        Number of linear solves.
    """

    def __init__(self, message: str, iterations: int):
        super().__init__(message)
        self.iterations = iterations


@dataclass(frozen=True)
class Linearisation:
    """What the weak form needs at an iterate besides the unknown.

    Attributes
    ----------
    element
        Element data; shape (m, components).
    nodal
        Contact and inertia forces.
    smallest_jacobian
        Smallest relative volume j of all elements.
    """

    element: Array
    nodal: NodalForces
    smallest_jacobian: float


@dataclass(frozen=True)
class Converged:
    """A converged iterate.

    Attributes
    ----------
    unknown
        Displacement increment (mm) and pressure (MPa); shape (n, 3).
    reactions
        Internal minus applied forces, not zero only where the motion is prescribed (N/mm); shape (n, 2).
    iterations
        Number of linear solves.
    """

    unknown: Array
    reactions: Array
    iterations: int


def solve_momentum(
    system: MomentumSystem,
    linearise: Callable[[Array], Linearisation],
    start: Array,
    fixed: BoolArray,
    pressure_scale: Array,
    smallest_force: float,
    controls: NewtonControls,
) -> Converged:
    """Solve for displacement increment and pressure.

    Parameters
    ----------
    system
        Residual and linear solver.
    linearise
        Element data and nodal forces at an iterate (n, 3).
    start
        First iterate, with the prescribed unknowns in place; shape (n, 3).
    fixed
        Prescribed unknowns; shape (n, 3).
    pressure_scale
        Factor that turns the residual of the pressure equation (mm²) into a force (N/mm); shape (n,).
    smallest_force
        Force (N/mm) below which nothing counts.
    controls
        Tolerance and iteration limit.

    Raises
    ------
    StepFailed
        If the iteration does not converge.
    """
    scale = np.ones(start.shape)
    scale[:, 2] = pressure_scale

    def evaluate(unknown: Array) -> tuple[Array, float, NodalForces, float]:
        at = linearise(unknown)
        if not at.smallest_jacobian > _SMALLEST_JACOBIAN:
            return np.empty(0), np.inf, at.nodal, 0.0
        residual = system.internal_residual(unknown, at.element)
        reference = float(np.linalg.norm(residual[:, :2][fixed[:, :2]]))
        np.subtract.at(residual, (at.nodal.particles[:, None], np.arange(2)), at.nodal.forces)
        norm = float(np.linalg.norm((residual * scale)[~fixed]))
        reference += float(np.linalg.norm(at.nodal.forces))
        return residual, norm if np.isfinite(norm) else np.inf, at.nodal, max(reference, smallest_force)

    unknown = start
    residual, norm, nodal, reference = evaluate(unknown)
    if not np.isfinite(norm):
        unknown = np.where(fixed, start, 0.0)
        unknown[:, 2] = start[:, 2]
        residual, norm, nodal, reference = evaluate(unknown)
    for iteration in range(controls.max_iterations + 1):
        if not np.isfinite(norm):
            raise StepFailed("an element would invert")
        if norm <= controls.tolerance * reference:
            return Converged(unknown, residual[:, :2], iteration)
        if iteration == controls.max_iterations:
            break
        correction, solved = system.solve(residual, nodal)
        if not solved or not np.all(np.isfinite(correction)):
            raise StepFailed("the linear solver failed")
        fraction = 1.0
        while True:
            candidate = unknown + fraction * correction
            found = evaluate(candidate)
            if found[1] < (1.0 - 1e-4 * fraction) * norm or fraction <= _SMALLEST_FRACTION:
                break
            fraction *= 0.5
        unknown = candidate
        residual, norm, nodal, reference = found
    raise NotConverged(
        f"no convergence in {controls.max_iterations} iterations (residual {norm:.2g} of {reference:.2g} N/mm)",
        controls.max_iterations,
    )


def solve_with_friction(
    system: MomentumSystem,
    linearise: Callable[[Array, float], Linearisation],
    start: Array,
    fixed: BoolArray,
    pressure_scale: Array,
    smallest_force: float,
    controls: NewtonControls,
) -> Converged:
    """Solve for displacement increment and pressure where there is friction.

    Where a particle nearly sticks, the shear traction jumps from one sign to the other over V_ref, and Newton's method
    may swing between the two for ever; a shorter step does not help. Then it is solved with V_ref first many times as
    large and then less and less, each time from the last solution: by a factor of 4 at a time, and by less where that
    is too much, as where a chip sticks along the whole tool.

    Parameters
    ----------
    linearise
        Element data and nodal forces at an iterate (n, 3), with V_ref times a smoothing factor.
    system, start, fixed, pressure_scale, smallest_force, controls
        See :func:`solve_momentum`.

    Raises
    ------
    StepFailed
        If the iteration does not converge so either.
    """

    def solve(smoothing: float, start: Array, controls: NewtonControls) -> Converged:
        def at(unknown: Array) -> Linearisation:
            return linearise(unknown, smoothing)

        return solve_momentum(system, at, start, fixed, pressure_scale, smallest_force, controls)

    try:
        return solve(1.0, start, replace(controls, max_iterations=min(controls.max_iterations, _UNAIDED)))
    except NotConverged as failure:
        iterations = failure.iterations
    rough = replace(controls, tolerance=max(controls.tolerance, _STAGE_TOLERANCE))
    smoothing, reached, ratio = _SMOOTHING, math.inf, _RATIO
    while True:
        try:
            found = solve(smoothing, start, controls if smoothing == 1.0 else rough)
        except NotConverged as failure:
            iterations += failure.iterations
            if math.isinf(reached):
                smoothing *= _RATIO
            else:
                ratio = math.sqrt(ratio)
                smoothing = max(reached / ratio, 1.0)
            if smoothing > _SMOOTHEST or ratio < _SMALLEST_RATIO:
                raise
            continue
        start, iterations = found.unknown, iterations + found.iterations
        if smoothing == 1.0:
            return replace(found, iterations=iterations)
        reached, smoothing = smoothing, max(smoothing / ratio, 1.0)
