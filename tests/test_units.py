"""Values with units: equal to the plain numbers, wrong ones one clear line, no text a traceback."""

from __future__ import annotations

import string
import subprocess
import sys
import tomllib
from pathlib import Path

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel

from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.load import CaseError, load_case, resolved_toml, validated
from pfemcut.case.schema import Case
from pfemcut.cli.table import figure_in_column
from pfemcut.inputs import InputError, models_in
from pfemcut.materials.describe import described
from pfemcut.materials.load import MaterialTable, load_material
from pfemcut.sweep.prepare import prepared
from pfemcut.sweep.study_file import read_plan
from pfemcut.units import KINDS, Kind, UnitError, both, declared, in_base_unit, in_other

ROOT = Path(__file__).parent.parent
DEMO = ROOT / "demos" / "aisi4340_demo" / "case.toml"
KIND = {kind.unit: kind for kind in KINDS}

finite = st.floats(allow_nan=False, allow_infinity=False)
ordinary = st.floats(min_value=1e-9, max_value=1e9)


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


PIECES = st.sampled_from(
    [
        "mm",
        "m",
        "s",
        "min",
        "degC",
        "K",
        "W",
        "kg",
        "delta_degC",
        "deg",
        "°",
        "²",
        "⁻¹",
        "µ",
        "^",
        "**",
        "*",
        "/",
    ]
    + [
        "(",
        ")",
        " ",
        "1",
        "-2",
        "e9",
        ".",
        "inf",
        "nan",
        "%",
        "_",
        "rad",
        "kilo",
        "N",
        "Pa",
        "\n",
        "\x00",
        "None",
    ]
    + ["[length]", "@", "="]
)
TEXTS = st.one_of(
    st.text(max_size=40),
    st.text(alphabet=string.printable, max_size=40),
    st.builds(lambda number, pieces: f"{number}{''.join(pieces)}", finite, st.lists(PIECES, max_size=12)),
)


@pytest.mark.parametrize("unit", ["mm/s", "K", "degrees", "N/(mm s K)"])
@settings(max_examples=400, deadline=2000)
@given(text=TEXTS)
def test_any_text_is_a_number_or_a_clear_error(unit: str, text: str) -> None:
    try:
        assert isinstance(in_base_unit(text, KIND[unit]), float)
    except UnitError as error:
        assert len(str(error).splitlines()) == 1


# In case files, material files, sweeps


def test_a_case_with_units_is_the_case_of_plain_numbers(tmp_path: Path) -> None:
    changes = {
        "workpiece.length": ("2.5 mm", 2.5),
        "workpiece.temperature": ("20 degC", 293.15),
        "tool.rake": ("6 deg", 6.0),
        "tool.tip_radius": ("25 um", 0.025),
        "cutting.speed": ("199.8 m/min", 3330.0),
        "cutting.depth": ("100 um", 0.1),
        "contact.conductance": ("1e7 W/(m^2 K)", 1e4),
        "time.step": ("0.1041 us", 1.041e-7),
        "workpiece.material.density": ("7850 kg/m^3", 7.85e-9),
        "workpiece.material.young_modulus": ("205 GPa", 205e3),
        "workpiece.material.reference_temperature": ("25 degC", 298.15),
        "workpiece.material.hardening.A": ("0.79 GPa", 790.0),
        "workpiece.material.capacity": (
            {"temperature": ["20 degC", 500], "value": ["477 J/(kg K)", 5e8]},
            {"temperature": [293.15, 500], "value": [477e6, 5e8]},
        ),
        "contact.friction": (
            '{law = "table", coefficient = {at = ["30 m/min", 900], value = [0.4, 0.3]}}',
            '{law = "table", coefficient = {at = [500, 900], value = [0.4, 0.3]}}',
        ),
    }
    with_units, plain = (
        load_case(DEMO, [f"{key}={_toml(pair[at])}" for key, pair in changes.items()]) for at in (0, 1)
    )
    resolved = resolved_toml(*with_units)
    assert resolved == resolved_toml(*plain)
    assert tomllib.loads(resolved)["cutting"]["speed"] == 3330.0


def _toml(value: object) -> str:
    if not isinstance(value, dict):
        return str(value)
    return "{" + ", ".join(f"{key} = {str(each)}" for key, each in value.items()) + "}"


def test_a_general_case_takes_units_in_lists_and_inner_tables() -> None:
    case = GeneralCase.model_validate(
        {
            "problem": "general",
            "body": [
                {
                    "outline": [[0, 0], ["1 cm", 0], ["1 cm", "10 mm"], [0, 10]],
                    "parts": ["bottom", "right", "top", "left"],
                    "material": "aisi4340",
                    "velocity": ["1 m/s", 0],
                }
            ],
            "boundary": [
                {
                    "part": "bottom",
                    "displacement": {"x": 0, "y": {"time": [0, "1 ms"], "value": [0, "5 um"]}},
                },
                {"part": "top", "pressure": {"time": [0.0, 1.0], "value": [0.0, "1 GPa"]}},
                {"part": "right", "convection": {"coefficient": "10 W/(m^2 K)", "ambient": "20 degC"}},
                {"part": "left", "traction": {"x": "1 kPa"}, "flux": "1 W/mm^2"},
            ],
            "mesh": {"size": "1 mm"},
            "time": {"step": "1 us", "end": "1 ms"},
        }
    )
    bottom, top, right, left = (side.model_dump(exclude_none=True) for side in case.boundary)
    assert case.body[0].outline == ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0))
    assert case.body[0].velocity == (1000.0, 0.0)
    assert bottom["displacement"] == {"x": 0.0, "y": {"time": (0.0, 1e-3), "value": (0.0, 5e-3)}}
    assert top["pressure"] == {"time": (0.0, 1.0), "value": (0.0, 1000.0)}
    assert right["convection"] == {"coefficient": 0.01, "ambient": 293.15}
    assert (left["traction"], left["flux"]) == ({"x": 1e-3}, 1000.0)


