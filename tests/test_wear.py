"""Usui's wear rate by hand, the library of constants, and what a case file may say of them."""

from __future__ import annotations

import math
import re
import runpy
import tomllib
from pathlib import Path

import numpy as np
import pytest

from pfemcut.case.load import CaseError, load_case, resolved_toml, validated
from pfemcut.results.checkpoint import changed_keys
from pfemcut.wear.load import wear_names, wear_of, wear_table

CASE = """
[workpiece]
length = 2.5
height = 1.0
material = "aisi4340"
[tool]
tip_radius = 0.025
[cutting]
speed = 3330.0
depth = 0.1
travel = 0.5
[time]
step = 1e-7
"""


def case_file(directory: Path, wear: str) -> Path:
    path = directory / "case.toml"
    path.write_text(CASE.replace("tip_radius = 0.025", f"tip_radius = 0.025\nwear = {wear}"))
    return path


def test_rate_by_hand() -> None:
    """A = 1e-8 /MPa, 1000 MPa, 2000 mm/s and T = B / 5: 0.02 exp(-5) mm/s, whichever way the chip slides."""
    law = wear_of({"A": 1e-8, "B": 5000.0})
    rates = law(np.array([1000.0, 1000.0, 0.0]), np.array([2000.0, -2000.0, 5.0]), np.full(3, 1000.0))
    assert rates == pytest.approx([0.02 * math.exp(-5.0)] * 2 + [0.0])


def test_constants_change_at_their_temperature() -> None:
    law = wear_of({"A": 1e-8, "B": 0.0, "above": {"temperature": 1150.0, "A": 3e-8, "B": 0.0}})
    one = np.ones(3)
    assert law(one, one, np.array([1149.9, 1150.0, 1300.0])) == pytest.approx([1e-8, 3e-8, 3e-8])


def test_carbide_on_carbon_steel_by_hand() -> None:
    """1000 MPa, 1 m/s: 7.8e-9 x 1e6 exp(-5302/1150) mm/s = 4.655 um/min below 1150 K; above, by the other pair."""
    law = wear_of(wear_table("p20_carbon_steel", Path()))
    pressure, speed = np.full(2, 1000.0), np.full(2, 1000.0)
    rates = 6e4 * law(pressure, speed, np.array([1149.999, 1250.0]))
    assert rates[0] == pytest.approx(4.655, rel=1e-3)
    assert rates[1] == pytest.approx(6e4 * 1.198e-2 * 1e6 * math.exp(-21950.0 / 1250.0))


@pytest.mark.parametrize("name", wear_names())
def test_library_says_where_its_constants_come_from_and_what_is_unconfirmed(name: str) -> None:
    law = wear_of(wear_table(name, Path()))
    assert law.source
    assert "nconfirmed" in law.checked
    # Of the size of what is measured: 1000 MPa, 1 m/s and 1200 K wear 0.1 to 1000 um/min.
    rate = 6e4 * law(np.array([1000.0]), np.array([1000.0]), np.array([1200.0]))[0]
    assert 0.1 < rate < 1000.0


@pytest.mark.parametrize(
    ("wear", "message"),
    [
        (
            '"p20_carbon"',
            "[tool] wear: unknown pair 'p20_carbon'; did you mean 'p20_carbon_steel'? (or a path",
        ),
        ("3", "[tool] wear: given 3, must be a name in the library, a path or a table"),
        ("{A = 1e-8}", "[tool.wear] B: missing and has no default: Usui's temperature B (K)"),
        ("{A = -1.0, B = 1.0}", "[tool.wear] A: given -1.0, must be greater than 0"),
        ("{A = 1.0, B = 1.0, C = 2.0}", "[tool.wear] C: unknown key"),
        (
            "{A = 1.0, B = 1.0, above = {A = 1.0, B = 1.0}}",
            "[tool.wear.above] temperature: missing and has no default",
        ),
        ('"none.toml"', "none.toml: no such file"),
    ],
)
def test_a_mistake_is_one_clear_line(wear: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError) as error:
        load_case(case_file(tmp_path, wear))
    assert len(error.value.problems) == 1
    assert message in error.value.problems[0]


def test_constants_come_from_library_file_or_table(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("A = 1e-8\nB = 5000.0\n")
    for wear in ('"mine.toml"', "{A = 1e-8, B = 5000.0}"):
        case, material = load_case(case_file(tmp_path, wear))
        # The resolved case alone makes the same case again.
        text = resolved_toml(case, material)
        assert resolved_toml(*validated(tomllib.loads(text), Path())) == text
        law = wear_of(tomllib.loads(text)["tool"]["wear"])
        assert (law.ranges[0].A, law.ranges[0].B) == (1e-8, 5000.0)
    case, material = load_case(case_file(tmp_path, '"wc_co_ti6al4v"'))
    assert tomllib.loads(resolved_toml(case, material))["tool"]["wear"]["B"] == 18769.9


@pytest.mark.parametrize("name", wear_names())
def test_page_has_the_library_s_constants(name: str) -> None:
    page = (Path(__file__).parent.parent / "docs" / "tool_profiles.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith(f"| `{name}` |"))
    law = wear_of(wear_table(name, Path()))
    assert law.name in row
    numbers = {float(word) for word in re.findall(r"\d[\d.]*(?:e-?\d+)?", row)}
    assert {value for each in law.ranges for value in (each.A, each.B)} <= numbers


def test_page_shows_what_was_measured() -> None:
    script = runpy.run_path(str(Path(__file__).parent.parent / "scripts" / "tool_profiles_page.py"))
    text = script["PAGE"].read_text(encoding="utf-8")
    assert script["page"](text) == text, "run python scripts/tool_profiles_page.py"


def test_a_case_without_constants_is_resolved_as_before(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    assert "wear" not in resolved_toml(*load_case(path))


def test_a_resumed_run_may_be_given_other_constants() -> None:
    old, new = "[tool]\nrake = 1.0\n[tool.wear]\nA = 1.0\n", "[tool]\nrake = 2.0\n[tool.wear]\nA = 2.0\n"
    assert changed_keys(old, new) == ("tool.rake: 1.0 -> 2.0",)
