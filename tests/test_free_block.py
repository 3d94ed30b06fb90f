"""Blocks without a tool: free thermal expansion under remeshing, closing ledgers, and inertia."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from problems import (
    REFERENCE_TEMPERATURE,
    SIDES,
    Array,
    advanced,
    block_problem,
    fixed_x,
    fixed_y,
    hot,
    moving,
    steel,
    voce,
    with_fields,
)
from scipy.optimize import brentq

from meshing.mesh import signed_areas
from pfemcut.materials.volumetric import dilation
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Axis, Integrator, PrescribedMotion, Problem

ROLLERS = (fixed_x("left"), fixed_y("bottom"))
EXPANSION = 1e-5


def free_stretch(rise: float) -> float:
    """In-plane stretch of a free body in plane strain, heated by ``rise``: in-plane stress zero, out of plane not."""
    material = steel()
    mu, kappa = material.shear_modulus, material.bulk_modulus

    def in_plane_stress(stretch: float) -> float:
        j = stretch**2
        deviator = mu * j ** (-2.0 / 3.0) * (stretch**2 - 1.0) / 3.0
        return float(deviator / j + kappa * dilation(np.array(j), np.array(3.0 * EXPANSION * rise)))

    return float(brentq(in_plane_stress, 1.0, 1.05, xtol=1e-15))


@pytest.mark.parametrize("remesh", [False, True])
def test_free_heated_block_expands_by_the_exact_law(remesh: bool) -> None:
    """300 K in ten steps, remeshed between two spacings every step.

    Area by the nonlinear law (0.771 %) to 1e-7, within 1.5 % of the linear 2 (1 + nu) alpha dtheta = 0.78 %;
    in-plane stress below 1e-6 of Young's modulus times alpha dtheta.
    """

    def heated_to(rise: float, size: float) -> Problem:
        # So long a step that the heat of the sides reaches everywhere.
        sides = tuple(hot(side, REFERENCE_TEMPERATURE + rise) for side in SIDES)
        return block_problem(
            motions=ROLLERS, temperatures=sides, remesh=remesh, size=size, step=1e8, steps=11
        )

    method = PfemMethod.start(heated_to(0.0, 0.2))
    # The heat equation follows the momentum equation, which in the last step finds what it left in the one before.
    for step in range(1, 12):
        method = with_fields(heated_to(min(30.0 * step, 300.0), 0.12 if step % 2 else 0.2), method)
        method.advance()
    ledger = method.current.ledger
    assert not remesh or min(ledger.inserted, ledger.removed) > 20
    mesh = method.current.mesh
    growth = float(signed_areas(mesh.points, mesh.cells).sum()) - 1.0
    exact = free_stretch(300.0) ** 2 - 1.0
    assert growth == pytest.approx(exact, rel=1e-7)
    assert exact == pytest.approx(2.0 * 1.3 * EXPANSION * 300.0, rel=0.015)
    stress = method.frame().cell_fields["cauchy_stress"]
    scale = 206.9e3 * EXPANSION * 300.0
    assert np.abs(stress[:, [0, 1, 3]]).max() < 1e-6 * scale
    # Held out of plane: close to -E alpha dtheta there.
    assert stress[:, 2] == pytest.approx(np.full(len(stress), -scale), rel=0.03)
    assert np.ptp(stress[:, 2]) < 1e-6 * scale
    assert abs(method.own_measures()["mass_drift"]) < 1e-7


STICKING = (fixed_x("bottom"), fixed_y("bottom"), fixed_x("top"))


def pulled(remesh: bool, integrator: Integrator, supports: tuple[PrescribedMotion, ...]) -> Problem:
    """A block of 10 % plastic stretch in 150 steps, softening as it heats."""
    return block_problem(
        material=steel(voce(800.0, linear=1500.0, softening=5e-4)),
        motions=(*supports, moving("top", Axis.Y, 100.0 / 1.5)),
        remesh=remesh,
        integrator=integrator,
        steps=150,
        size=0.25,
    )


@pytest.mark.parametrize("integrator", list(Integrator))
@pytest.mark.parametrize("remesh", [False, True])
def test_ledgers_of_a_plastic_block_close(remesh: bool, integrator: Integrator) -> None:
    """Uniform tension: energy and heat, each within 0.5 %, the sinks all being there."""
    method = advanced(pulled(remesh, integrator, ROLLERS), 150)
    measured, own = method.measure(), method.own_measures()
    assert method.finished
    assert measured.max_eqps > 0.1
    assert measured.max_temperature > 303.0
    assert measured.plastic_work > 0.5 * own["boundary_work"] > 0.0
    assert abs(measured.energy_error) < 0.005
    assert abs(own["heat_error"]) < 0.005
    assert own["heat_generated"] == pytest.approx(0.9 * measured.plastic_work, rel=1e-12)


@pytest.mark.parametrize("remesh", [False, True])
def test_energy_of_a_block_between_sticking_plates_closes(remesh: bool) -> None:
    """Tension with pressure gradients on a coarse mesh: energy within 1.2 %, and within 0.5 % but for what the
    stabilisation took.
    """
    method = advanced(pulled(remesh, Integrator.IMPLICIT, STICKING), 150)
    error, own = method.measure().energy_error, method.own_measures()
    assert abs(error) < 0.012
    assert abs(error - own["stabilisation_work"] / own["boundary_work"]) < 0.005


@pytest.mark.parametrize("remesh", [False, True])
def test_heat_of_a_block_between_sticking_plates_closes(remesh: bool) -> None:
    """Heat within 0.5 %, particles being inserted where it deforms most."""
    method = advanced(pulled(remesh, Integrator.IMPL_EX, STICKING), 150)
    assert (method.current.ledger.inserted > 0) == remesh
    assert abs(method.own_measures()["heat_error"]) < 0.005


def test_held_elastic_block_keeps_its_stress() -> None:
    """Squeezed by 1 % between sticking plates in ten steps, then held for 30: pressures as they were, to 1 %."""
    squeeze = block_problem(motions=(*STICKING, moving("top", Axis.Y, -100.0)), size=0.2, steps=100)
    method = advanced(squeeze, 10)
    before = method.current.fields.pressure
    method = PfemMethod.restore(replace(squeeze, motions=(*STICKING, fixed_y("top"))), method.state())
    for _ in range(30):
        method.advance()
    change = method.current.fields.pressure - before
    assert np.abs(change).max() < 0.01 * np.ptp(before)


def test_elastic_stretch_stores_its_work() -> None:
    """The work of a linear force is exact by the trapezoidal rule: 0.2 %, the second order of the strain."""
    for steps in (10, 20):
        problem = block_problem(
            motions=(*ROLLERS, moving("top", Axis.Y, 1e-3 / (steps * 1e-5))), steps=steps, remesh=False
        )
        method = advanced(problem, steps)
        assert method.measure().plastic_work == 0.0
        assert method.own_measures()["boundary_work"] > 0.0
        assert abs(method.measure().energy_error) < 2e-3


def thrown(
    velocity: Array, remesh: bool = True, steps: int = 10, step: float = 1e-6
) -> tuple[Problem, PfemMethod]:
    """A block without supports, with inertia, its particles at ``velocity`` (n, 2) or (2,)."""
    problem = block_problem(inertia=True, remesh=remesh, steps=steps, step=step)
    method = PfemMethod.start(problem)
    displacement = np.broadcast_to(velocity, method.current.mesh.points.shape) * step
    return problem, with_fields(problem, method, last_displacement=displacement)


@pytest.mark.parametrize("remesh", [False, True])
def test_thrown_block_keeps_its_velocity(remesh: bool) -> None:
    """Ten steps of free flight: velocity to 1e-8, kinetic energy m v²/2 to 1e-8, and no stress."""
    velocity = np.array([2e4, -1e4])
    _, method = thrown(velocity, remesh)
    start = method.current.mesh.points.mean(axis=0)
    for _ in range(10):
        method.advance()
    fields, clock = method.current.fields, method.current.clock
    assert method.own_measures()["step_cuts"] == 0
    assert np.abs(fields.last_displacement / clock.last_dt - velocity).max() < 1e-8 * 2e4
    assert method.measure().kinetic_energy == pytest.approx(0.5 * 7.8e-9 * velocity @ velocity, rel=1e-8)
    if not remesh:
        assert method.current.mesh.points.mean(axis=0) - start == pytest.approx(velocity * 1e-5, rel=1e-8)
    assert method.frame().cell_fields["von_mises"].max() < 1e-3


def test_momentum_is_conserved_and_energy_does_not_grow() -> None:
    """A free block shaken inside: mass-weighted mean velocity to 1e-5, and backward Euler only loses energy.

    The mass of a particle follows J, which the weak pressure equation gives, so momentum is not exact.
    """
    problem = block_problem(inertia=True)
    x, y = PfemMethod.start(problem).current.mesh.points.T
    shake = np.column_stack([1e4 + 3e4 * np.sin(3.0 * y), 2e4 * np.cos(2.0 * x)])
    _, method = thrown(shake, remesh=False, step=2e-8, steps=40)
    mesh = method.current.mesh
    weight = np.bincount(mesh.cells.ravel(), np.repeat(signed_areas(mesh.points, mesh.cells), 3))
    mean = weight @ shake / weight.sum()
    energies, elastic = [method.measure().kinetic_energy], []
    for _ in range(40):
        method.advance()
        measured = method.measure()
        elastic.append(measured.elastic_energy)
        energies.append(measured.kinetic_energy + measured.elastic_energy)
    velocity = method.current.fields.last_displacement / method.current.clock.last_dt
    assert weight @ velocity / weight.sum() == pytest.approx(mean, rel=1e-5)
    assert max(np.diff(energies)) < 0.0
    assert max(elastic) > 0.01 * energies[0]
    assert energies[-1] > 0.5 * energies[0]