def test_all_wrong_units_of_a_case_are_found_in_one_go() -> None:
    overrides = [
        "cutting.speed=200 mm",
        "workpiece.length=3 foo",
        "tool.temperature=-300 degC",
        "mesh.growth=3 mm",
    ]
    with pytest.raises(CaseError) as error:
        load_case(DEMO, [*overrides, "workpiece.material.density=3 kg"])
    lines = sorted(line.split(":")[0] for line in error.value.problems)
    assert lines == [
        "[cutting] speed",
        "[mesh] growth",
        "[tool] temperature",
        "[workpiece.material] density",
        "[workpiece] length",
    ]  # fmt: skip


def test_a_friction_law_with_a_wrong_unit_is_one_line() -> None:
    with pytest.raises(CaseError) as error:
        load_case(DEMO, ['contact.friction={law = "power", coefficient = 0.3, speed = "3 mm"}'])
    (line,) = error.value.problems
    assert line.startswith("[contact.friction] speed: given '3 mm', which is a length: must be a speed")


def test_a_sweep_takes_units_and_tabulates_plain_numbers(tmp_path: Path) -> None:
    plan = read_plan(DEMO, vary=["cutting.speed=60 m/min,120 m/min"], output=tmp_path)
    variants = prepared(plan)
    assert [each.parameters["cutting.speed"] for each in variants] == [1000.0, 2000.0]
    assert len({each.directory for each in variants}) == 2


@settings(max_examples=200, deadline=5000)
@given(text=TEXTS)
def test_any_text_in_a_material_file_is_a_value_or_a_clear_error(text: str) -> None:
    spec = {"base": "aisi4340", "density": text, "hardening": {"melting_temperature": text}}
    try:
        load_material(spec, ROOT)
    except InputError as error:
        assert all("\n" not in line for line in error.problems)


# The schema declares its units


def _number_fields(model: type[BaseModel], seen: set[type[BaseModel]]) -> list[tuple[str, str]]:
    if model in seen:
        return []
    seen.add(model)
    found = []
    for key, field in model.model_fields.items():
        if "float" in repr(field.annotation) + repr(field.metadata):
            found.append((f"{model.__name__}.{key}", field.description or ""))
        for inner in models_in(field.annotation, field.metadata):
            found += _number_fields(inner, seen)
    return found


def test_every_unit_in_the_schema_is_known() -> None:
    """A unit in brackets that ``declared`` does not know would be a key that takes no units, silently."""
    seen: set[type[BaseModel]] = set()
    fields = [each for model in (Case, GeneralCase, MaterialTable) for each in _number_fields(model, seen)]
    assert len(fields) > 150
    unknown = [
        (name, text)
        for name, text in fields
        if "(" in text and "(dimensionless" not in text and declared(text) is None
    ]
    # Its unit depends on the exponent, another key.
    assert [name for name, _ in unknown] == ["NortonHoff.coefficient"]


def test_check_does_not_load_pint_for_plain_numbers() -> None:
    code = (
        "import sys; from pfemcut.cli.main import status; "
        f"assert status(['check', {str(DEMO)!r}]) == 0; print('pint' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.splitlines()[-1] == "False"
    assert "3330 mm/s = 199.8 m/min" in done.stdout


def test_the_page_on_units_is_right() -> None:
    """Every example of the table is of the kind of its line, and its units are those of the code."""
    text = (ROOT / "docs" / "units.md").read_text(encoding="utf-8")
    rows = [
        [cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line[:2] == "| "
    ][1:]
    for _, unit, examples, other in rows:
        kind = KIND[unit]
        assert kind.other == other.partition(",")[0]
        for example in examples.replace("`", "").replace('"', "").split(", "):
            assert in_base_unit(example, kind) > 0.0
    assert {row[1] for row in rows} == {kind.unit for kind in KINDS} - {"MPa/mm"}


KEYS = (
    "workpiece.length",
    "workpiece.temperature",
    "tool.rake",
    "tool.conduction.capacity",
    "cutting.speed",
    "contact.conductance",
    "contact.conductance.value",
    "contact.friction",
    "contact.friction.speed",
    "mesh.growth",
    "mesh.tip_size",
    "time.step",
    "workpiece.material.expansion",
    "workpiece.material.capacity.value",
    "workpiece.material.hardening.A",
)


@settings(max_examples=300, deadline=5000)
@given(key=st.sampled_from(KEYS), text=TEXTS)
def test_any_text_on_the_command_line_is_a_value_or_a_clear_error(key: str, text: str) -> None:
    try:
        load_case(DEMO, [f"{key}={text}"])
    except CaseError as error:
        assert all(line and "\n" not in line for line in error.problems)


def test_a_wrong_unit_where_a_table_may_stand_is_one_line() -> None:
    case = {
        "problem": "general",
        "body": [{"outline": [[0, 0], [1, 0], [0, 1]], "parts": ["a", "b", "c"], "material": "aisi4340"}],
        "boundary": [{"part": "a", "temperature": "5 mm", "displacement": {"x": "1 s"}}],
        "mesh": {"size": 0.5},
        "time": {"step": 1e-6, "end": 1e-3},
    }
    with pytest.raises(CaseError) as error:
        validated(case, ROOT)
    lines = error.value.problems
    assert len(lines) == 2
    assert "x: given '1 s', which is a time: must be a length" in lines[0]
    assert "temperature: given '5 mm', which is a length: must be a temperature" in lines[1]
