"""Every material of the library: its constants, its sources, and its integration at one point."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import BaseModel

from pfemcut.materials.describe import source_of
from pfemcut.materials.hardening.elastic import Elastic
from pfemcut.materials.load import VALUES, library_names, load_material
from pfemcut.materials.material import FlowStress, HardeningLaw, Material
from pfemcut.materials.return_mapping import (
    elastic_strain,
    elastic_trial,
    implicit_multiplier,
    returned_deviator,
    tensor_norm,
)

Array = NDArray[np.float64]

MATERIALS = {name: load_material(name, None) for name in library_names()}
METALS = {name: each for name, each in MATERIALS.items() if not isinstance(each.hardening, Elastic)}
ROOT_2_3 = math.sqrt(2.0 / 3.0)

# A second entry of the constants, against slips of the pen: A, B, n, C, m, melting temperature (K), reference rate
# (1/s), reference temperature (K).
JOHNSON_COOK = {
    "42cd4": (598.0, 768.0, 0.2092, 0.0137, 0.807, 1793.0, 1.0, 293.15),
    "aisi1045_jaspers": (553.1, 600.8, 0.234, 0.0134, 1.0, 1733.0, 1.0, 293.15),
    "aisi1045_klocke": (546.0, 487.0, 0.25, 0.027, 0.631, 1733.0, 1.0, 293.15),
    "aisi316l_chandrasekaran": (305.0, 1161.0, 0.61, 0.01, 0.517, 1673.0, 1.0, 293.15),
    "aisi316l_tounsi": (514.0, 514.0, 0.508, 0.042, 0.533, 1673.0, 1e-3, 293.15),
    "aisi4340": (792.0, 510.0, 0.26, 0.014, 1.03, 1793.0, 1.0, 293.15),
    "al2024t351_johnson_cook": (265.0, 426.0, 0.34, 0.015, 1.0, 775.0, 1.0, 293.15),
    "inconel718_sievert": (1241.0, 622.0, 0.6522, 0.0134, 1.3, 1573.0, 1.0, 293.15),
    "ofhc_copper_johnson_cook": (90.0, 292.0, 0.31, 0.025, 1.09, 1356.0, 1.0, 293.15),
    "ti6al4v_ducobu": (997.9, 653.1, 0.45, 0.0198, 0.7, 1873.0, 1.0, 293.0),
    "ti6al4v_lee_lin": (782.7, 498.4, 0.28, 0.028, 1.0, 1878.0, 1e-5, 293.15),
    "ti6al4v_meyer": (862.5, 331.2, 0.34, 0.012, 0.8, 1878.0, 1.0, 293.15),
}

# (A + B) (1 + C ln(1e5 / reference rate)) (1 - 0.5^m) in MPa, in decimal arithmetic from the constants as published.
BY_HAND = {
    "42cd4": 677.5442,
    "aisi1045_jaspers": 665.9579,
    "aisi1045_klocke": 479.7213,
    "aisi316l_chandrasekaran": 492.3572,
    "aisi316l_tounsi": 563.1977,
    "aisi4340": 771.4856,
    "al2024t351_johnson_cook": 405.1657,
    "inconel718_sievert": 1277.073,
    "ofhc_copper_johnson_cook": 260.8501,
    "ti6al4v_ducobu": 779.3717,
    "ti6al4v_lee_lin": 1053.528,
    "ti6al4v_meyer": 578.2959,
}


def grid(*axes: Array) -> tuple[Array, ...]:
    """All combinations of the values of the axes, flat."""
    return tuple(each.ravel() for each in np.meshgrid(*axes, indexing="ij"))


def strains_rates_temperatures(material: Material) -> tuple[Array, Array, Array]:
    """Strains to 5, rates to 1e7 /s and temperatures beyond melting, none of them on a kink of a law."""
    return grid(
        np.array([0.0, 1e-10, 1e-6, 1e-3, 0.05, 0.3, 1.0, 2.0, 5.0]),
        np.array([0.0, 2e-6, 0.2, 10.0, 1e3, 1e5, 1e7]),
        np.array([250.0, 300.0, 500.0, 700.0, 900.0, 1200.0, 1500.0, 1700.0, 2000.0]),
    )


def slope(law: HardeningLaw, at: tuple[Array, Array, Array], axis: int) -> tuple[Array, Array]:
    """Central difference of the flow stress along an axis, and its round-off."""
    small = np.maximum(1e-5 * at[axis], 1e-12)
    low, high = list(at), list(at)
    low[axis], high[axis] = at[axis] - small, at[axis] + small
    up, down = law.flow_stress(*high).value, law.flow_stress(*low).value
    return (up - down) / (2.0 * small), 2e-15 * up / small


@pytest.mark.parametrize("name", sorted(JOHNSON_COOK))
def test_johnson_cook_flow_stress_is_that_of_the_published_constants(name: str) -> None:
    a, b, n, c, m, melting, reference_rate, reference = JOHNSON_COOK[name]
    strain, rate, theta = 0.35, 2.5e4, 600.0
    expected = (a + b * strain**n) * (1.0 + c * math.log(rate / reference_rate))
    expected *= 1.0 - ((theta - reference) / (melting - reference)) ** m
    law = MATERIALS[name].hardening
    found = law.flow_stress(np.array([strain]), np.array([rate]), np.array([theta])).value[0]
    assert found == pytest.approx(expected, rel=1e-12)


def test_all_johnson_cook_materials_are_checked() -> None:
    johnson_cook = {name for name, each in METALS.items() if type(each.hardening).__name__ == "JohnsonCook"}
    assert johnson_cook == set(JOHNSON_COOK)


@pytest.mark.parametrize("name", sorted(JOHNSON_COOK))
def test_johnson_cook_flow_stress_is_that_worked_out_by_hand(name: str) -> None:
    """At a strain of 1, 1e5 /s and half-way to melting, where only a logarithm and one power remain; 6 digits."""
    _, _, _, _, _, melting, _, reference = JOHNSON_COOK[name]
    at = (np.array([1.0]), np.array([1e5]), np.array([0.5 * (reference + melting)]))
    assert MATERIALS[name].hardening.flow_stress(*at).value[0] == pytest.approx(BY_HAND[name], rel=2e-6)


def test_carbides_of_the_published_cuts_are_tools_to_take() -> None:
    """As given for the cut of Ti6Al4V, in SI units: GPa, -, kg/m3, 1e-6 /K, J/(kg K), W/(m K)."""
    tool = MATERIALS["wc_co_ducobu"]
    room = np.array([293.0])
    given = (650.0, 0.2, 14850.0, 5.0, 202.0, 100.0)
    assert (
        tool.young_modulus / 1e3,
        tool.poisson_ratio,
        tool.density * 1e12,
        tool.expansion(room)[0] * 1e6,
        tool.capacity(room)[0] / 1e6,
        tool.conductivity(room)[0],
    ) == pytest.approx(given, rel=1e-12)
    assert isinstance(tool.hardening, Elastic)


@pytest.mark.parametrize("name", library_names())
def test_every_value_has_a_source(name: str) -> None:
    material = MATERIALS[name]
    assert material.source
    assert material.checked
    law = material.hardening
    assert isinstance(law, BaseModel)
    keys = [*VALUES, "hardening", *(f"hardening.{key}" for key in type(law).model_fields)]
    assert [key for key in keys if not source_of(material, key)] == []


@pytest.mark.parametrize("name", library_names())
def test_properties_are_those_of_a_metal_at_any_temperature(name: str) -> None:
    """Rough bounds that catch a slip of units: kg and W/(m K) against tonne and N/(s K), degrees against K."""
    material = MATERIALS[name]
    theta = np.linspace(200.0, 2000.0, 50)
    assert 50e3 < material.young_modulus < 700e3
    assert 0.19 < material.poisson_ratio < 0.4
    assert 2e-9 < material.density < 16e-9
    assert 273.0 < material.reference_temperature < 300.0
    for values, low, high in (
        (material.expansion(theta), 0.0, 3e-5),
        (material.capacity(theta), 0.1e9, 1e9),
        (material.conductivity(theta), 5.0, 400.0),
    ):
        assert low <= values.min() <= values.max() < high
    for table in (material.expansion, material.capacity, material.conductivity):
        assert len(table.temperatures) == 1 or table.temperatures[0] > 290.0


@pytest.mark.parametrize("name", sorted(METALS))
def test_flow_stress_is_positive_and_finite_with_its_derivatives(name: str) -> None:
    """Derivatives against central differences to 1e-4, where the flow stress is above its floor."""
    law = METALS[name].hardening
    at = strains_rates_temperatures(METALS[name])
    found: FlowStress = law.flow_stress(*at)
    derivatives = (found.by_eqps, found.by_rate, found.by_temperature)
    for each in (found.value, *derivatives):
        assert np.isfinite(each).all()
    assert (found.value > 0.0).all()
    # Below 1e-6 the power of the strain is replaced by a chord, whose end a difference would straddle.
    smooth = (found.value > 0.02 * found.value.max()) & (at[0] > 1e-7)
    assert smooth.sum() > 100
    for axis, exact in enumerate(derivatives):
        difference, noise = slope(law, at, axis)
        wrong = np.abs(exact - difference) > 1e-4 * np.abs(exact) + 10.0 * noise
        assert not wrong[smooth].any(), [tuple(each[smooth & wrong][:3]) for each in at]


@pytest.mark.parametrize("name", sorted(METALS))
def test_return_mapping_converges_to_the_yield_surface(name: str) -> None:
    """Strain increments of 1e-5 to 0.3 at steps of 1e-9 to 1e-3 s, from cold to beyond melting: stress to 1e-9."""
    material = METALS[name]
    strains = np.array([0.0, 1e-9, 1e-3, 0.2, 1.0, 4.0])
    thetas = np.array([250.0, 293.15, 600.0, 1000.0, 1400.0, 1800.0, 2500.0])
    sizes = np.array([1e-5, 1e-3, 0.01, 0.1, 0.3])
    eqps, theta, size = grid(strains, thetas, sizes)
    gradient = np.tile(np.eye(2), (len(eqps), 1, 1))
    gradient[:, 0, 1] = size
    undeformed = np.tile([1.0, 1.0, 1.0, 0.0], (len(eqps), 1))
    trial = elastic_trial(undeformed, gradient, material.shear_modulus)
    for step in (1e-9, 1e-7, 1e-3):
        multiplier = implicit_multiplier(trial, material.hardening, eqps, theta, step, np.zeros_like(eqps))
        strain = ROOT_2_3 * multiplier.value
        flow = material.hardening.flow_stress(eqps + strain, strain / step, theta).value
        norm = tensor_norm(returned_deviator(trial, multiplier.value))
        plastic = multiplier.value > 0.0
        assert plastic.any()
        np.testing.assert_allclose(norm[plastic], ROOT_2_3 * flow[plastic], rtol=1e-9)
        assert (multiplier.by_norm[plastic] > 0.0).all()
        # The work that softening releases never exceeds what the elastic unloading needs.
        assert (multiplier.by_norm * 2.0 * trial.mu_bar)[plastic].max() < 1.1


def sheared(
    material: Material, rate: float, temperature: Array, steps: int = 120
) -> tuple[Array, Array, Array]:
    """Adiabatic simple shear to 3 (equivalent sqrt 3): equivalent stress (MPa), temperature (K), plastic strain."""
    step = math.sqrt(3.0) / rate / steps
    points = len(temperature)
    gradient = np.tile(np.eye(2), (points, 1, 1))
    gradient[:, 0, 1] = 3.0 / steps
    b_elastic = np.tile([1.0, 1.0, 1.0, 0.0], (points, 1))
    eqps, theta = np.zeros(points), temperature
    for _ in range(steps):
        trial = elastic_trial(b_elastic, gradient, material.shear_modulus)
        multiplier = implicit_multiplier(
            trial, material.hardening, eqps, theta, step, np.zeros_like(eqps)
        ).value
        increment = ROOT_2_3 * multiplier
        eqps = eqps + increment
        flow = material.hardening.flow_stress(eqps, increment / step, theta).value
        deviator = returned_deviator(trial, multiplier)
        b_elastic = elastic_strain(deviator, material.shear_modulus)
        heat = material.taylor_quinney * flow * increment
        theta = theta + heat / (material.density * material.capacity(theta))
    return math.sqrt(1.5) * tensor_norm(deviator), theta, eqps


@pytest.mark.parametrize(("name", "rate"), list(itertools.product(sorted(METALS), (1.0, 1e5))))
def test_adiabatic_shear_at_one_point(name: str, rate: float) -> None:
    """From 293 and 800 K: stress at the flow stress (2 %), strain that of the shear (2 %), warmer and not melted."""
    material = METALS[name]
    start = np.array([293.15, 800.0])
    stress, theta, eqps = sheared(material, rate, start)
    # All but the elastic part of the shear, sigma_y / (3 mu).
    np.testing.assert_allclose(eqps, math.sqrt(3.0), rtol=0.02)
    flow = material.hardening.flow_stress(eqps, np.full(2, rate), theta).value
    assert (stress > 0.0).all()
    # The temperature of the return mapping is that before the step's heat.
    np.testing.assert_allclose(stress, flow, rtol=0.02, atol=0.1)
    assert (start < theta).all()
    assert theta.max() < 1900.0
