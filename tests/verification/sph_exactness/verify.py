"""What holds to round-off in SPH: gradients of linear fields, rotations, momentum; and how far energy does."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.integrate import energy_at_start, material_at_start
from pfemcut.particles.lattice import box_lattice
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.stress import von_mises
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.eulerian import velocity_sums
from pfemcut.sph.reference import inverse_moments, reference_of
from pfemcut.sph.tlsph import TotalLagrangian
from pfemcut.sph.total_lagrangian import deformation_gradient
from tests.particle_problems import ELASTIC, TAYLOR, block

from ..common import Array, save_picture, write_results

FOLDER = Path(__file__).parent
MODELS: dict[str, Any] = {"tlsph": TotalLagrangian, "esph": Eulerian}
COURANT = (0.6, 0.3, 0.15, 0.075)


def irregular(dimension: int, spacing: float) -> Array:
    """A block with particles moved by up to a fifth of the spacing."""
    size = np.array([1.0, 0.7, 0.6])[:dimension]
    points, _ = box_lattice(np.zeros(dimension), size, spacing)
    return points + np.random.default_rng(1).uniform(-0.2, 0.2, points.shape) * spacing


def gradient_error(method: str, dimension: int, corrected: bool, spacing: float = 0.1) -> float:
    """Largest error of the gradient of a linear field, over its largest component."""
    points = irregular(dimension, spacing)
    h = 1.5 * spacing
    volume = np.full(len(points), spacing**dimension)
    exact = np.random.default_rng(2).normal(size=(dimension, dimension))
    if method == "tlsph":
        body = reference_of(points, volume, np.zeros(len(points), dtype=np.int64), h, corrected)
        found = deformation_gradient(body, points + points @ exact.T) - np.eye(dimension)
    else:
        neighbours = NeighbourList(2.0 * h)
        neighbours.follow(points)
        rates, moments = velocity_sums(neighbours, points, points @ exact.T, volume, h)
        found = rates @ inverse_moments(moments, corrected)
    return float(np.abs(found - exact).max() / np.abs(exact).max())


def rotated(method: str, dimension: int, steps: int = 200) -> dict[str, float]:
    """A body of E = 200 GPa turned by one whole turn: largest von Mises stress (MPa) and change of density."""
    size = (1.0, 0.7, 0.6)[:dimension]
    problem = block(size, method=method, material={**ELASTIC, "poisson_ratio": 0.3})
    model = MODELS[method](problem)
    memory, material = model.start(), material_at_start(problem)
    start, angle = problem.points, 2.0 * np.pi / steps
    before, largest, density = start, 0.0, 0.0
    for step in range(1, steps + 1):
        turn = np.eye(dimension)
        cosine, sine = np.cos(step * angle), np.sin(step * angle)
        turn[:2, :2] = [[cosine, -sine], [sine, cosine]]
        positions = start @ turn.T
        # One second a step.
        found = model.evaluate(memory, material, positions, positions - before, 1.0)
        memory, material, before = found.memory, found.material, positions
        largest = max(largest, float(von_mises(material.deviator).max()))
        density = max(density, float(np.abs(found.volume_ratio - 1.0).max()))
    return {"von_mises_MPa": largest, "volume": density}


def taylor(method: str, courant: float) -> dict[str, Any]:
    """A short Taylor bar: errors of its books at the end."""
    table = copy.deepcopy(TAYLOR)
    table["method"] = method
    table["particles"]["courant"] = courant
    model = MODELS[method](problem_of(*validated(table, Path()), Path()))
    run = ParticleMethod.start(model)
    supply = energy_at_start(model.problem)
    worst = {"momentum": 0.0, "kinetic": 0.0, "energy_worst": 0.0}
    while not run.finished:
        run.advance()
        own, measures = run.own_measures(), run.measure()
        worst["momentum"] = max(worst["momentum"], own["momentum_error"])
        worst["kinetic"] = max(worst["kinetic"], abs(own["kinetic_error"]) / supply)
        worst["energy_worst"] = max(worst["energy_worst"], abs(measures.energy_error))
    inner = -own["internal_work"]
    return {
        "method": method,
        "courant": courant,
        "steps": run.current.clock.steps,
        "momentum_error": worst["momentum"],
        "kinetic_error_over_supply": worst["kinetic"],
        "energy_error_%": 100.0 * worst["energy_worst"],
        "stress_work_error_%": 100.0 * abs(measures.plastic_work + measures.elastic_energy - inner) / inner,
    }


def main() -> None:
    rows = [taylor(method, courant) for method in MODELS for courant in COURANT]
    gradients = {
        f"{method}, {dimension}D": {
            "corrected": gradient_error(method, dimension, True),
            "not_corrected_%": 100.0 * gradient_error(method, dimension, False),
        }
        for method in MODELS
        for dimension in (2, 3)
    }
    rotations = {
        f"{method}, {dimension}D": rotated(method, dimension) for method in MODELS for dimension in (2, 3)
    }
    default = {row["method"]: row for row in rows if row["courant"] == 0.3}
    write_results(
        FOLDER, rows, {"gradients": gradients, "rotation": rotations, "taylor_courant_0.3": default}
    )
    figure, axis = plt.subplots(figsize=(4.6, 3.4), layout="constrained")
    for method, mark in zip(MODELS, "os", strict=True):
        part = [row for row in rows if row["method"] == method]
        axis.loglog(
            COURANT, [row["stress_work_error_%"] for row in part], mark + "-", label=f"{method}, work"
        )
        axis.loglog(
            COURANT, [row["energy_error_%"] for row in part], mark + "--", label=f"{method}, whole balance"
        )
    axis.set(xlabel="Courant number", ylabel="error of energy (%)", title="Taylor bar")
    axis.set_xticks(COURANT, [str(each) for each in COURANT])
    axis.minorticks_off()
    axis.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
