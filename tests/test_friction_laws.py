"""Each friction law against its formula, its derivatives against differences, dissipation and limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import Array
from pydantic import ValidationError

from pfemcut.contact.conductance import Conductance
from pfemcut.contact.friction import Interface, Shear
from pfemcut.contact.friction_laws import LAWS
from pfemcut.contact.friction_laws.base import LawModel
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.contact.friction_laws.norton_hoff import NortonHoff
from pfemcut.contact.friction_laws.power import PowerLaw
from pfemcut.contact.friction_laws.shear import ShearFriction
from pfemcut.contact.friction_laws.sticking_sliding import StickingSliding
from pfemcut.contact.friction_laws.table import Points, TableLaw
from pfemcut.contact.friction_laws.usui import Usui

V_REF = 1.0
K = 800.0 / math.sqrt(3.0)  # shear yield stress of the flow stress below
COULOMB = Coulomb(coefficient=0.3)
STICKING = StickingSliding(law="sticking-sliding", coefficient=0.5, shear_factor=0.8)
USUI = Usui(law="usui", coefficient=0.5)
CHILDS = Usui(law="usui", coefficient=0.9, shear_factor=0.8, exponent=1.7)
SHEAR = ShearFriction(law="shear", shear_factor=0.6)
VISCOUS = NortonHoff(law="norton-hoff", coefficient=6e-5)
NORTON_HOFF = NortonHoff(law="norton-hoff", coefficient=0.01, exponent=0.4)
POWER = PowerLaw(
    law="power",
    coefficient=0.3,
    speed_exponent=-0.2,
    pressure_exponent=-0.3,
    temperature_exponent=-0.5,
    least=0.05,
    largest=0.9,
    shear_factor=1.0,
)
TABLE = TableLaw(
    law="table",
    coefficient=Points(at=(333.3, 1000.0, 1666.7), value=(0.42, 0.32, 0.24)),
    pressure_factor=Points(at=(0.0, 2000.0), value=(1.2, 0.8)),
    temperature_factor=Points(at=(300.0, 900.0), value=(1.0, 0.7)),
    shear_factor=0.9,
)
ALL = [COULOMB, STICKING, USUI, CHILDS, SHEAR, VISCOUS, NORTON_HOFF, POWER, TABLE]
laws = st.sampled_from(ALL)
speeds = st.one_of(st.floats(-5.0, 5.0), st.floats(-5000.0, 5000.0))


def shear(
    law: LawModel,
    pressure: Any,
    speed: Any,
    temperature: float = 600.0,
    stress: float = 800.0,
    last: float | None = None,
) -> Shear:
    """Of a contact known to slip as fast, unless ``last`` says otherwise."""
    given = (pressure, speed, speed if last is None else last, temperature, stress)
    p, v, before, t, s = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, float)) for x in given))
    return law.shear(Interface(p, v, before, t, s), V_REF)


def value(
    law: LawModel, pressure: float, speed: float, temperature: float = 600.0, stress: float = 800.0
) -> float:
    return float(shear(law, pressure, speed, temperature, stress).value[0])


def test_laws_are_found_by_name() -> None:
    assert dict(LAWS) == {
        "coulomb": Coulomb,
        "norton-hoff": NortonHoff,
        "power": PowerLaw,
        "shear": ShearFriction,
        "sticking-sliding": StickingSliding,
        "table": TableLaw,
        "usui": Usui,
    }
    assert {type(law) for law in ALL} == set(LAWS.values())


@given(law=laws, pressure=st.floats(1.0, 3000.0), speed=speeds, temperature=st.floats(280.0, 1200.0))
def test_derivatives_match_central_differences(
    law: LawModel, pressure: float, speed: float, temperature: float
) -> None:
    """To 1e-5 of the traction per pressure and per V_ref, wherever both sides of a kink agree."""
    exact = shear(law, pressure, speed, temperature, last=speed)
    for name, h, unit in (("by_pressure", 1e-3, pressure), ("by_speed", 1e-5, V_REF)):
        step = np.array([-h, h]) if name == "by_pressure" else np.zeros(2)
        slide = np.array([-h, h]) if name == "by_speed" else np.zeros(2)
        around = shear(law, pressure + step, speed + slide, temperature, last=speed)
        slopes = getattr(around, name)
        if not np.isclose(*slopes, rtol=1e-2, atol=1e-9):
            continue  # a kink in between: one-sided derivatives differ, as they should
        difference = float(np.diff(around.value)[0]) / (2.0 * h)
        scale = (abs(float(exact.value[0])) + 1.0) / unit
        assert float(getattr(exact, name)[0]) == pytest.approx(difference, rel=1e-4, abs=1e-5 * scale)


@given(law=laws, pressure=st.floats(0.0, 5000.0), speed=speeds, stress=st.floats(1.0, 2000.0))
def test_friction_opposes_the_slip_and_dissipates(
    law: LawModel, pressure: float, speed: float, stress: float
) -> None:
    found = value(law, pressure, speed, stress=stress)
    assert found * speed >= 0.0
    assert found == pytest.approx(-value(law, pressure, -speed, stress=stress), rel=1e-14)


@pytest.mark.parametrize("law", ALL, ids=lambda law: type(law).__name__)
def test_nothing_without_pressure_and_nothing_at_rest(law: LawModel) -> None:
    assert value(law, 0.0, 1000.0) == 0.0
    assert value(law, 700.0, 0.0) == 0.0


@given(law=laws, pressure=st.floats(1.0, 3000.0), speed=speeds, temperature=st.floats(280.0, 1200.0))
def test_traction_grows_with_pressure(
    law: LawModel, pressure: float, speed: float, temperature: float
) -> None:
    if (
        law is TABLE
    ):  # a falling factor of pressure may take more than the pressure gives, not here below 2000 MPa
        pressure = min(pressure, 1900.0)
    assert abs(value(law, 1.01 * pressure, speed, temperature)) >= abs(
        value(law, pressure, speed, temperature)
    ) * (1.0 - 1e-14)


@given(law=laws, speed=speeds, last=speeds)
def test_traction_grows_with_speed_within_a_step(law: LawModel, speed: float, last: float) -> None:
    """Also where the coefficient falls with the speed, so that a load has one slip speed."""
    assert np.all(shear(law, 900.0, speed, last=last).by_speed >= 0.0)


def test_coulomb_is_equation_26() -> None:
    assert value(COULOMB, 500.0, 0.7) == pytest.approx(0.3 * 500.0 * math.tanh(0.7), rel=1e-14)
    assert value(COULOMB, 500.0, -100.0) == pytest.approx(-150.0, rel=1e-14)


def test_sticking_and_sliding() -> None:
    """mu p below m k / mu = 739 MPa, m k above; k by the flow stress; a constant limit on top."""
    assert value(STICKING, 700.0, 100.0) == pytest.approx(350.0)
    assert value(STICKING, 780.0, 100.0) == pytest.approx(0.8 * K)
    assert value(STICKING, 780.0, 100.0, stress=400.0) == pytest.approx(0.4 * K)
    assert shear(STICKING, 780.0, 100.0).by_pressure == 0.0
    limited = STICKING.model_copy(update={"shear_limit": 200.0})
    assert value(limited, 780.0, 100.0) == pytest.approx(200.0)
    only = StickingSliding(law="sticking-sliding", coefficient=0.5, shear_limit=576.0)
    assert value(only, 3000.0, 100.0, stress=100.0) == pytest.approx(576.0)
    with pytest.raises(ValidationError, match="needs shear_factor, shear_limit or both"):
        StickingSliding(law="sticking-sliding", coefficient=0.5)


def test_usui_slides_at_low_and_sticks_at_high_pressure() -> None:
    assert value(USUI, 300.0, 100.0) == pytest.approx(K * (1.0 - math.exp(-150.0 / K)), rel=1e-14)
    x = 0.9 * 400.0 / (0.8 * K)
    expected = 0.8 * K * (1.0 - math.exp(-(x**1.7))) ** (1.0 / 1.7)
    assert value(CHILDS, 400.0, 100.0) == pytest.approx(expected, rel=1e-12)
    assert value(CHILDS, 1e-3, 100.0) == pytest.approx(0.9e-3, rel=1e-4)
    assert value(CHILDS, 1e5, 100.0) == pytest.approx(0.8 * K, rel=1e-12)


@given(pressure=st.floats(1.0, 3000.0))
def test_sharp_usui_is_sticking_and_sliding(pressure: float) -> None:
    sharp = Usui(law="usui", coefficient=0.5, shear_factor=0.8, exponent=20.0)
    assert value(sharp, pressure, 100.0) == pytest.approx(value(STICKING, pressure, 100.0), rel=0.03)


def test_norton_hoff_is_viscous() -> None:
    assert value(VISCOUS, 10.0, 2500.0) == pytest.approx(6e-5 * K * 2500.0, rel=1e-14)
    assert value(VISCOUS, 10.0, 0.01) == pytest.approx(6e-5 * K * 0.01, rel=1e-14)
    assert value(NORTON_HOFF, 10.0, 2500.0) == pytest.approx(0.01 * K * 2500.0**0.4, rel=1e-6)


def test_power_law_and_its_bounds() -> None:
    expected = 0.3 * 2.0**-0.2 * 0.5**-0.3 * (600.0 / 293.15) ** -0.5 * 500.0
    assert value(POWER, 500.0, 2000.0) == pytest.approx(expected, rel=1e-12)
    assert value(POWER, 0.1, 2000.0) == pytest.approx(0.9 * 0.1, rel=1e-12)
    unlimited = 0.3 * 2.0**-0.2 * 5.0**-0.3 * (600.0 / 293.15) ** -0.5 * 5000.0
    assert unlimited > K / 2
    assert value(POWER, 5000.0, 2000.0, stress=400.0) == pytest.approx(K / 2)
    with pytest.raises(ValidationError, match="must not exceed largest"):
        PowerLaw(law="power", coefficient=0.3, least=0.5, largest=0.4)


def test_table_interpolates_and_ends_are_constant() -> None:
    for speed, mu in ((100.0, 0.42), (1000.0, 0.32), (1333.35, 0.28), (5000.0, 0.24)):
        assert value(TABLE, 500.0, speed) == pytest.approx(mu * 1.1 * 0.85 * 500.0, rel=1e-12)
    for wrong in (
        {"at": (1.0,), "value": ()},
        {"at": (2.0, 1.0), "value": (0.1, 0.2)},
        {"at": (), "value": ()},
    ):
        with pytest.raises(ValidationError):
            Points(**wrong)


def test_conductance_follows_the_pressure() -> None:
    pressure: Array = np.array([0.0, 50.0, 100.0, 200.0])
    assert Conductance(5.0)(pressure) == pytest.approx([0.0, 5.0, 5.0, 5.0])
    assert Conductance(5.0, 100.0, 0.95)(pressure) == pytest.approx([0.0, 5 * 0.5**0.95, 5.0, 5 * 2**0.95])
