"""Measurements with units in their columns, and pictures of more figures than they show."""

from __future__ import annotations

from pathlib import Path

import pytest
from problems import SHORT_CUT
from test_compare import FORCE, run_in, written

from pfemcut.case.load import resolved_toml, validated
from pfemcut.cli.main import status
from pfemcut.compare.plot import draw
from pfemcut.compare.sources import read_sources
from pfemcut.compare.table import chosen_figures, compared
from pfemcut.inputs import InputError
from pfemcut.results.measured import load_measured

ROWS = "cutting_force,90,4,N/mm,{}\ncutting_force,80,4,N/mm,{}\n"


def cut_in(folder: Path) -> Path:
    """A run of the short cut at 3330 mm/s, which are 199.8 m/min."""
    run = run_in(folder, cutting_force=FORCE)
    (run / "inputs.resolved.toml").write_text(resolved_toml(*validated(SHORT_CUT, folder)), encoding="utf-8")
    return run


@pytest.mark.parametrize(
    ("column", "one", "other"),
    [
        ("cutting.speed", "1000", "3330"),
        ("cutting.speed", "60 m/min", "199.8 m/min"),
        ("cutting.speed (m/min)", "60", "199.8"),
        ("cutting.speed [m/s]", "1", "3.33"),
        ("tool.rake (deg)", "5", "0"),
        ("workpiece.material", "42cd4", "aisi4340"),
    ],
)
def test_the_cut_of_the_run_is_found_in_any_unit(tmp_path: Path, column: str, one: str, other: str) -> None:
    header = f"figure,value,uncertainty,unit,{column}\n"
    measured = written(tmp_path / "measured.csv", header + ROWS.format(one, other))
    _, source = read_sources([cut_in(tmp_path / "run"), measured])
    assert source.entries["cutting_force"].value == 80.0


@pytest.mark.parametrize(
    ("column", "cell", "words"),
    [
        ("cutting.speed (mm)", "3", "speed: given '3 mm', which is a length: must be a speed"),
        ("cutting.speed", "3 m/mim", "unknown unit 'mim'"),
        ("cutting.sped (m/min)", "3", "unknown key; did you mean 'speed'?"),
    ],
)
def test_a_unit_that_does_not_suit_is_refused_in_one_line(
    tmp_path: Path, column: str, cell: str, words: str
) -> None:
    text = f"figure,value,uncertainty,unit,{column}\ncutting_force,90,4,N/mm,{cell}\n"
    measured = written(tmp_path / "measured.csv", text)
    with pytest.raises(InputError) as refused:
        read_sources([cut_in(tmp_path / "run"), measured])
    (line,) = refused.value.problems
    assert line.startswith(f"{measured}: ")
    assert words in line


def test_columns_are_named_once_and_figures_have_a_column_of_units(tmp_path: Path) -> None:
    doubled = written(tmp_path / "curve.csv", "travel,cutting_force,cutting_force (N/mm)\n0,1,1\n1,2,2\n")
    with pytest.raises(InputError, match="column 'cutting_force' is there twice"):
        load_measured(doubled)
    headed = written(tmp_path / "figures.csv", "figure,value (N/mm),unit\ncutting_force,1,N/mm\n")
    with pytest.raises(InputError, match="units stand in the column 'unit'"):
        load_measured(headed)


def test_a_picture_says_how_many_figures_it_leaves_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = run_in(tmp_path / "one", **{f"figure_{index}": FORCE for index in range(14)})
    two = run_in(tmp_path / "two", **{f"figure_{index}": FORCE for index in range(14)})
    sources = read_sources([one, two])
    comparison = compared(sources, 0, chosen_figures(sources, ["all"], ()))
    text = "bars of the first 12 figures; the table has 2 more"
    assert draw(comparison).get_suptitle() == text
    few = compared(sources, 0, [f"figure_{index}" for index in range(12)])
    assert draw(few).get_suptitle() == ""
    command = ["compare", str(one), str(two), "--figures", "all", "-o"]
    assert status([*command, str(tmp_path / "out.png")]) == 0
    assert text in capsys.readouterr().out
    assert status([*command, str(tmp_path / "out.md")]) == 0
    assert text not in capsys.readouterr().out
