"""Eulerian SPH: neighbours, gradients, ledgers, restart, and clusters under tension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from particle_problems import CUT, ELASTIC, PRESSING, TAYLOR, block, impact, moving

from pfemcut.case.load import directed, validated
from pfemcut.case.translate import problem_of
from pfemcut.driver import run_case
from pfemcut.particles.cells import NeighbourList, pairs_in_cells
from pfemcut.particles.lattice import box_lattice
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.neighbours import neighbours_within
from pfemcut.particles.problem import ParticleProblem
from pfemcut.results.history import read_table
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.eulerian import PairConstants, pair_forces, velocity_sums
from pfemcut.sph.reference import inverse_moments
from tests.verification.sph_tension.verify import stretched

Array = NDArray[np.float64]
SPACING, SMOOTHING = 0.1, 0.15
CASES = [{**TAYLOR, "method": "esph"}, {**CUT, "method": "esph"}]


def irregular(dimension: int) -> Array:
    points, _ = box_lattice(np.zeros(dimension), np.array([1.0, 0.7, 0.6])[:dimension], SPACING)
    return points + np.random.default_rng(1).uniform(-0.2, 0.2, points.shape) * SPACING


@pytest.mark.parametrize("dimension", [2, 3])
def test_cells_find_the_neighbours_that_a_tree_finds(dimension: int) -> None:
    """In the same order; with a particle far away too, where cells grow instead of using up the memory."""
    for points in (irregular(dimension), np.vstack([irregular(dimension), np.full(dimension, 1e5)])):
        offsets, indices = pairs_in_cells(points, 0.3)
        rows = neighbours_within(points, 0.3, np.zeros(len(points), dtype=np.int64))
        assert (offsets == rows.offsets).all()
        assert (indices == rows.indices).all()


def test_a_list_is_kept_while_particles_move_little() -> None:
    points = irregular(2)
    neighbours = NeighbourList(0.3)
    neighbours.follow(points)
    first = neighbours.indices
    neighbours.follow(points + 0.01)
    assert neighbours.indices is first
    neighbours.follow(points + 3.0)
    assert neighbours.indices is first
    neighbours.follow(1.1 * points)
    assert neighbours.indices is not first


@pytest.mark.parametrize("dimension", [2, 3])
def test_corrected_velocity_gradients_are_exact_for_linear_fields(dimension: int) -> None:
    """To 1e-11 of the gradient."""
    points = irregular(dimension)
    neighbours = NeighbourList(2.0 * SMOOTHING)
    neighbours.follow(points)
    exact = np.random.default_rng(2).normal(size=(dimension, dimension))
    volume = np.full(len(points), SPACING**dimension)
    rates, moments = velocity_sums(neighbours, points, points @ exact.T, volume, SMOOTHING)
    assert np.abs(rates @ inverse_moments(moments, True) - exact).max() < 1e-11
    assert np.abs(rates - exact).max() > 0.1


@pytest.mark.parametrize("dimension", [2, 3])
def test_forces_conserve_momentum_and_do_the_work_of_the_stress(dimension: int) -> None:
    """Momentum to 1e-13 of the magnitudes; the power is that of stress and gradient to 1e-12, at any densities."""
    points = irregular(dimension)
    neighbours = NeighbourList(2.0 * SMOOTHING)
    neighbours.follow(points)
    random = np.random.default_rng(3)
    count = len(points)
    volume = random.uniform(0.9, 1.1, count) * SPACING**dimension
    velocities = random.normal(size=points.shape)
    density = random.uniform(4e-9, 8e-9, count)
    stress = random.normal(size=(count, dimension, dimension))
    constants = PairConstants(SMOOTHING, SPACING, 1.0, 1.0, 5e6, 0.3)
    rates, moments = velocity_sums(neighbours, points, velocities, volume, SMOOTHING)
    correction = inverse_moments(moments, True)
    forces = pair_forces(
        neighbours,
        points,
        velocities,
        density * volume,
        density,
        stress @ correction,
        random.normal(size=count),
        constants,
    )
    for force in forces:
        assert np.abs(force).max() > 0.0
        assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    inner = np.einsum("n,nab,nab->", volume, stress, rates @ correction)
    assert np.vdot(forces[0], velocities) == pytest.approx(-inner, rel=1e-12)
    assert np.vdot(forces[1], velocities) < 0.0


@pytest.mark.parametrize("case", CASES, ids=["taylor", "cut"])
def test_a_run_keeps_its_books_and_resumes_bit_for_bit(case: Mapping[str, Any], tmp_path: Path) -> None:
    """Energy to 2 % of the supply, momentum to 1e-12."""
    parsed, material = validated(case, Path())
    for name in ("whole", "again"):
        run_case(directed(parsed, tmp_path / name), material, tmp_path / name)
    again = tmp_path / "again"
    (again / "checkpoint.previous.h5").replace(again / "checkpoint.h5")
    run_case(directed(parsed, again), material, again, resume=True)
    assert (again / "history.csv").read_text() == (tmp_path / "whole" / "history.csv").read_text()
    history = read_table(again / "history.csv")
    assert abs(history["energy_error"][-1]) < 0.02
    assert history["momentum_error"].max() < 1e-12
    assert history["plastic_work"][-1] > 0.0


def test_a_free_body_that_turns_gets_no_stress() -> None:
    """With corrected gradients, a tenth of a turn leaves less than 3 % of the yield stress, and no plastic strain."""
    rate = 2e5
    problem = moving(
        block((1.0, 0.5), method="esph", end=0.2 * np.pi / rate),
        lambda x: rate * np.column_stack([-(x[:, 1] - 0.25), x[:, 0] - 0.5]),
    )
    method = ParticleMethod.start(Eulerian(problem))
    while not method.finished:
        method.advance()
    assert method.measure().max_eqps == 0.0
    assert np.abs(method.current.material.deviator).max() < 0.03 * 792.0


@pytest.mark.parametrize("corrected", [False, True])
@pytest.mark.parametrize(
    ("method", "gamma", "clusters"), [("esph", 0.0, True), ("esph", 0.3, False), ("tlsph", 0.0, False)]
)
def test_tension_makes_clusters_in_eulerian_sph_alone(
    method: str, gamma: float, clusters: bool, corrected: bool
) -> None:
    """Elastic, 15 % larger than its mass wants, disturbed by 0.1 m/s: the nearest pair is below 0.3 or above 0.9 dp."""
    _, nearest = stretched(method, gamma, corrected, 1.15)
    assert nearest[-1] < 0.3 if clusters else nearest[-1] > 0.9


def test_bodies_touch_through_the_same_sums() -> None:
    """Two equal elastic blocks that meet exchange their momentum, and don't overlap."""
    one = block((0.5, 0.5), method="esph", material=ELASTIC, end=4e-7)
    (body,) = one.bodies
    left = replace(body, velocity=np.array([1e5, 0.0]))
    right = replace(body, points=body.points + [0.75, 0.0], velocity=np.array([-1e5, 0.0]))
    problem = replace(one, bodies=(left, right), time=replace(one.time, end=3e-6))
    method = ParticleMethod.start(Eulerian(problem))
    gaps, mean = impact(method, problem)
    assert min(gaps) > 0.5 * SPACING
    assert mean[0] < -2e4
    assert mean[1] == pytest.approx(-mean[0], rel=1e-6)


@pytest.mark.parametrize("contact", ["kernel", "pinball"])
def test_a_rigid_body_presses_another(contact: str) -> None:
    """Energy to 1 %; sums over the kernel strain the rigid body too, pinballs leave it as it was."""
    table = {**PRESSING, "method": "esph", "particles": {**PRESSING["particles"], "contact": contact}}
    problem = problem_of(*validated(table, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    method = ParticleMethod.start(Eulerian(problem))
    while not method.finished:
        method.advance()
    _, tool = problem.ranges
    state = method.current
    assert abs(method.measure().energy_error) < 0.01
    assert method.own_measures()["momentum_error"] < 1e-12
    assert state.material.eqps[:60].max() > 0.1
    assert state.positions[:60, 0].max() < state.positions[tool, 0].min()
    strained = np.abs(state.volume_ratio[tool] - 1.0).max() > 0.0
    assert strained == (contact == "kernel")
