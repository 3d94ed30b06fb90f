"""Heat conduction between explicit particles against exact solutions, and its books."""

from __future__ import annotations

import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from particle_problems import CUT, ELASTIC, block

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.heat import Conduction, heat_content, pair_flow
from pfemcut.particles.integrate import heat_capacity, initial_state
from pfemcut.particles.lattice import box_lattice
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import State
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian

Array = NDArray[np.float64]
CONDUCTING = {**ELASTIC, "name": "conducting", "poisson_ratio": 0.3}
DIFFUSIVITY = 50.0 / (7.8e-9 * 470e6)
CASES = {"tlsph": TotalLagrangian, "esph": Eulerian}


def rod(spacing: float, method: str = "tlsph") -> tuple[ParticleProblem, State[Any]]:
    """A rod of 1 mm with cosine-shaped temperature; insulated ends keep that shape while it dies away."""
    problem = block((1.0, 0.2), method=method, material=CONDUCTING, spacing=spacing)
    model: Any = CASES[method](problem)
    state: Any = initial_state(model)
    heated = state.material.heated(100.0 * np.cos(np.pi * problem.points[:, 0]))
    return problem, replace(state, material=heated)


def amplitude(problem: ParticleProblem, state: State[Any]) -> float:
    mode = np.cos(np.pi * problem.points[:, 0])
    return float(mode @ (state.material.temperature - 293.0) / (100.0 * mode @ mode))


@pytest.mark.parametrize("method", ["tlsph", "esph"])
def test_a_cosine_dies_away_at_its_rate(method: str) -> None:
    """exp(-a pi² t) to 5 % at 20 spacings, half of that at 40 (ends of first order); heat to 1e-12 of what moved."""
    time = 1.0 / (DIFFUSIVITY * np.pi**2)
    errors = []
    for spacing in (0.05, 0.025):
        problem, state = rod(spacing, method)
        before = heat_content(problem, state.material.temperature)
        moved = float(np.abs(state.material.temperature - 293.0) @ heat_capacity(problem, state.volume_ratio))
        state = Conduction(problem).conducted(state, time)
        errors.append(amplitude(problem, state) / np.exp(-1.0) - 1.0)
        assert abs(heat_content(problem, state.material.temperature) - before) < 1e-12 * moved
    assert abs(errors[0]) < 0.05
    assert abs(errors[1]) < abs(errors[0]) / 1.9


@pytest.mark.parametrize("dimension", [2, 3])
def test_no_temperature_leaves_its_neighbours_range(dimension: int) -> None:
    """One hot particle among disturbed ones: however long the time, nothing gets hotter or colder than at the start."""
    size = (0.6, 0.5, 0.4)[:dimension]
    problem = block(size, material=CONDUCTING, spacing=0.1)
    random = np.random.default_rng(1)
    state: Any = initial_state(TotalLagrangian(problem))
    hot = np.zeros(len(problem.points))
    hot[len(hot) // 2] = 500.0
    state = replace(
        state,
        positions=state.positions + 0.02 * random.normal(size=state.positions.shape),
        material=state.material.heated(hot),
    )
    for time in (1e-4, 1e-3, 1e-1):
        after = Conduction(problem).conducted(state, time).material.temperature
        assert after.min() >= 293.0 - 1e-9
        assert after.max() <= 793.0 + 1e-9
    assert np.ptp(after) < 1.0


def test_two_materials_share_the_flux() -> None:
    """A bar of conductivities 10 and 90 between fixed ends, steady: the jump of slope at the interface is 9 to 3 %."""
    spacing, smoothing = 0.05, 0.075
    points, volume = box_lattice(np.zeros(2), np.array([2.0, 0.2]), spacing)
    count = len(points)
    conductivity = np.where(points[:, 0] < 1.0, 10.0, 90.0)
    neighbours = NeighbourList(2.0 * smoothing)
    neighbours.follow(points)
    fixed = (points[:, 0] < 0.2) | (points[:, 0] > 1.8)
    exact = np.where(points[:, 0] < 1.0, 90.0 * points[:, 0], 90.0 + 10.0 * (points[:, 0] - 1.0))
    group = np.zeros(count, dtype=np.int64)
    # The matrix of the flow, by columns.
    matrix = np.column_stack(
        [
            pair_flow(neighbours, group, points, np.full(count, volume), conductivity, unit, smoothing).power
            for unit in np.eye(count)
        ]
    )
    assert np.abs(matrix - matrix.T).max() < 1e-12 * np.abs(matrix).max()
    free = ~fixed
    found = exact.copy()
    found[free] = np.linalg.solve(matrix[np.ix_(free, free)], -matrix[np.ix_(free, fixed)] @ exact[fixed])
    left = (points[:, 0] > 0.3) & (points[:, 0] < 0.8)
    right = (points[:, 0] > 1.2) & (points[:, 0] < 1.7)
    slopes = [np.polyfit(points[part, 0], found[part], 1)[0] for part in (left, right)]
    assert slopes[0] / slopes[1] == pytest.approx(9.0, rel=0.03)
    assert np.abs(found - exact).max() < 0.03 * 100.0


def test_bodies_conduct_into_each_other_in_eulerian_sph_alone() -> None:
    one = block((0.5, 0.2), material=CONDUCTING, spacing=0.05)
    (body,) = one.bodies
    hot = replace(body, points=body.points + [0.5, 0.0], temperature=393.0)
    for method, model in CASES.items():
        formulation = block((0.5, 0.2), method=method, material=CONDUCTING).formulation
        problem = replace(one, bodies=(body, hot), formulation=formulation)
        made: Any = model(problem)
        state: Any = Conduction(problem).conducted(initial_state(made), 1e-3)
        warmed = state.material.temperature[problem.ranges[0]].max() > 293.1
        assert warmed == (method == "esph")


@pytest.mark.parametrize("method", ["tlsph", "esph"])
def test_a_cut_keeps_its_heat(method: str) -> None:
    """Content and loss to a cold tool are the heat of plastic work and friction to 1 %; adiabatic it is hotter."""
    table: Any = copy.deepcopy(CUT)
    table["method"] = method
    table["contact"]["conductance"] = 1e3
    table["tool"]["temperature"] = 293.15
    found = {}
    for conduction in (True, False):
        table["particles"]["conduction"] = conduction
        problem = problem_of(*validated(table, Path()), Path())
        assert isinstance(problem, ParticleProblem)
        made: Any = CASES[method](problem)
        run: Any = ParticleMethod.start(made)
        while not run.finished:
            run.advance()
        own, measures = run.own_measures(), run.measure()
        chi = problem.bodies[0].material.taylor_quinney
        made_heat = chi * measures.plastic_work + problem.contact.heat_partition * measures.friction_work
        assert own["heat_content"] + own["heat_to_tool"] == pytest.approx(made_heat, rel=0.01)
        assert (own["heat_to_tool"] > 0.0) == conduction
        found[conduction] = measures.max_temperature
    assert found[True] < found[False]
