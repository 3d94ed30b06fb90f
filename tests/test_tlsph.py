"""Total-Lagrangian SPH: runs through the driver, ledgers, waves, restart."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from particle_problems import CUT, ELASTIC, PRESSING, TAYLOR, block, impact, moving

from pfemcut.case.check import figures, warnings
from pfemcut.case.load import CaseError, directed, validated
from pfemcut.case.translate import problem_of
from pfemcut.conclusion import report_case
from pfemcut.driver import run_case
from pfemcut.method import RunStopped
from pfemcut.output.vtu import read_last_frame
from pfemcut.particles.integrate import advance, initial_state
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.problem import ParticleProblem
from pfemcut.results.history import read_table
from pfemcut.results.summary import Summary
from pfemcut.sph.tlsph import TotalLagrangian


def run(table: Mapping[str, Any], directory: Path, **options: bool) -> Summary:
    case, material = validated(table, Path())
    return run_case(directed(case, directory), material, directory, **options)


def particles_of(table: Mapping[str, Any]) -> ParticleProblem:
    problem = problem_of(*validated(table, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    return problem


def changed(table: Mapping[str, Any], section: str, **values: Any) -> dict[str, Any]:
    new = copy.deepcopy(dict(table))
    new[section].update(values)
    return new


def internal_mismatch(history: Mapping[str, Any]) -> float:
    """Plastic work and elastic energy, less the work against internal forces, over it, at the end."""
    done = -history["internal_work"][-1]
    return abs(float(history["plastic_work"][-1] + history["elastic_energy"][-1] - done)) / float(done)


@pytest.mark.parametrize("case", [TAYLOR, {**CUT, "method": "tlsph"}], ids=["taylor", "cut"])
def test_a_run_goes_through_the_driver_and_resumes_bit_for_bit(case: dict[str, Any], tmp_path: Path) -> None:
    whole = run(case, tmp_path / "whole")
    assert whole.finished
    # The end time is part of the case, so the interrupted run is one whose last steps are thrown away.
    again = tmp_path / "again"
    run(case, again)
    (again / "checkpoint.previous.h5").replace(again / "checkpoint.h5")
    run(case, again, resume=True)
    assert (again / "history.csv").read_text() == (tmp_path / "whole" / "history.csv").read_text()
    frame = read_last_frame(tmp_path / "whole")
    assert frame.points.shape[0] == read_table(tmp_path / "whole" / "history.csv")["nodes"][-1]
    report_case(tmp_path / "whole")
    assert (tmp_path / "whole" / "report.html").exists()


def test_a_bar_that_hits_a_wall_keeps_its_books(tmp_path: Path) -> None:
    """Energy to 0.5 % of the supply, kinetic energy and work to 1e-10 of it, momentum to 1e-12.

    Plastic work is that of the stress at the end of a step, so its books with the work of internal forces close to 1 %,
    and to half of it with half the step. The bar gets shorter and thicker.
    """
    summary = run(TAYLOR, tmp_path)
    history = read_table(tmp_path / "history.csv")
    run(changed(TAYLOR, "particles", courant=0.15), tmp_path / "finer")
    finer = read_table(tmp_path / "finer" / "history.csv")
    supply = 0.5 * particles_of(TAYLOR).mass.sum() * 181e3**2
    assert np.abs(history["energy_error"]).max() < 0.005
    assert internal_mismatch(history) < 0.01
    assert internal_mismatch(finer) < 0.5 * internal_mismatch(history)
    assert np.abs(history["kinetic_error"]).max() < 1e-10 * supply
    assert history["momentum_error"].max() < 1e-12
    assert history["plastic_work"][-1] > 0.3 * supply
    assert 13.0 < float(summary.figures["final_length"]["value"]) < 15.0
    assert 7.6 < float(summary.figures["mushroom_diameter"]["value"]) < 10.0


def test_a_cut_has_forces_of_the_right_sign_and_keeps_its_books(tmp_path: Path) -> None:
    """1 to 3.5 kN/mm² of uncut chip at so short a travel; energy to 2 %, momentum to 1e-12."""
    run({**CUT, "method": "tlsph"}, tmp_path)
    history = read_table(tmp_path / "history.csv")
    last = history["travel"] > 0.01
    assert (history["cutting_force"][last] > 100.0).all()
    assert (history["cutting_force"][last] < 350.0).all()
    assert (history["thrust_force"][last] > 0.0).all()
    assert history["friction_work"][-1] > 0.0
    assert np.abs(history["energy_error"][last]).max() < 0.02
    assert history["momentum_error"].max() < 1e-12
    assert (history["contact_length"][last] > 0.0).all()


def test_the_ledger_misses_nothing_when_the_reference_is_renewed(tmp_path: Path) -> None:
    """Energy to 2 % with an update every few batches."""
    case = changed({**CUT, "method": "tlsph"}, "particles", reference_update=0.05)
    run(case, tmp_path)
    history = read_table(tmp_path / "history.csv")
    assert history["reference_updates"][-1] > 3
    assert abs(history["energy_error"][-1]) < 0.02


def test_the_control_of_zero_energy_modes_outlives_a_new_reference() -> None:
    """Its forces change by less than 20 % of their norm at an update in a cut; forgotten, they changed by 100 %."""
    model = TotalLagrangian(particles_of({**CUT, "method": "tlsph"}))
    state = initial_state(model)
    renewed = False
    while not renewed:
        state = advance(model, state)
        memory, renewed = model.renewed(state.memory, state.positions, state.volume_ratio)
    rest = np.zeros_like(state.positions)
    before, after = (
        model.evaluate(each, state.material, state.positions, rest, 1e-30).control
        for each in (state.memory, memory)
    )
    assert state.material.eqps.max() > 0.1
    assert np.linalg.norm(after - before) < 0.2 * np.linalg.norm(before)


def test_a_bar_vibrates_with_its_wave_speed() -> None:
    """The longest wave of a free bar of nu = 0, held across: period 2 L sqrt(rho / E) to 0.5 %, without damping."""
    length = 4.0
    hold = [{"box": [[0.0, 0.0], [length, 1.0]], "axes": "y"}]
    plain = block(
        (length, 0.5),
        end=1e-5,
        material=ELASTIC,
        hold=hold,
        alpha=0.0,
        beta=0.0,
        zero_energy=0.0,
        reference_update=0.0,
    )
    mode = np.cos(np.pi * plain.points[:, 0] / length)
    problem = moving(plain, lambda x: np.column_stack([1e3 * mode, 0.0 * mode]))
    model = TotalLagrangian(problem)
    state = initial_state(model)
    period = 2.0 * length / np.sqrt(200e3 / 7.8e-9)
    times, amplitudes = [0.0], [1.0]
    while state.clock.time < 1.1 * period:
        state = advance(model, state)
        times.append(state.clock.time)
        amplitudes.append(float(mode @ state.velocities[:, 0] / (1e3 * mode @ mode)))
    crossings = [
        t0 + (t1 - t0) * a0 / (a0 - a1)
        for t0, t1, a0, a1 in zip(times[:-1], times[1:], amplitudes[:-1], amplitudes[1:], strict=True)
        if a0 * a1 < 0.0
    ]
    assert 2.0 * (crossings[1] - crossings[0]) == pytest.approx(period, rel=0.005)
    assert max(amplitudes[len(amplitudes) // 2 :]) == pytest.approx(1.0, abs=0.01)


def test_a_free_body_that_turns_keeps_turning() -> None:
    """Angular momentum to 1e-3 over half a turn, and no plastic strain."""
    rate = 2e5
    problem = moving(
        block((1.0, 0.5), end=np.pi / rate),
        lambda x: rate * np.column_stack([-(x[:, 1] - 0.25), x[:, 0] - 0.5]),
    )
    method = ParticleMethod.start(TotalLagrangian(problem))

    def turning() -> float:
        x, v = method.current.positions, method.current.velocities
        return float(problem.mass @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))

    start = turning()
    while not method.finished:
        method.advance()
    assert turning() == pytest.approx(start, rel=1e-3)
    assert method.measure().max_eqps == 0.0
    assert abs(method.measure().energy_error) < 1e-3
    # Half a turn: the corners have changed sides.
    corner = np.argmin(problem.points.sum(axis=1))
    assert method.current.positions[corner] == pytest.approx([1.0 - 0.05, 0.5 - 0.05], abs=0.02)


def test_mass_scaling_makes_steps_longer_and_no_heat() -> None:
    once, scaled = block(), block(mass_scaling=100.0)
    assert scaled.sound_speed == pytest.approx(once.sound_speed / 10.0)
    assert (scaled.mass == 100.0 * once.mass).all()
    from pfemcut.particles.integrate import heat_capacity, stable_step

    temperature = np.full(len(once.points), 300.0)
    assert np.allclose(heat_capacity(once, temperature), heat_capacity(scaled, temperature))
    assert stable_step(scaled, scaled.velocities) == pytest.approx(10.0 * stable_step(once, once.velocities))


def test_held_particles_stay_and_rigid_bodies_go_on() -> None:
    hold = [{"box": [[0.0, 0.0], [0.1, 1.0]]}]
    problem = moving(block(hold=hold), lambda x: np.where(x[:, :1] < 0.1, 0.0, [5e3, 0.0]))
    method = ParticleMethod.start(TotalLagrangian(problem))
    while not method.finished:
        method.advance()
    held = problem.points[:, 0] < 0.1
    assert (method.current.positions[held] == problem.points[held]).all()
    assert method.own_measures()["momentum_error"] < 1e-12
    (body,) = block().bodies
    rigid = replace(body, velocity=np.array([1e3, 0.0]), held=np.ones_like(body.held))
    method = ParticleMethod.start(TotalLagrangian(replace(block(), bodies=(rigid,))))
    while not method.finished:
        method.advance()
    assert np.allclose(method.current.positions - body.points, [1e3 * 1e-6, 0.0])


def test_a_particle_inside_out_stops_the_run() -> None:
    problem = moving(block(reference_update=0.0), lambda x: np.column_stack([-6e6 * x[:, 0], 0.0 * x[:, 0]]))
    method = ParticleMethod.start(TotalLagrangian(replace(problem, time=replace(problem.time, courant=1.0))))
    with pytest.raises(RunStopped, match=r"inside out|finite"):
        while not method.finished:
            method.advance()


def test_one_word_changes_the_method() -> None:
    problem = particles_of({**CUT, "method": "tlsph"})
    assert len(problem.points) == 200
    case, material = validated({**CUT, "method": "tlsph"}, Path())
    assert dict(figures(case, material, Path()))["method"] == "tlsph"
    assert warnings(case, material) == []
    case, material = validated({**CUT, "method": "tlsph", "mesh": {"chip_size": 0.02}}, Path())
    assert warnings(case, material) == ["method = 'tlsph' makes no use of [mesh]"]
    part = particles_of(
        changed({**CUT, "method": "tlsph"}, "particles", filled_length=0.2, filled_height=0.16)
    )
    assert part.points.min(axis=0) == pytest.approx([0.21, 0.05])


@pytest.mark.parametrize(
    ("section", "values", "words"),
    [
        ("tool", {"conduction": {"conductivity": 50.0, "capacity": 5e8, "density": 7.8e-9}}, "conduction"),
        ("particles", {"spacing": -1.0}, "spacing"),
    ],
)
def test_what_particles_can_not_do_is_said(section: str, values: dict[str, Any], words: str) -> None:
    with pytest.raises(CaseError, match=words):
        particles_of(changed({**CUT, "method": "tlsph"}, section, **values))


def test_kernel_contact_is_for_the_eulerian_method() -> None:
    particles = {**PRESSING["particles"], "contact": "kernel"}
    with pytest.raises(CaseError, match=r"contact: given 'kernel'.*pinballs only"):
        particles_of({**PRESSING, "particles": particles})
    assert particles_of({**PRESSING, "particles": particles, "method": "esph"}).smoothing.kernel_contact
    assert not particles_of(PRESSING).smoothing.kernel_contact


def test_particles_that_meet_do_not_blow_up() -> None:
    """Springs of a pair at a hundredth of the spacing keep to the time step: energy to 2 %, as without such a pair."""
    one = block((1.0, 1.0), material=ELASTIC, end=1e-6, reference_update=0.0)
    (body,) = one.bodies
    points = body.points.copy()
    points[45] = points[44] + [0.001, 0.0]
    problem = replace(one, bodies=(replace(body, points=points),))
    random = np.random.default_rng(4)
    problem = moving(problem, lambda at: 1e4 * random.normal(size=at.shape))
    method = ParticleMethod.start(TotalLagrangian(problem))
    while not method.finished:
        method.advance()
    assert np.abs(method.current.velocities).max() < 1e5
    assert abs(method.measure().energy_error) < 0.02


def test_solids_must_agree_on_their_dimension() -> None:
    table = copy.deepcopy(TAYLOR)
    table["wall"] = [{"point": [0.0, 0.0], "normal": [0.0, 1.0]}]
    with pytest.raises(CaseError, match="2 components, must be 3"):
        particles_of(table)


def test_bodies_bounce_off_each_other() -> None:
    """Two equal elastic blocks that meet at 80 m/s part again; momentum to 1e-12, energy to 1 %."""
    one = block((0.5, 0.5), material=ELASTIC, alpha=0.0, beta=0.0)
    (body,) = one.bodies
    left = replace(body, velocity=np.array([4e4, 0.0]))
    right = replace(body, points=body.points + [0.51, 0.02], velocity=np.array([-4e4, 0.0]))
    problem = replace(one, bodies=(left, right), time=replace(one.time, end=1.5e-6))
    method = ParticleMethod.start(TotalLagrangian(problem))
    gaps, mean = impact(method, problem)
    assert min(gaps) > 0.03
    assert mean[0] < -1e4
    assert mean[1] == pytest.approx(-mean[0], rel=1e-9)
    measures = method.own_measures()
    assert measures["momentum_error"] < 1e-12
    assert abs(method.measure().energy_error) < 0.01


def test_a_rigid_body_presses_another() -> None:
    """Work of the rigid body is what the other takes, to 2 %; and it is pushed along."""
    method = ParticleMethod.start(TotalLagrangian(particles_of(PRESSING)))
    while not method.finished:
        method.advance()
    measures, own = method.measure(), method.own_measures()
    assert own["hold_work"] > 0.0
    assert abs(measures.energy_error) < 0.02
    assert own["momentum_error"] < 1e-12
    block_x = method.current.positions[:60, 0]
    assert block_x.max() < method.current.positions[60:, 0].min()
    assert measures.max_eqps > 0.1


def test_a_hold_without_particles_is_a_mistake() -> None:
    with pytest.raises(CaseError, match="no particle"):
        block(hold=[{"box": [[0.0, 0.0], [0.04, 1.0]]}])
