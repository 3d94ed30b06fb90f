"""Wear constants with units, in files and in case files."""

from __future__ import annotations

from pathlib import Path

import pytest

from pfemcut.inputs import InputError
from pfemcut.wear.load import wear_table


def test_wear_files_take_units(tmp_path: Path) -> None:
    plain = {"A": 7.8e-9, "B": 5302.0, "above": {"temperature": 1150.0, "A": 1.198e-2, "B": 21950.0}}
    (tmp_path / "units.toml").write_text(
        'A = "7.8e-3 1/TPa"\nB = "5.302 kK"\n[above]\ntemperature = "876.85 degC"\nA = "11.98 1/GPa"\nB = "21950 K"\n'
    )
    assert wear_table("units.toml", tmp_path) == wear_table(plain, tmp_path)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            {"A": "1e-9 MPa", "B": 1.0},
            "[tool.wear] A: given '1e-9 MPa', which is a stress: must be a value per",
        ),
        ({"A": 1e-9, "B": "5302"}, "[tool.wear] B: given '5302', which has no unit"),
        # A point on a scale: 5302 °C are no 5302 K, and mean nothing here.
        ({"A": 1e-9, "B": "5302 degC"}, "[tool.wear] B: given '5302 degC', must be in K"),
        (
            {"A": 1e-9, "B": 1.0, "above": {"temperature": 1150.0, "A": 1e-9, "B": "20 °C"}},
            "[tool.wear.above] B: given '20 °C', must be in K",
        ),
    ],
)
def test_a_unit_that_does_not_suit_is_one_line(table: dict[str, object], words: str) -> None:
    with pytest.raises(InputError) as error:
        wear_table(table, Path())
    (line,) = error.value.problems
    assert words in line
