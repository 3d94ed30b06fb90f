"""Each hardening law against its equation, its derivatives against differences, and its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pfemcut.materials.hardening import LAWS
from pfemcut.materials.hardening.base import LawModel
from pfemcut.materials.hardening.elastic import Elastic
from pfemcut.materials.hardening.johnson_cook import JohnsonCook
from pfemcut.materials.hardening.sima_ozel import SimaOzel
from pfemcut.materials.hardening.voce import Voce

VOCE = Voce(
    law="voce",
    yield_stress=450.0,
    saturation_stress=715.0,
    linear_hardening=129.24,
    exponent=16.93,
    flow_stress_softening=0.001,
    hardening_softening=0.002,
    reference_temperature=293.15,
)
JOHNSON_COOK = JohnsonCook(
    law="johnson-cook",
    A=792.0,
    B=510.0,
    n=0.26,
    C=0.014,
    m=1.03,
    melting_temperature=1793.0,
    reference_rate=2.0,
    reference_temperature=293.15,
)
SIMA_OZEL = SimaOzel(
    law="sima-ozel",
    A=724.7,
    B=683.1,
    n=0.47,
    C=0.035,
    m=1.0,
    a=2.0,
    b=5.0,
    d=1.0,
    R=2.0,
    S=0.05,
    melting_temperature=1878.0,
    reference_rate=1.0,
    reference_temperature=298.0,
)


def stress(law: LawModel, eqps: float, rate: float, temperature: float) -> float:
    return float(law.flow_stress(np.array([eqps]), np.array([rate]), np.array([temperature])).value[0])


def test_laws_are_found_by_name() -> None:
    assert LAWS["voce"] is Voce
    assert LAWS["johnson-cook"] is JohnsonCook
    assert LAWS["sima-ozel"] is SimaOzel


def test_voce_softens_initial_yield_and_hardening_by_their_own_coefficients() -> None:
    warming = 200.0
    initial, saturation = 450.0 * (1 - 0.001 * warming), 715.0 * (1 - 0.002 * warming)
    linear = 129.24 * (1 - 0.002 * warming)
    expected = saturation - (saturation - initial) * math.exp(-16.93 * 0.1) + linear * 0.1
    assert stress(VOCE, 0.1, 1e4, 293.15 + warming) == pytest.approx(expected, rel=1e-12)


def test_voce_with_equal_coefficients_is_equation_10() -> None:
    law = VOCE.model_copy(update={"hardening_softening": 0.001})
    cold = 715.0 - 265.0 * math.exp(-16.93 * 0.3) + 129.24 * 0.3
    assert stress(law, 0.3, 0.0, 393.15) == pytest.approx(0.9 * cold, rel=1e-12)


def test_johnson_cook_is_equation_11() -> None:
    theta = (800.0 - 293.15) / (1793.0 - 293.15)
    expected = (792.0 + 510.0 * 0.5**0.26) * (1 + 0.014 * math.log(1e5 / 2.0)) * (1 - theta**1.03)
    assert stress(JOHNSON_COOK, 0.5, 1e5, 800.0) == pytest.approx(expected, rel=1e-12)


def test_johnson_cook_yields_at_a_before_any_strain() -> None:
    assert stress(JOHNSON_COOK, 0.0, 0.0, 293.15) == 792.0


def test_johnson_cook_rate_term_is_never_below_one() -> None:
    at_reference = stress(JOHNSON_COOK, 0.1, 2.0, 400.0)
    assert stress(JOHNSON_COOK, 0.1, 1e-6, 400.0) == at_reference
    assert stress(JOHNSON_COOK, 0.1, 0.0, 400.0) == at_reference
    assert stress(JOHNSON_COOK, 0.1, 4.0, 400.0) > at_reference


def test_johnson_cook_does_not_harden_below_reference_temperature() -> None:
    assert stress(JOHNSON_COOK, 0.1, 1.0, 100.0) == stress(JOHNSON_COOK, 0.1, 1.0, 293.15)


@pytest.mark.parametrize(("law", "initial"), [(VOCE, 450.0), (JOHNSON_COOK, 792.0), (SIMA_OZEL, 724.7)])
def test_flow_stress_stays_positive_when_softening_has_taken_it_all(law: LawModel, initial: float) -> None:
    result = law.flow_stress(np.array([0.0, 1.0]), np.array([0.0, 1e5]), np.array([2500.0, 2500.0]))
    np.testing.assert_allclose(result.value, 1e-3 * initial)
    assert not result.by_eqps.any()
    assert not result.by_rate.any()
    assert not result.by_temperature.any()


def test_sima_ozel_is_its_equation() -> None:
    """Equation 4 of Sima and Ozel 2010 (their model 3) with scalar arithmetic."""
    strain, rate, theta = 0.8, 2e4, 900.0
    d, p = 1.0 - theta / 1878.0, (theta / 1878.0) ** 5
    hardening = 724.7 + 683.1 * strain**0.47 / math.exp(strain**2)
    johnson_cook = (1 + 0.035 * math.log(rate)) * (1 - (theta - 298.0) / (1878.0 - 298.0))
    softening = d + (1 - d) * math.tanh(1 / (strain + p) ** 2) ** 0.05
    expected = hardening * johnson_cook * softening
    assert stress(SIMA_OZEL, strain, rate, theta) == pytest.approx(expected, rel=1e-12)


def test_sima_ozel_softens_with_strain_and_the_more_the_hotter() -> None:
    """From its peak to a strain of 4; Johnson and Cook's law with the same constants hardens."""
    strain = np.linspace(0.05, 4.0, 200)
    rate = np.full_like(strain, 1e4)
    kept = []
    for theta in (298.0, 700.0, 1100.0):
        value = SIMA_OZEL.flow_stress(strain, rate, np.full_like(strain, theta)).value
        peak = int(value.argmax())
        assert 0 < peak < 199
        assert np.all(np.diff(value[peak:]) < 0.0)
        kept.append(value[-1] / value[peak])
    assert kept[0] > kept[1] > kept[2] > 0.5


