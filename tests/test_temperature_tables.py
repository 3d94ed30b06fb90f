"""Properties that depend on temperature, in heat conduction and in thermal expansion."""

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
    heated,
    hot,
    moving,
    steel,
    voce,
    with_fields,
)
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from meshing.mesh import signed_areas
from pfemcut.materials.enthalpy import specific_enthalpy, temperature_at
from pfemcut.materials.load import load_material
from pfemcut.materials.material import Material, Property
from pfemcut.materials.volumetric import dilation
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Axis, Problem

SUPPORTS = (fixed_x("left"), fixed_y("bottom"))
STEEL = load_material("42cd4", None)
COLD = REFERENCE_TEMPERATURE
STEEP = replace(
    STEEL,
    expansion=Property((0.0,), (0.0,)),
    capacity=Property((COLD, COLD + 600.0), (0.4e9, 1.0e9)),
    conductivity=Property((COLD, COLD + 600.0), (50.0, 15.0)),
)
"""Does not expand; specific heat and conductivity change more than those of any metal."""
FLUX = 6e4  # mW/mm²
END = 4e-3  # s


def heated_strip(material: Material, steps: int, size: float = 0.1, remesh: bool = False) -> Problem:
    """A strip with a flux into its left side."""
    return block_problem(
        height=0.3,
        size=size,
        material=material,
        motions=SUPPORTS,
        fluxes=(heated("left", FLUX),),
        step=END / steps,
        steps=steps,
        remesh=remesh,
    )


@pytest.mark.parametrize("steps", [4, 16])
def test_heat_ledger_closes_whatever_the_step(steps: int) -> None:
    """Content, the integral of c dtheta, is the supplied heat to 1e-9, though some 40 K a step change c by 10 %."""
    method = advanced(heated_strip(STEEP, steps), steps)
    own = method.own_measures()
    assert method.current.fields.temperature.max() > COLD + 150.0
    assert own["heat_supplied"] == pytest.approx(FLUX * 0.3 * END, rel=1e-12)
    assert abs(own["heat_error"]) < 1e-9


def test_prescribed_temperature_is_booked_with_the_integral_of_the_specific_heat() -> None:
    """To 1e-9; the sides jump by 500 K in the first step."""
    problem = block_problem(
        material=STEEP, motions=SUPPORTS, temperatures=(hot("left", 793.15),), remesh=False, step=1e-3
    )
    own = advanced(problem, 10).own_measures()
    assert own["heat_content"] > 0.0
    assert abs(own["heat_error"]) < 1e-9


@pytest.mark.parametrize("fourier", [1e-2, 1.0, 100.0])
def test_tables_keep_the_maximum_principle(fourier: float) -> None:
    """No particle beyond the two temperatures by more than the 0.01 K to which the secant is found, however long."""
    warm = COLD + 500.0
    problem = block_problem(
        material=STEEP,
        motions=SUPPORTS,
        temperatures=(hot("left", warm),),
        remesh=False,
        step=fourier * 0.15**2 * STEEP.density * 0.4e9 / 50.0,
    )
    method = PfemMethod.start(problem)
    for _ in range(4):
        method.advance()
        theta = method.current.fields.temperature
        assert COLD - 0.01 < theta.min() < theta.max() < warm + 0.01


def test_plastic_heat_is_stored_by_the_table() -> None:
    """42CD4 stretched by 4 %: the heat gained, but for what remeshing changes, is the plastic heat to 1e-9."""
    errors = []
    for remesh in (False, True):
        problem = block_problem(
            material=replace(STEEL, hardening=voce(800.0, linear=1500.0)),
            motions=(*SUPPORTS, moving("top", Axis.Y, 100.0 / 1.5)),
            remesh=remesh,
            steps=150,
            size=0.25,
        )
        method = PfemMethod.start(problem)
        # From where the specific heat rises.
        warm = np.full(len(method.current.mesh.points), 600.0)
        method = with_fields(problem, method, temperature=warm, momentum_temperature=warm)
        before = method.own_measures()["heat_content"]
        for _ in range(60):
            method.advance()
        own = method.own_measures()
        assert own["heat_generated"] > 1.0
        gained = own["heat_content"] - before - own["heat_remeshing"]
        errors.append(gained / own["heat_generated"] - 1.0)
    assert np.abs(errors).max() < 1e-9


