"""Newton's method where particles stick and slip: a chain of springs on a rough floor."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from problems import Array

from pfemcut.fem.momentum_system import NodalForces
from pfemcut.pfem.newton import Linearisation, NotConverged, solve_momentum, solve_with_friction
from pfemcut.problem import NewtonControls

V_REF = 1e-3  # of the loads and first guesses, as 1 mm/s is of a cutting speed
CONTROLS = NewtonControls(tolerance=1e-6, max_iterations=15)


def springs(count: int) -> Array:
    """Stiffness of springs between neighbours."""
    return 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)


def along_x(count: int) -> Array:
    """All unknowns are prescribed but the displacements along x."""
    return np.column_stack([np.zeros(count, dtype=bool), np.ones((count, 2), dtype=bool)])


class Chain:
    """Stands in for a momentum system: particles that move along x, held by springs and pulled by ``load`` (n,)."""

    def __init__(self, load: Array) -> None:
        self.load = load
        self.springs = springs(len(load))

    def internal_residual(self, unknown: Array, _: Array) -> Array:
        residual = np.zeros_like(unknown)
        residual[:, 0] = self.springs @ unknown[:, 0] - self.load
        return residual

    def solve(self, residual: Array, nodal: NodalForces) -> tuple[Array, bool]:
        correction = np.zeros_like(residual)
        correction[:, 0] = np.linalg.solve(self.springs + np.diag(nodal.stiffness[:, 0, 0]), -residual[:, 0])
        return correction, True


def rough(strength: Array, reference_speed: float = V_REF) -> Callable[[Array, float], Linearisation]:
    """Friction of the ``strength`` (n,), regularised by tanh."""
    count = len(strength)
    particles = np.arange(count)

    def linearise(unknown: Array, smoothing: float = 1.0) -> Linearisation:
        width = reference_speed * smoothing
        ratio = np.tanh(unknown[:, 0] / width)
        forces, stiffness = np.zeros((count, 2)), np.zeros((count, 2, 2))
        forces[:, 0] = -strength * ratio
        stiffness[:, 0, 0] = strength * (1.0 - ratio**2) / width
        return Linearisation(np.empty((0, 0)), NodalForces.local(particles, forces, stiffness), 1.0)

    return linearise


def chains(count: int = 6) -> list[tuple[Chain, Array, Array]]:
    """Chains of ``count`` particles with their friction's strengths and first guesses, drawn with a fixed seed."""
    generator = np.random.default_rng(1)
    return [
        (
            Chain(generator.normal(size=count)),
            generator.uniform(0.2, 1.5, count),
            np.column_stack([generator.normal(size=count), np.zeros((count, 2))]),
        )
        for _ in range(50)
    ]


def test_friction_converges_in_stages_where_newton_alone_swings() -> None:
    """Alone it fails in most of them, so that the test means something; in stages it never does."""
    alone = 0
    for chain, strength, start in chains():
        linearise = rough(strength)
        arguments = (start, along_x(len(start)), np.ones(len(start)), 1e-9, CONTROLS)
        try:
            solve_momentum(chain, linearise, *arguments)  # type: ignore[arg-type]
            alone += 1
        except NotConverged:
            pass
        found = solve_with_friction(chain, linearise, *arguments)  # type: ignore[arg-type]
        slip = found.unknown[:, 0]
        # The solution is that of the friction asked for, not of a smoother one.
        balance = chain.springs @ slip + strength * np.tanh(slip / V_REF) - chain.load
        assert np.abs(balance).max() < 1e-5
    assert alone < 25


def test_stages_come_closer_where_many_particles_stick() -> None:
    """With stages always by a factor of 4, and a first one that is fixed, most of these 50 fail."""
    reference_speed = 0.1 * V_REF
    for chain, strength, start in chains(count=80):
        count = len(start)
        found = solve_with_friction(
            chain,  # type: ignore[arg-type]
            rough(strength, reference_speed),
            start,
            along_x(count),
            np.ones(count),
            1e-9,
            CONTROLS,
        )
        slip = found.unknown[:, 0]
        balance = chain.springs @ slip + strength * np.tanh(slip / reference_speed) - chain.load
        assert np.abs(balance).max() < 1e-4


def test_iterations_of_all_stages_count() -> None:
    chain, strength, start = chains()[0]
    linearise = rough(strength)
    arguments = (start, along_x(len(start)), np.ones(len(start)), 1e-9)
    with pytest.raises(NotConverged) as failure:
        solve_momentum(chain, linearise, *arguments, CONTROLS)  # type: ignore[arg-type]
    assert failure.value.iterations == CONTROLS.max_iterations
    unaided = NewtonControls(CONTROLS.tolerance, max_iterations=1000)
    found = solve_with_friction(chain, linearise, *arguments, unaided)  # type: ignore[arg-type]
    # Ten in vain, then at least one in each of the stages.
    assert found.iterations > 10 + 5


def test_without_convergence_in_stages_either_the_step_fails() -> None:
    chain, strength, start = chains()[0]
    with pytest.raises(NotConverged):
        solve_with_friction(
            chain,  # type: ignore[arg-type]
            rough(strength),
            start,
            along_x(len(start)),
            np.ones(len(start)),
            1e-9,
            NewtonControls(tolerance=1e-6, max_iterations=1),
        )
