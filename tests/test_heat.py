"""Heat conduction with lumped capacity: exact solution, maximum principle, and what the heat ledger books."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from problems import (
    REFERENCE_TEMPERATURE,
    Array,
    advanced,
    block_problem,
    cut_problem,
    fixed_x,
    fixed_y,
    heated,
    hot,
    rectangle_mesh,
    start_on,
    steel,
    with_fields,
)
from scipy.special import erfc

from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem

RIGID = steel(expansion=0.0)
"""Conducts, but does not expand."""
CONDUCTIVITY = 45.0  # N/(s K)
CAPACITY = 7.8e-9 * 0.46e9  # mJ/(mm³ K)
DIFFUSIVITY = CONDUCTIVITY / CAPACITY
SUPPORTS = (fixed_x("left"), fixed_y("bottom"))
FLUX = 1e4  # mW/mm²


def half_space(x: Array, time: float, flux: float) -> Array:
    """Temperature rise at depth ``x`` under a constant flux (Carslaw and Jaeger, 2.9)."""
    reach = np.sqrt(4.0 * DIFFUSIVITY * time)
    gauss = reach / np.sqrt(np.pi) * np.exp(-((x / reach) ** 2))
    return flux / CONDUCTIVITY * (gauss - x * erfc(x / reach))


def flux_error(size: float, steps: int, remesh: bool) -> float:
    """Largest error of the rise after 2 ms of flux into the left side of a strip, over the rise there."""
    end = 2e-3
    problem = block_problem(
        height=0.3,
        size=size,
        material=RIGID,
        motions=SUPPORTS,
        fluxes=(heated("left", FLUX),),
        step=end / steps,
        steps=steps,
        remesh=remesh,
    )
    method = advanced(problem, steps)
    mesh, fields = method.current.mesh, method.current.fields
    exact = half_space(mesh.points[:, 0], end, FLUX)
    return float(np.abs(fields.temperature - REFERENCE_TEMPERATURE - exact).max() / exact.max())


def test_constant_flux_heats_like_the_half_space() -> None:
    """Error below 4 % with h = 0.1 mm (a third of the heat's reach), falling like h² with h and dt like h²."""
    errors = [flux_error(0.1, 10, False), flux_error(0.05, 40, False), flux_error(0.025, 160, False)]
    assert errors[0] < 0.04
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]


def test_remeshing_keeps_the_half_space() -> None:
    """The same strip with the particle step on: 1 %."""
    assert flux_error(0.05, 40, True) < 0.01


def test_flux_is_booked_as_supplied_heat() -> None:
    """Content and supply are flux times area times time, to 1e-9."""
    problem = block_problem(
        material=RIGID,
        motions=SUPPORTS,
        fluxes=(heated("left", FLUX), heated("top", -0.5 * FLUX)),
        remesh=False,
    )
    own = advanced(problem, 10).own_measures()
    wanted = 0.5 * FLUX * 10 * 1e-5
    assert own["heat_supplied"] == pytest.approx(wanted, rel=1e-12)
    assert own["heat_content"] == pytest.approx(wanted, rel=1e-9)
    assert own["heat_generated"] == 0.0


@pytest.mark.parametrize("fourier", [1e-4, 1e-2, 1.0, 100.0])
def test_temperature_step_keeps_the_maximum_principle(fourier: float) -> None:
    """No particle beyond the two temperatures (1e-8 K, the solver), and none cools, on an irregular mesh."""
    size, warm = 0.15, REFERENCE_TEMPERATURE + 500.0
    problem = block_problem(
        material=RIGID,
        motions=SUPPORTS,
        temperatures=(hot("left", warm),),
        remesh=False,
        step=fourier * size**2 / DIFFUSIVITY,
    )
    method = start_on(problem, rectangle_mesh(size=size, jitter=0.2))
    before = method.current.fields.temperature
    for _ in range(8):
        method.advance()
        after = method.current.fields.temperature
        assert after.min() > REFERENCE_TEMPERATURE - 1e-8
        assert after.max() < warm + 1e-8
        assert (after - before).min() > -1e-8
        before = after


def test_prescribed_temperature_is_booked_as_supplied_heat() -> None:
    """Content and supply agree to 1e-9."""
    problem = block_problem(
        material=RIGID, motions=SUPPORTS, temperatures=(hot("left", 500.0),), remesh=False
    )
    own = advanced(problem, 10).own_measures()
    assert own["heat_content"] > 0.0
    assert own["heat_supplied"] == pytest.approx(own["heat_content"], rel=1e-9)


@pytest.mark.parametrize("remesh", [False, True])
def test_insulated_body_keeps_its_heat(remesh: bool) -> None:
    """Ten steps of equalising a hot spot: to 1e-9, what remeshing changes being booked."""
    problem = block_problem(material=RIGID, motions=SUPPORTS, remesh=remesh, step=1e-3)
    method = PfemMethod.start(problem)
    x, y = method.current.mesh.points.T
    spot = REFERENCE_TEMPERATURE + 400.0 * np.exp(-((x - 0.3) ** 2 + (y - 0.4) ** 2) / 0.02)
    method = with_fields(problem, method, temperature=spot, momentum_temperature=spot)
    before = method.own_measures()["heat_content"]
    # Ask for a finer mesh, so that the particle step inserts.
    finer = replace(problem, particles=block_problem(size=0.1, remesh=remesh).particles)
    method = with_fields(finer, method)
    for _ in range(10):
        method.advance()
    own = method.own_measures()
    assert method.current.ledger.inserted > 20 or not remesh
    assert np.ptp(method.current.fields.temperature) < 0.5 * np.ptp(spot)
    assert own["heat_content"] - own["heat_remeshing"] == pytest.approx(before, rel=1e-9)
    assert abs(own["heat_remeshing"]) < 1e-9 * before
    assert own["heat_generated"] == own["heat_supplied"] == 0.0


def rubbed(heat_partition: float) -> Problem:
    """A cut with friction."""
    return cut_problem(contact={"friction": 0.3, "heat_partition": heat_partition})


@pytest.mark.parametrize("heat_partition", [0.0, 0.5, 1.0])
def test_friction_heat_partition_is_booked(heat_partition: float) -> None:
    """Generated heat is chi times plastic work and the body's part of friction (1e-10), and it is there (1 %)."""
    method = advanced(rubbed(heat_partition), 15)
    measured, own = method.measure(), method.own_measures()
    chi = rubbed(0.0).body.material.taylor_quinney
    assert measured.friction_work > 0.01 * measured.plastic_work
    wanted = chi * measured.plastic_work + heat_partition * measured.friction_work
    assert own["heat_generated"] == pytest.approx(wanted, rel=1e-10)
    assert own["heat_supplied"] == 0.0
    assert abs(own["heat_error"]) < 0.01


def test_friction_heats_the_particles_that_slide() -> None:
    """One step: the whole of the friction heat more raises the content by it, at the particles in contact (1 %)."""
    without = advanced(rubbed(0.0), 1)
    everything = advanced(rubbed(1.0), 1)
    friction = everything.measure().friction_work
    assert without.measure().friction_work == friction
    gained = everything.own_measures()["heat_content"] - without.own_measures()["heat_content"]
    assert gained == pytest.approx(friction, rel=0.01)
    warmer = everything.current.fields.temperature - without.current.fields.temperature
    assert int(np.argmax(warmer)) in everything.frame().contact.particles