@pytest.mark.parametrize("temperature", [0.0, 100.0, 298.0, 1877.999, 1878.0, 3000.0])
def test_sima_ozel_and_its_derivatives_are_finite_everywhere(temperature: float) -> None:
    strain = np.array([0.0, 1e-12, 1e-8, 1e-4, 1.0, 30.0])
    result = SIMA_OZEL.flow_stress(strain, np.zeros_like(strain), np.full_like(strain, temperature))
    for each in (result.value, result.by_eqps, result.by_rate, result.by_temperature):
        assert np.isfinite(each).all()
    assert (result.value > 0.0).all()


def test_an_elastic_material_has_no_slopes() -> None:
    one = np.ones(3)
    result = Elastic(law="elastic").flow_stress(one, one, one)
    assert not any(each.any() for each in (result.by_eqps, result.by_rate, result.by_temperature))


@given(
    law=st.sampled_from([VOCE, JOHNSON_COOK, SIMA_OZEL]),
    eqps=st.floats(1e-6, 5.0),
    rate=st.floats(10.0, 1e6),
    temperature=st.floats(300.0, 700.0),
)
def test_derivatives_match_central_differences(
    law: LawModel, eqps: float, rate: float, temperature: float
) -> None:
    exact = law.flow_stress(np.array([eqps]), np.array([rate]), np.array([temperature]))
    small = 1e-5 * eqps
    by_eqps = (
        stress(law, eqps + small, rate, temperature) - stress(law, eqps - small, rate, temperature)
    ) / (2 * small)
    step = 1e-4 * rate
    by_rate = (stress(law, eqps, rate + step, temperature) - stress(law, eqps, rate - step, temperature)) / (
        2 * step
    )
    # Round-off of the difference itself: about 1e-13 of the stress over the increment.
    assert exact.by_eqps[0] == pytest.approx(by_eqps, rel=1e-6, abs=1e-12 * exact.value[0] / small)
    assert exact.by_rate[0] == pytest.approx(by_rate, rel=1e-6, abs=1e-12 * exact.value[0] / step)
    warmer = 1e-3
    by_temperature = (
        stress(law, eqps, rate, temperature + warmer) - stress(law, eqps, rate, temperature - warmer)
    ) / (2 * warmer)
    assert exact.by_temperature[0] == pytest.approx(
        by_temperature, rel=1e-6, abs=1e-12 * exact.value[0] / warmer
    )


@given(eqps=st.floats(0.0, 1e-7))
def test_johnson_cook_is_continuous_and_finite_at_first_yield(eqps: float) -> None:
    result = JOHNSON_COOK.flow_stress(np.array([eqps]), np.zeros(1), np.array([293.15]))
    assert np.isfinite(result.by_eqps[0])
    assert result.by_eqps[0] > 0.0
    # Concave from the origin, and nowhere above the true power law.
    assert 792.0 <= result.value[0] <= 792.0 + 510.0 * eqps**0.26 + 1e-9


def test_johnson_cook_slope_below_smallest_strain_is_that_of_its_value() -> None:
    first, second = 2e-9, 6e-9
    rise = stress(JOHNSON_COOK, second, 0.0, 293.15) - stress(JOHNSON_COOK, first, 0.0, 293.15)
    slope = JOHNSON_COOK.flow_stress(np.array([4e-9]), np.zeros(1), np.array([293.15])).by_eqps[0]
    assert slope == pytest.approx(rise / (second - first), rel=1e-6)
    below, above = (
        stress(JOHNSON_COOK, 1e-8 * (1 - 1e-9), 0.0, 293.15),
        stress(JOHNSON_COOK, 1e-8, 0.0, 293.15),
    )
    assert below == pytest.approx(above, rel=1e-9)


def test_points_do_not_influence_each_other() -> None:
    eqps, rate, temperature = (
        np.array([0.0, 0.2, 1.5]),
        np.array([0.0, 1e3, 1e5]),
        np.array([250.0, 500.0, 900.0]),
    )
    for law in (VOCE, JOHNSON_COOK, SIMA_OZEL):
        together = law.flow_stress(eqps, rate, temperature).value
        alone = [stress(law, *point) for point in zip(eqps, rate, temperature, strict=True)]
        np.testing.assert_allclose(together, alone, rtol=1e-14)
