"""Published figures beside computed ones: clear errors in the file, right verdicts, nothing lost in the JSON."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
from rich.console import Console

from pfemcut.inputs import InputError
from pfemcut.results.published import (
    Verdict,
    compare,
    comparison_json,
    load_published,
    print_comparison,
)
from pfemcut.whole_files import write_json

PUBLISHED = """\
[max_temperature]
value = 810
unit = "K"
tolerance = 25.0
source = "a paper"

[chip_thickness]
value = 0.25
unit = "mm"
source = "a paper"
"""
FIGURES = {
    "cutting_force": {"mean": 170.0, "std": 3.0, "unit": "N/mm"},
    "chip_thickness": {"mean": 0.2, "std": 0.01, "unit": "mm"},
    "max_temperature": {"mean": 834.0, "std": 2.0, "unit": "K"},
    "peak_strain_rate": {"mean": 1e6, "std": 1.0, "unit": "1/s"},
}
DEMOS = sorted((Path(__file__).parent.parent / "demos").glob("*/published.toml"))


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "published.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_rows_hold_published_figures_and_the_main_computed_ones(tmp_path: Path) -> None:
    rows = {row.name: row for row in compare(load_published(written(tmp_path, PUBLISHED)), FIGURES)}
    assert list(rows) == ["cutting_force", "chip_thickness", "max_temperature"]
    assert rows["chip_thickness"].difference == pytest.approx(-0.2)
    assert rows["chip_thickness"].verdict is Verdict.NO_TARGET
    assert rows["cutting_force"].published is None
    assert rows["cutting_force"].verdict is Verdict.NO_TARGET
    assert (rows["max_temperature"].computed, rows["max_temperature"].std) == (834.0, 2.0)


@pytest.mark.parametrize(
    ("computed", "verdict", "failed"),
    [(785.0, Verdict.WITHIN, False), (836.0, Verdict.OUTSIDE, True), (None, Verdict.NOT_COMPUTED, True)],
)
def test_verdict_of_a_figure_with_a_tolerance(
    tmp_path: Path, computed: float | None, verdict: Verdict, failed: bool
) -> None:
    figures = {} if computed is None else {"max_temperature": {"mean": computed, "std": 0.0, "unit": "K"}}
    row = compare(load_published(written(tmp_path, PUBLISHED)), figures)[-1]
    assert (row.name, row.verdict, row.failed) == ("max_temperature", verdict, failed)


def test_a_figure_without_tolerance_that_is_not_computed_does_not_fail(tmp_path: Path) -> None:
    row = compare(load_published(written(tmp_path, PUBLISHED)), {})[0]
    assert (row.name, row.verdict, row.failed) == ("chip_thickness", Verdict.NOT_COMPUTED, False)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("[max_temperature]", "[max_temprature]"), "unknown figure; did you mean 'max_temperature'?"),
        (("tolerance = 25.0", "tolerance = -1"), "[max_temperature] tolerance: given -1"),
        (('unit = "K"', 'unit = "C"'), "[max_temperature] unit: given 'C', must be 'K'"),
        (("value = 810", "valu = 810"), "[max_temperature] value: missing"),
        (('source = "a paper"\n\n', "\n"), "[max_temperature] source: missing"),
        (("value = 810", "value = 'hot'"), "[max_temperature] value: given 'hot', must be a number"),
        (("[max_temperature]", "max_temperature = 3\n[contact_length]"), "must be a table"),
        (("value = 810", "value = "), "TOML syntax error"),
    ],
)
def test_mistakes_in_the_file_are_named(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    path = written(tmp_path, PUBLISHED.replace(*change, 1))
    with pytest.raises(InputError) as caught:
        load_published(path)
    assert any(message in problem for problem in caught.value.problems), caught.value.problems
    assert all(str(path) in problem for problem in caught.value.problems)


def test_comparison_is_printed_and_written(tmp_path: Path) -> None:
    rows = compare(load_published(written(tmp_path, PUBLISHED)), FIGURES)
    text = io.StringIO()
    print_comparison("a cut", rows, Console(file=text, width=160))
    line = next(line for line in text.getvalue().splitlines() if "Maximum temperature" in line)
    assert all(part in line for part in ("810 ± 25 K", "834 ± 2 K", "+3.0%", "within tolerance"))

    write_json(tmp_path / "comparison.json", comparison_json(rows))
    stored = json.loads((tmp_path / "comparison.json").read_text(encoding="utf-8"))
    assert stored[-1]["source"] == "a paper"
    assert stored[-1]["verdict"] == "within tolerance"


@pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.parent.name)
def test_published_figures_of_the_demos_are_valid(path: Path) -> None:
    load_published(path)


def test_targets_of_the_published_cut_are_those_agreed() -> None:
    figures = load_published(DEMOS[0].parent.parent / "aisi4340_rake0" / "published.toml")
    targets = {name: (item.value, item.tolerance) for name, item in figures.items() if item.tolerance}
    assert targets == {"max_temperature": (810.0, 25.0), "contact_end_temperature": (760.0, 30.0)}