def reference(material: Material, length: float, count: int = 400) -> tuple[Array, Array]:
    """Temperature of the strip by finite volumes in one dimension and a stiff solver: places (mm), kelvin."""
    width = length / count
    places = (np.arange(count) + 0.5) * width

    def rate(_: float, theta: Array) -> Array:
        conductivity = material.conductivity(0.5 * (theta[1:] + theta[:-1]))
        flow = np.concatenate([[FLUX], -conductivity * np.diff(theta) / width, [0.0]])
        return -np.diff(flow) / width / (material.density * material.capacity(theta))

    found = solve_ivp(rate, (0.0, END), np.full(count, COLD), "BDF", rtol=1e-8, atol=1e-6)
    return places, found.y[:, -1]


def test_conduction_with_tables_follows_an_independent_solution() -> None:
    """Largest error below 1 % of the largest rise, halved with half the step and size; 10 % with constants."""
    places, exact = reference(STEEP, 1.0)

    def error(material: Material, size: float, steps: int) -> float:
        method = advanced(heated_strip(material, steps, size), steps)
        found, x = method.current.fields.temperature, method.current.mesh.points[:, 0]
        wanted = np.interp(x, places, exact)
        inside = x > places[0]
        return float(np.abs(found - wanted)[inside].max() / (exact.max() - COLD))

    fine, coarse = error(STEEP, 0.05, 80), error(STEEP, 0.1, 40)
    assert fine < 0.01
    assert fine < 0.6 * coarse
    cold = replace(STEEP, capacity=Property((COLD,), (0.4e9,)), conductivity=Property((COLD,), (50.0,)))
    assert error(cold, 0.05, 80) > 10.0 * fine


def test_enthalpy_and_its_inverse() -> None:
    """The integral against quadrature to 1e-9, and back to 1e-9 K, within and beyond the table."""
    capacity = STEEL.capacity
    for theta in (200.0, 293.15, 500.0, 700.0, 1400.0):
        fine = np.linspace(293.15, theta, 200001)
        middle = 0.5 * (fine[1:] + fine[:-1])
        wanted = float(np.sum(capacity(middle) * np.diff(fine)))
        found = specific_enthalpy(capacity, np.array([theta]), 293.15)
        assert found[0] == pytest.approx(wanted, rel=1e-9)
        assert temperature_at(capacity, found, 293.15, np.array([450.0]))[0] == pytest.approx(theta, abs=1e-9)


def free_stretch(material: Material, theta: float) -> float:
    """In-plane stretch of a free body in plane strain at the temperature ``theta`` (K)."""
    mu, kappa = material.shear_modulus, material.bulk_modulus
    secant = float(material.expansion(np.array(theta)))
    strain = 3.0 * secant * (theta - material.reference_temperature)

    def in_plane_stress(stretch: float) -> float:
        j = stretch**2
        deviator = mu * j ** (-2.0 / 3.0) * (stretch**2 - 1.0) / 3.0
        return float(deviator / j + kappa * dilation(np.array(j), np.array(strain)))

    return float(brentq(in_plane_stress, 1.0, 1.05, xtol=1e-15))


@pytest.mark.parametrize("remesh", [False, True])
@pytest.mark.parametrize(("theta", "secant"), [(483.15, 0.5 * 1.45e-5), (873.15, 1.45e-5)])
def test_free_block_expands_by_the_secant_value_from_the_reference_temperature(
    remesh: bool, theta: float, secant: float
) -> None:
    """42CD4 within the table and beyond it: area by the exact law to 3e-5 (0.01 K), near 2 (1 + nu) alpha dtheta."""
    material = replace(STEEL, hardening=steel().hardening)

    def heated_to(now: float, size: float) -> Problem:
        sides = tuple(hot(side, now) for side in SIDES)
        return block_problem(
            material=material,
            motions=SUPPORTS,
            temperatures=sides,
            remesh=remesh,
            size=size,
            step=1e8,
            steps=11,
        )

    method = PfemMethod.start(heated_to(COLD, 0.2))
    for step in range(1, 12):
        now = COLD + min(step / 10.0, 1.0) * (theta - COLD)
        method = with_fields(heated_to(now, 0.12 if step % 2 else 0.2), method)
        method.advance()
    mesh = method.current.mesh
    growth = float(signed_areas(mesh.points, mesh.cells).sum()) - 1.0
    assert growth == pytest.approx(free_stretch(material, theta) ** 2 - 1.0, rel=3e-5)
    assert growth == pytest.approx(2.0 * 1.3 * secant * (theta - COLD), rel=0.05)
