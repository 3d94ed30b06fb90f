"""Values with units: equal to the plain numbers, wrong ones one clear line, no text a traceback."""

from __future__ import annotations

from pathlib import Path

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from unit_texts import TEXTS, finite, ordinary

from pfemcut.cli.table import figure_in_column
from pfemcut.materials.describe import described
from pfemcut.materials.load import load_material
from pfemcut.units import KINDS, Kind, UnitError, both, in_base_unit, in_other

ROOT = Path(__file__).parent.parent
DEMO = ROOT / "demos" / "aisi4340_demo" / "case.toml"
KIND = {kind.unit: kind for kind in KINDS}


# Values


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("200 m/min", "mm/s", 200e3 / 60),
        ("3.33 m/s", "mm/s", 3330.0),
        ("200 ft/min", "mm/s", 200 * 304.8 / 60),
        ("0.1mm", "mm", 0.1),
        ("25 µm", "mm", 0.025),
        ("25um", "mm", 0.025),
        ("1e-1 in", "mm", 2.54),
        ("65 degC", "K", 338.15),
        ("65 °C", "K", 338.15),
        ("-10 degC", "K", 263.15),
        ("212 degF", "K", 373.15),
        ("300 K", "K", 300.0),
        ("210 GPa", "MPa", 210e3),
        ("792 N/mm^2", "MPa", 792.0),
        ("30 ksi", "MPa", 30 * 6.894757293168361),
        ("7830 kg/m^3", "tonne/mm³", 7.83e-9),
        ("7.83 g/cm³", "tonne/mm³", 7.83e-9),
        ("477 J/(kg K)", "mm²/(s² K)", 477e6),
        ("477 J/kg/degC", "mm²/(s² K)", 477e6),
        ("44.5 W/(m K)", "N/(s K)", 44.5),
        ("44.5 W/(m degC)", "N/(s K)", 44.5),
        ("1e8 W/(m² K)", "N/(mm s K)", 1e5),
        ("1e8 W m⁻² K⁻¹", "N/(mm s K)", 1e5),
        ("12.3e-6 /K", "1/K", 12.3e-6),
        ("12.3 um/(m degC)", "1/K", 12.3e-6),
        ("50 W/mm**2", "N/(mm s)", 5e4),
        ("15 deg", "degrees", 15.0),
        ("15°", "degrees", 15.0),
        ("0.5 rad", "degrees", 28.64788975654116),
        ("0.1041 us", "s", 1.041e-7),
        ("40 TPa/m", "MPa/mm", 4e4),
        ("1000 1/s", "1/s", 1000.0),
        ("1 kHz", "1/s", 1000.0),
    ],
)
def test_a_value_with_a_unit_is_that_in_base_units(text: str, unit: str, value: float) -> None:
    assert in_base_unit(text, KIND[unit]) == pytest.approx(value, rel=2e-15)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.unit)
@given(value=finite)
def test_a_value_in_its_base_unit_is_the_plain_number(kind: Kind, value: float) -> None:
    assert in_base_unit(f"{value!r} {kind.unit}", kind) == value


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.unit)
@given(value=ordinary)
def test_there_and_back_again(kind: Kind, value: float) -> None:
    """What ``both`` shows is a value with a unit that gives the number back."""
    shown, unit = in_other(value, kind.unit) or (value, kind.unit)
    scale = max(abs(value), abs(kind.offset))
    assert in_base_unit(f"{shown!r} {unit}", kind) == pytest.approx(value, rel=0, abs=6e-15 * scale)


@given(value=st.integers(min_value=1, max_value=10**9), power=st.integers(min_value=-6, max_value=3))
def test_conversion_leaves_no_noise_in_the_last_digits(value: int, power: int) -> None:
    """Nine digits in kg/m³ are the same nine digits in tonne/mm³: the float that a user would type."""
    text = f"{value}e{power}"
    assert in_base_unit(f"{text} kg/m^3", KIND["tonne/mm³"]) == float(f"{value}e{power - 12}")
    assert in_base_unit(f"{text} m", KIND["mm"]) == float(f"{value}e{power + 3}")


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind.other], ids=lambda kind: kind.unit)
def test_shown_units_are_those_of_pint(kind: Kind) -> None:
    registry = pint.UnitRegistry()
    base = kind.unit.replace("²", "^2").replace("³", "^3")
    for value in (1.0, 345.0):
        there = registry.Quantity(value, registry.parse_units(base)).to(kind.other).magnitude
        assert kind.factor * value + kind.offset == pytest.approx(there, rel=1e-12)


def test_both_shows_a_second_unit_where_engineers_use_one() -> None:
    assert both(3330.0, "mm/s") == "3330 mm/s = 199.8 m/min"
    assert both(338.15, "K", 5) == "338.15 K = 65 degC"
    assert both(7.83e-9, "tonne/mm³") == "7.83e-09 tonne/mm³ = 7830 kg/m^3"
    assert both(0.1, "mm") == "0.1 mm"
    assert both(30.0, "degree") == "30 degree"
    assert both(0.42, "-") == "0.42"


def test_results_and_materials_are_shown_in_both_units() -> None:
    assert figure_in_column({"mean": 820.0, "std": 1.4, "unit": "K"}).strip() == "820 +- 1.4 K = 546.9 degC"
    assert figure_in_column({"value": 0.171, "unit": "mm"}).strip() == "0.171 mm"
    lines = described(load_material("aisi4340", ROOT)).splitlines()
    density = next(line for line in lines if line.startswith("density"))
    assert "# 7844 kg/m^3: Density" in density


# Mistakes


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("200 mm", "mm/s", "given '200 mm', which is a length: must be a speed such as '200 m/min'"),
        ("200 m/min", "mm", "which is a speed: must be a length such as '0.1 mm', or a number (mm)"),
        ("10 delta_degC", "K", "which is a temperature difference: must be a temperature such as"),
        ("10 degC km/m", "K", "which is a temperature difference"),
        ("65 C", "K", "which is an electric charge (degC is a temperature)"),
        ("65 K/s", "K", "which is a rate of temperature"),
        ("15", "degrees", "given '15', which has no unit: must be an angle such as '15 deg'"),
        ("15 %", "degrees", "given '15 %', must be an angle"),
        ("1000 rpm", "1/s", "which is a speed of rotation: must be a rate"),
        ("3 foo", "mm", "unknown unit 'foo': must be a length"),
        ("mm", "mm", "given 'mm', must be a length"),
        ("fast", "mm/s", "given 'fast', must be a speed"),
        ("", "mm", "given '', must be a length"),
        ("1 + 1 mm", "mm", "given '1 + 1 mm', must be a length"),
        ("1 mm^999999", "mm", "given '1 mm^999999', must be a length"),
        ("9**9**9**9 mm", "mm", "must be a length"),
        ("1 __import__('os')", "mm", "must be a length"),
        ("1 " + "m" * 500, "mm", "must be a length"),
        ("5 kg/s", "mm/s", "given '5 kg/s', must be a speed"),
    ],
)
def test_a_wrong_quantity_is_one_clear_line(text: str, unit: str, words: str) -> None:
    with pytest.raises(UnitError, match="^given ") as error:
        in_base_unit(text, KIND[unit])
    assert words in str(error.value)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("unit", ["mm/s", "K", "degrees", "N/(mm s K)"])
@settings(max_examples=400, deadline=2000)
@given(text=TEXTS)
def test_any_text_is_a_number_or_a_clear_error(unit: str, text: str) -> None:
    try:
        assert isinstance(in_base_unit(text, KIND[unit]), float)
    except UnitError as error:
        assert len(str(error).splitlines()) == 1
