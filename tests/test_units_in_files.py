"""Values with units in case files, material files, sweeps and options, and what the schema declares of them."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel
from unit_texts import TEXTS

from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.load import CaseError, load_case, resolved_toml, validated
from pfemcut.case.schema import Case
from pfemcut.inputs import InputError, models_in
from pfemcut.materials.load import MaterialTable, load_material
from pfemcut.sweep.prepare import prepared
from pfemcut.sweep.study_file import read_plan
from pfemcut.units import KINDS, declared, in_base_unit

ROOT = Path(__file__).parent.parent
DEMO = ROOT / "demos" / "aisi4340_demo" / "case.toml"
KIND = {kind.unit: kind for kind in KINDS}


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
