"""Energy of the vibrating bar by the leapfrog of pfemcut and by predictor-correctors, at equal cost.

PECE (Heun): predict with the old forces, evaluate, correct with the mean of old and new forces, evaluate again. PEC
leaves the second evaluation out. Cost is counted in evaluations of forces.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from pfemcut.particles.integrate import advance, initial_state, kinetic_energy, stable_step
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.stress import elastic_energy
from pfemcut.sph.tlsph import TotalLagrangian

PERIODS = 20.0


def compared(bar: Callable[..., ParticleProblem], period: float) -> list[dict[str, Any]]:
    """Change of energy over 20 periods by scheme and Courant number; ``bar`` makes the problem for the latter."""
    rows = []
    for scheme, evaluations, courants in (
        ("leapfrog", 1, (0.15, 0.3, 0.6)),
        ("predictor-corrector, PECE", 2, (0.3, 0.6, 1.0)),
        ("predictor-corrector, PEC", 1, (0.15, 0.3, 0.6)),
    ):
        for courant in courants:
            problem = bar(courant=courant)
            rows.append(
                {
                    "scheme": scheme,
                    "courant": courant,
                    "evaluations_per_period": evaluations * period / stable_step(problem, problem.velocities),
                    "energy_change_%": 100.0 * change(problem, scheme, PERIODS * period),
                }
            )
            print(rows[-1], flush=True)
    return rows


def change(problem: ParticleProblem, scheme: str, duration: float) -> float:
    """Change of kinetic and elastic energy over its start's."""
    model = TotalLagrangian(problem)
    start = kinetic_energy(problem, problem.velocities)
    if scheme == "leapfrog":
        state = initial_state(model)
        while state.clock.time < duration:
            state = advance(model, state)
        return (_energy(problem, state.velocities, state.material, state.volume_ratio) - start) / start
    state = initial_state(model)
    x, v, memory, material = state.positions, state.velocities, state.memory, state.material
    mass, free = problem.mass[:, None], ~problem.held
    acceleration, ratio = np.zeros_like(x), state.volume_ratio
    dt, time = stable_step(problem, v), 0.0
    while time < duration:
        guess = x + dt * v + 0.5 * dt * dt * free * acceleration
        found = model.evaluate(memory, material, guess, (guess - x) / dt, dt)
        new = (found.internal + found.control) / mass
        ahead = x + dt * v + 0.25 * dt * dt * free * (acceleration + new)
        v = v + 0.5 * dt * free * (acceleration + new)
        if scheme.endswith("PECE"):
            found = model.evaluate(memory, material, ahead, (ahead - x) / dt, dt)
            new = (found.internal + found.control) / mass
        x, memory, material, ratio, acceleration = (
            ahead,
            found.memory,
            found.material,
            found.volume_ratio,
            new,
        )
        time += dt
        if not np.isfinite(v).all() or np.abs(v).max() > 1e6:
            return float("inf")
    return (_energy(problem, v, material, ratio) - start) / start


def _energy(problem: ParticleProblem, velocities: Any, material: Any, ratio: Any) -> float:
    steel = problem.bodies[0].material
    stored = elastic_energy(
        problem.by_body([steel.bulk_modulus]),
        problem.by_body([steel.shear_modulus]),
        material.deviator,
        ratio,
    )
    return kinetic_energy(problem, velocities) + float(problem.volume @ stored)
