"""What the report's tables say: inputs with units and sources, numbers with their scatter, scales of pictures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from report_pages import inputs_text
from synthetic_cut import filled_frame

from pfemcut.inputs import InputError
from pfemcut.output.figures import FIELDS, colour_scale
from pfemcut.output.report.inputs import tables
from pfemcut.output.report.results import trend
from pfemcut.output.report.text import converted, number, shown, with_scatter
from pfemcut.output.scales import four_decades, from_zero, given_scales, round_up, temperature_scale
from pfemcut.results.derived.steady_window import steady_window
from pfemcut.units import unit_and_words


def test_scales_end_at_round_numbers_and_can_be_given() -> None:
    assert [round_up(value) for value in (1.0, 1.01, 2.5, 7.0, 0.021, 950.0)] == [
        1.0,
        1.5,
        3.0,
        8.0,
        0.03,
        1000.0,
    ]
    warm = temperature_scale(np.array([293.15, 814.0]))
    assert (warm.vmin, warm.vmax) == (290.0, 900.0)
    assert from_zero(np.full(1000, 1.7)).vmax == 2.0
    rate = four_decades(np.array([3.0e5]))
    assert (rate.vmin, rate.vmax) == (pytest.approx(100.0), pytest.approx(1e6))
    frame = filled_frame(6.0, 0.15, spacing=0.05)
    view = np.array([[-1.0, -1.0], [1.0, 1.0]])
    given = given_scales(["temperature=250:1200"], ["temperature"])
    scale = colour_scale(frame, FIELDS[0], view, given)
    assert (scale.vmin, scale.vmax) == (250.0, 1200.0)
    with pytest.raises(InputError, match="LOW < HIGH"):
        given_scales(["temperature=nan:1"], ["temperature"])


def rows_by_key(title: str) -> Iterator[tuple[str, object]]:
    sections, _ = tables(inputs_text("a"))
    for section in sections:
        if section.title == title:
            yield from ((row.key, row) for row in section.rows)


def test_inputs_have_meaning_unit_and_workshop_unit() -> None:
    speed = dict(rows_by_key("Cut"))["speed"]
    assert (speed.value, speed.unit, speed.other) == ("3330", "mm/s", "199.8 m/min")  # type: ignore[attr-defined]
    assert speed.meaning == "Cutting speed"  # type: ignore[attr-defined]
    friction = dict(rows_by_key("Contact"))["friction.shear_limit"]
    assert (friction.value, friction.unit) == ("500", "MPa")  # type: ignore[attr-defined]
    assert list(dict(rows_by_key("Particle spacing"))) == ["tip_size"]


def test_material_constants_have_numbered_sources() -> None:
    _, (material,) = tables(inputs_text("a"))
    rows = {row.key: row for row in material.rows}
    cited = {
        key: material.references[int(row.source.strip("[]")) - 1] for key, row in rows.items() if row.source
    }
    assert cited["poisson_ratio"] == "the paper, Table 2"
    assert cited["A"].startswith("the paper, Table 2; Johnson and Cook 1983")
    assert cited["melting_temperature"] == "not given in the paper; Johnson and Cook 1983"
    assert cited["young_modulus"] == "given in place of the base's value"
    assert (rows["density"].other, rows["melting_temperature"].unit) == ("7844 kg/m³", "K")


@pytest.mark.parametrize(
    ("description", "unit", "words"),
    [
        ("Cutting speed (mm/s)", "mm/s", "Cutting speed"),
        ("Specific heat (mm²/(s² K)); a number", "mm²/(s² K)", "Specific heat; a number"),
        ("Density (tonne/mm³; steel has 7.8e-9)", "tonne/mm³", "Density (steel has 7.8e-9)"),
        ("Zone (a circle) of size (mm)", "mm", "Zone (a circle) of size"),
        ("No unit (at all", "", "No unit (at all"),
    ],
)
def test_units_are_read_from_descriptions(description: str, unit: str, words: str) -> None:
    assert unit_and_words(description) == (unit, words)


def test_values_in_workshop_units() -> None:
    assert converted(500.0, "mm/s") == "30 m/min"
    assert converted(0.025, "mm") == "25 µm"
    assert converted(2.5, "mm") == ""
    assert converted([293.15, 373.15], "K") == "20, 100 °C"
    assert converted(5.31e8, "mm²/(s² K)") == "531 J/(kg K)"
    assert converted(1e4, "N/(mm s K)") == "1e7 W/(m² K)"
    assert converted(True, "mm") == ""
    assert shown(4e7) == "4e7"
    assert (number(1000.0, 3), number(0.10412, 3), number(-2.02e8, 6)) == ("1000", "0.104", "-2.02e8")


@pytest.mark.parametrize(
    ("mean", "std", "text"),
    [
        (180.818, 0.316, ("180.82", "0.32")),
        (0.050031, 0.001455, ("0.0500", "0.0015")),
        (50803.46, 3735.4, ("50800", "3700")),
        (0.1067746, 0.0000001, ("0.10677", "1.0e-07")),
        (12.0, 0.0, ("12.00", "0")),
    ],
)
def test_a_mean_has_the_digits_of_its_scatter(mean: float, std: float, text: tuple[str, str]) -> None:
    assert with_scatter(mean, std) == text


def test_trend_is_the_change_of_the_fitted_line() -> None:
    travel = np.linspace(0.01, 1.0, 100)
    window = steady_window(travel, np.full(100, 100.0))
    assert trend(travel, 5.0 + 2.0 * travel, window) == pytest.approx(2.0 * (window.end - window.begin))


def test_a_general_case_and_an_unknown_key_have_tables_too() -> None:
    text = """
    problem = "general"
    [[body]]
    name = "block"
    velocity = [1.0, 0.0]
    later = 3.0
    [body.material]
    name = "steel"
    young_modulus = 2.0e5
    [[boundary]]
    part = "top"
    pressure = 10.0
    """
    sections, (material,) = tables(text)
    rows = {row.key: row for section in sections for row in section.rows}
    assert (rows["0.later"].value, rows["0.later"].meaning) == ("3", "")
    assert rows["0.velocity"].unit == "mm/s"
    assert rows["0.pressure"].unit == "MPa"
    assert material.title == "block: steel"
