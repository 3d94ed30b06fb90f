"""Materials: the library as published, tables in temperature, and what a bad material file says."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pfemcut.inputs import InputError
from pfemcut.materials.describe import described, source_of
from pfemcut.materials.hardening.voce import Voce
from pfemcut.materials.load import library_names, load_material, material_table

HERE = Path()


def steel(**changes: Any) -> dict[str, Any]:
    return {**material_table(load_material("aisi4340", HERE)), **changes}


def problem(spec: Any, base: Path = HERE) -> str:
    with pytest.raises(InputError) as caught:
        load_material(spec, base)
    (line,) = caught.value.problems
    return line


def test_aisi4340_flow_stress_at_cutting_conditions() -> None:
    law = load_material("aisi4340", HERE).hardening
    value = law.flow_stress(np.array([1.0]), np.array([1e5]), np.array([700.0])).value[0]
    softening = 1 - ((700 - 293.15) / (1793 - 293.15)) ** 1.03
    assert value == pytest.approx((792 + 510) * (1 + 0.014 * math.log(1e5)) * softening, rel=1e-12)


def test_42cd4_properties_follow_their_tables_and_stay_constant_beyond() -> None:
    steel_42cd4 = load_material("42cd4", HERE)
    np.testing.assert_allclose(
        steel_42cd4.capacity(np.array([300.0, 448.0, 548.0, 1200.0])), [0.473e9, 0.473e9, 0.496e9, 0.561e9]
    )
    np.testing.assert_allclose(steel_42cd4.conductivity(np.array([573.0])), [40.0])
    np.testing.assert_allclose(steel_42cd4.expansion(np.array([293.0, 483.0, 900.0])), [0, 0.725e-5, 1.45e-5])


@pytest.mark.parametrize("name", library_names())
def test_a_material_survives_being_written_as_a_table(name: str) -> None:
    material = load_material(name, HERE)
    assert load_material(material_table(material), HERE) == material


@pytest.mark.parametrize("name", library_names())
def test_a_printed_description_is_a_material_file(name: str, tmp_path: Path) -> None:
    material = load_material(name, HERE)
    (tmp_path / "copy.toml").write_text(described(material), encoding="utf-8")
    assert load_material("copy.toml", tmp_path) == material


def test_a_law_takes_the_reference_temperature_of_its_material() -> None:
    table = steel(reference_temperature=300.0)
    del table["hardening"]["reference_temperature"]
    assert load_material(table, HERE).hardening.reference_temperature == 300.0  # type: ignore[attr-defined]


def test_a_base_gives_what_a_table_leaves_out() -> None:
    changed = load_material({"base": "voce_steel", "hardening": {"flow_stress_softening": 0.0}}, HERE)
    law = changed.hardening
    assert isinstance(law, Voce)
    assert (law.flow_stress_softening, law.hardening_softening, law.yield_stress) == (0.0, 0.001, 450.0)
    assert changed.young_modulus == 206.9e3


def test_a_changed_value_does_not_keep_the_base_s_source() -> None:
    spec = {"base": "aisi4340", "density": 7.9e-9, "hardening": {"C": 0.02}}
    changed = load_material(spec, HERE)
    ours = "given in place of the base's value"
    assert source_of(changed, "density") == source_of(changed, "hardening.C") == ours
    assert source_of(changed, "capacity") == "the paper, Table 2"
    assert source_of(changed, "hardening.A").startswith("the paper, Table 2")


def test_changed_values_do_not_count_as_checked() -> None:
    base = load_material("aisi4340", HERE).checked
    assert load_material({"base": "aisi4340"}, HERE).checked == base
    changed = load_material({"base": "aisi4340", "density": 7.9e-9, "hardening": {"C": 0.02}}, HERE)
    assert changed.checked == f"{base} Changed, and not checked: density, hardening.C."
    own = load_material({"base": "aisi4340", "density": 7.9e-9, "checked": "weighed"}, HERE)
    assert own.checked == "weighed"


def test_another_law_drops_the_base_s_sources_of_the_law() -> None:
    changed = load_material({"base": "aisi4340", "hardening": {"law": "elastic"}}, HERE)
    assert changed.checked.endswith("Changed, and not checked: hardening.")
    assert source_of(changed, "hardening") == ""
    assert source_of(changed, "density") == "the paper, Table 2"


def test_a_base_s_source_can_be_replaced() -> None:
    spec = {"base": "aisi4340", "density": 7.9e-9, "sources": {"density": "weighed"}}
    assert source_of(load_material(spec, HERE), "density") == "weighed"


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("aisi434", ["[workpiece] material", "'aisi434'", "did you mean 'aisi4340'"]),
        ("granite", ["'granite'", "'42cd4'", "'aisi4340'", "'voce_steel'"]),
        ("missing.toml", ["missing.toml: no such file"]),
        (steel(youngs_modulus=1.0), ["youngs_modulus: unknown key", "did you mean 'young_modulus'"]),
        (steel(young_modulus=-1.0), ["young_modulus: given -1.0", "greater than 0", "MPa"]),
        (steel(poisson_ratio=0.5), ["poisson_ratio: given 0.5", "less than 0.5"]),
        (steel(poisson_ratio=True), ["poisson_ratio: given True", "must be a number"]),
        (steel(density=math.nan), ["density: given nan", "finite"]),
        (steel(density=7800.0), ["density: given 7800.0", "tonne/mm³"]),
        (steel(capacity="hot"), ["capacity: given 'hot'", "number or a table"]),
        (
            steel(capacity={"temperature": [1.0, 2.0], "value": [1.0]}),
            ["capacity", "2 temperatures and 1 values"],
        ),
        (steel(capacity={"temperature": [2.0, 1.0], "value": [1.0, 1.0]}), ["capacity", "must increase"]),
        (steel(capacity={"temperature": [1.0], "value": [0.0]}), ["value[0]: given 0.0", "greater than 0"]),
        (steel(hardening={"law": "jonson-cook"}), ["hardening] law", "did you mean 'johnson-cook'"]),
        (
            steel(sources={"densty": "a guess"}),
            ["sources: unknown key 'densty'", "did you mean 'density'"],
        ),
        (steel(sources={"hardening.AA": "a guess"}), ["'hardening.AA'", "'hardening.A'"]),
        (steel(sources={"density": 7}), ["sources", "given 7"]),
        (steel(notes="careful"), ["notes: given 'careful'", "must be a list"]),
        (steel(hardening=7), ["hardening: given 7", "must be a table"]),
        (steel(hardening={**steel()["hardening"], "a": 1.0}), ["a: unknown key", "did you mean 'A'"]),
        (
            steel(hardening={**steel()["hardening"], "melting_temperature": 200.0}),
            ["melting_temperature: given 200"],
        ),
    ],
)
def test_a_bad_material_is_one_line_naming_key_and_remedy(spec: Any, words: list[str]) -> None:
    line = problem(spec)
    for word in words:
        assert word in line
    assert "\n" not in line


def test_a_bad_material_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("young_modulus = 1.0\nyoung_modulus = 2.0\n", encoding="utf-8")
    line = problem("mine.toml", tmp_path)
    assert "mine.toml" in line
    assert "line 2" in line
