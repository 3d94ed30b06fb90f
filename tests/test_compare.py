"""Comparisons of runs with runs, published tables and measurements, on folders that hold only the shared outputs."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pfemcut.cli.main import status
from pfemcut.compare.plot import draw
from pfemcut.compare.sources import labels_of, read_sources
from pfemcut.compare.table import (
    Difference,
    Verdict,
    chosen_figures,
    compared,
    difference_text,
    entry_text,
    markdown,
)
from pfemcut.inputs import InputError
from pfemcut.results.measured import load_measured

FORCE = {"mean": 100.0, "std": 3.0, "unit": "N/mm"}
OTHER = {"mean": 110.0, "std": 4.0, "unit": "N/mm"}


def run_in(
    folder: Path, *, speed: float | None = None, level: float = 100.0, **figures: Mapping[str, Any]
) -> Path:
    """A folder as any method leaves it: summary and history."""
    folder.mkdir(parents=True)
    content = {**figures, "steady": {"value": True, "unit": "-"}, "warnings": [], "finished": True}
    (folder / "summary.json").write_text(json.dumps(content), encoding="utf-8")
    rows = "".join(f"{0.01 * i},{level},{0.3 * level}\n" for i in range(61))
    (folder / "history.csv").write_text("travel,cutting_force,thrust_force\n" + rows, encoding="utf-8")
    if speed is not None:
        (folder / "inputs.resolved.toml").write_text(f"[cutting]\nspeed = {speed}\n", encoding="utf-8")
    return folder


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_differences_are_relative_to_the_reference_and_to_the_combined_scatter(tmp_path: Path) -> None:
    one, two = run_in(tmp_path / "one", cutting_force=FORCE), run_in(tmp_path / "two", cutting_force=OTHER)
    sources = read_sources([one, two])
    (row,) = compared(sources, 0, ["cutting_force"]).rows
    difference = row.differences[1]
    assert row.differences[0] is None
    assert difference is not None
    # 10 N/mm, and a scatter of 5 by Pythagoras.
    assert difference.relative == pytest.approx(0.1, rel=1e-12)
    assert difference.deviations == pytest.approx(2.0, rel=1e-12)
    assert difference.verdict is Verdict.SIGNIFICANT
    (back,) = compared(sources, 1, ["cutting_force"]).rows
    assert back.differences[0] is not None
    assert back.differences[0].relative == pytest.approx(-10.0 / 110.0, rel=1e-12)


def test_a_difference_within_the_scatter_is_called_so_and_one_without_scatter_is_not_judged(
    tmp_path: Path,
) -> None:
    near = {"mean": 104.0, "std": 3.0, "unit": "N/mm"}
    drift, other = {"value": 1e-3, "unit": "-"}, {"value": 0.0, "unit": "-"}
    sources = read_sources(
        [
            run_in(tmp_path / "one", cutting_force=FORCE, area_drift=other),
            run_in(tmp_path / "two", cutting_force=near, area_drift=drift),
        ]
    )
    force, area = compared(sources, 0, ["cutting_force", "area_drift"]).rows
    assert force.differences[1] is not None and force.differences[1].verdict is Verdict.SCATTER
    # Nothing is relative to zero, and no deviation is known.
    assert area.differences[1] is not None
    assert math.isnan(area.differences[1].relative) and math.isnan(area.differences[1].deviations)
    assert difference_text(area.differences[1]) == "–"


def test_a_figure_that_a_method_does_not_know_is_a_dash_and_one_that_only_it_knows_is_shown(
    tmp_path: Path,
) -> None:
    sources = read_sources(
        [
            run_in(
                tmp_path / "pfem", cutting_force=FORCE, chip_thickness={"mean": 0.2, "std": 0.1, "unit": "mm"}
            ),
            run_in(tmp_path / "sph", cutting_force=OTHER, neighbours={"value": 21.0, "unit": "-"}),
        ]
    )
    rows = {row.name: row for row in compared(sources, 0, chosen_figures(sources, ["all"], ())).rows}
    assert set(rows) == {"cutting_force", "chip_thickness", "neighbours"}
    assert [entry_text(entry) for entry in rows["chip_thickness"].entries] == ["0.2 ± 0.1", "–"]
    assert [entry_text(entry) for entry in rows["neighbours"].entries] == ["–", "21"]
    assert rows["neighbours"].differences == (None, None)


def test_published_tolerances_decide_and_a_single_run_is_taken_relative_to_the_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = run_in(
        tmp_path / "run", cutting_force=FORCE, max_temperature={"mean": 850.0, "std": 1.0, "unit": "K"}
    )
    table = written(
        tmp_path / "published.toml",
        '[cutting_force]\nvalue = 80.0\nunit = "N/mm"\nsource = "a"\n'
        '[max_temperature]\nvalue = 810.0\nunit = "K"\ntolerance = 25.0\nsource = "a"\n',
    )
    assert status(["compare", str(run), str(table), "-o", str(tmp_path / "out.csv")]) == 0
    assert "differences from published.toml" in capsys.readouterr().out
    with (tmp_path / "out.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["figure"]: row for row in csv.DictReader(file)}
    assert float(rows["cutting_force"]["run difference"]) == pytest.approx(0.25, rel=1e-12)
    assert rows["cutting_force"]["run verdict"] == ""
    assert rows["max_temperature"]["run verdict"] == "outside tolerance"
    assert status(["compare", str(run), str(table), "--reference", str(run)]) == 0
    assert "differences from run" in capsys.readouterr().out


def test_of_a_measurement_with_several_cuts_that_of_the_run_is_taken(tmp_path: Path) -> None:
    run = run_in(tmp_path / "run", speed=1000.0, cutting_force=FORCE)
    measured = written(
        tmp_path / "measured.csv",
        "# two cuts\nfigure,value,uncertainty,unit,source,cutting.speed\n"
        'cutting_force,90,4,N/mm,"test, 3",1000\n\ncutting_force,80,4,N/mm,test 4,2000\n',
    )
    _, source = read_sources([run, measured])
    assert source.entries["cutting_force"].value == 90.0
    assert source.entries["cutting_force"].spread == 4.0
    assert source.notes == ("other cuts in the file, left out: 1",)
    other = run_in(tmp_path / "other", speed=500.0, cutting_force=FORCE)
    with pytest.raises(InputError, match=r"none of its cuts has the cutting\.speed of"):
        read_sources([other, measured])


def test_a_measured_curve_has_the_means_of_the_steady_window(tmp_path: Path) -> None:
    travel = np.linspace(0.0, 1.0, 201)
    force = np.where(travel < 0.75, 50.0, 90.0)
    text = "travel (mm),cutting_force (N/mm)\n" + "".join(
        f"{x},{y}\n" for x, y in zip(travel, force, strict=True)
    )
    measured = load_measured(written(tmp_path / "curve.csv", text))
    assert measured.curve is not None
    (figure,) = measured.figures
    # The window is the last quarter; its first row stands half for travel before the step.
    assert figure.value == pytest.approx(90.0, abs=0.5)


def test_a_run_without_summary_is_read_from_its_history(tmp_path: Path) -> None:
    going = run_in(tmp_path / "going", level=70.0)
    (going / "summary.json").unlink()
    columns = "step,time,travel,cutting_force,thrust_force\n"
    rows = "".join(f"{i},{i},{0.01 * i},70.0,20.0\n" for i in range(61))
    (going / "history.csv").write_text(columns + rows, encoding="utf-8")
    source, _ = read_sources([going, run_in(tmp_path / "run", cutting_force=FORCE)])
    assert source.entries["cutting_force"].value == pytest.approx(70.0, rel=1e-12)
    assert "no summary" in source.notes[0]


def test_labels_tell_sources_apart(tmp_path: Path) -> None:
    folders = [tmp_path / name / "results" for name in ("a", "b")]
    for folder in folders:
        folder.mkdir(parents=True)
    assert labels_of(folders) == ["a", "b"]
    assert labels_of([folders[0], tmp_path / "published.toml"]) == ["a", "published.toml"]
    deeper = [tmp_path / "x" / "run", tmp_path / "y" / "run"]
    for folder in deeper:
        folder.mkdir(parents=True)
    assert labels_of(deeper) == ["x", "y"]
    assert labels_of([deeper[0], folders[0]]) == ["run", "results"]


def test_table_and_picture_are_written_and_look_as_they_should(tmp_path: Path) -> None:
    one, two = run_in(tmp_path / "one", cutting_force=FORCE), run_in(tmp_path / "two|b", cutting_force=OTHER)
    assert status(["compare", str(one), str(two), "-o", str(tmp_path / "out")]) == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        f"compare{suffix}" for suffix in (".csv", ".json", ".md", ".png")
    }
    content = json.loads((tmp_path / "out" / "compare.json").read_text(encoding="utf-8"))
    assert content["figures"][0]["differences"][1]["deviations"] == pytest.approx(2.0, rel=1e-12)
    comparison = compared(read_sources([one, two]), 0, ["cutting_force"])
    lines = markdown(comparison).splitlines()
    assert "two\\|b" in lines[0]
    assert lines[2] == "| Cutting force | N/mm | 100 ± 3 | 110 ± 4<br>+10.0 %, 2.0 std: differs |"
    curves, bars = draw(comparison).axes
    # Two forces of two runs against travel; two bars.
    assert [len(line.get_xdata()) for line in curves.lines] == [61] * 4
    assert [bar.get_height() for bar in bars.patches] == [100.0, 110.0]


def test_names_that_look_like_markup_or_formulas_are_shown_as_they_are(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, two = (
        run_in(tmp_path / "[red]a", cutting_force=FORCE),
        run_in(tmp_path / "_b$c$", cutting_force=OTHER),
    )
    assert status(["compare", str(one), str(two), "-o", str(tmp_path / "out.png")]) == 0
    out = capsys.readouterr().out
    assert "[red]a" in out and "_b$c$" in out
    (legend,) = draw(compared(read_sources([one, two]), 0, ["cutting_force"])).legends
    assert [text.get_text() for text in legend.get_texts()] == ["[red]a", "\u200b_b\\$c\\$"]


def test_difference_texts() -> None:
    assert difference_text(None) == "–"
    assert difference_text(Difference(0.01234, 500.0, Verdict.SIGNIFICANT)) == "+1.2 %, > 100 std: differs"
    assert difference_text(Difference(-0.5, math.nan, Verdict.WITHIN)) == "-50.0 %: within tolerance"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        (
            "m.csv",
            "figure,value,unit\ncutting_force,1,kN\n",
            "unit of cutting_force: given 'kN', must be 'N/mm'",
        ),
        ("m.csv", "figure,value,unit\ncuting_force,1,N/mm\n", "did you mean 'cutting_force'?"),
        ("m.csv", "figure,value,unit\ncutting_force,nan,N/mm\n", "line 2: value: given 'nan'"),
        ("m.csv", "figure,value\ncutting_force,1\n", "column 'unit' is missing"),
        ("m.csv", "figure,value,unit,uncertaintie\n", "has a header and no values"),
        ("m.csv", "figure,value,unit,uncertaintie\ncutting_force,1,N/mm,1\n", "did you mean 'uncertainty'?"),
        ("m.csv", "figure,value,unit\ncutting_force,1\n", "line 2: has 2 values, the header 3"),
        ("m.csv", "figure,value,unit,uncertainty\ncutting_force,1,N/mm,0\n", "must be greater than 0"),
        ("m.csv", "figure,value,unit\ncutting_force,1,N/mm\ncutting_force,2,N/mm\n", "there twice"),
        ("m.csv", "travel,cutting_force\n0,1\n0.2,1\n0.1,1\n", "line 4: travel must not fall"),
        ("m.csv", "travel (m),cutting_force\n0,1\n", "unit of travel: given 'm', must be 'mm'"),
        ("m.csv", "travel\n0\n", "has no force"),
        ("m.csv", "", "is empty"),
        ("p.toml", "[cutting_force]\nvalue = 1.0\nunit = 'N'\nsource = 'a'\n", "must be 'N/mm'"),
        ("p.txt", "", "must be the folder of a run"),
    ],
)
def test_bad_files_are_named_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, text: str, words: str
) -> None:
    run = run_in(tmp_path / "run", cutting_force=FORCE)
    assert status(["compare", str(run), str(written(tmp_path / name, text))]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.startswith("pfemcut: ") and len(error.splitlines()) == 1


def test_bad_command_lines_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = run_in(tmp_path / "run", cutting_force=FORCE)
    metres = run_in(tmp_path / "metres", cutting_force={"mean": 1.0, "std": 1.0, "unit": "N/m"})
    broken = run_in(tmp_path / "broken")
    (broken / "summary.json").write_text('{"cutting_force": ', encoding="utf-8")
    (tmp_path / "empty").mkdir()
    binary = run_in(tmp_path / "binary", cutting_force=FORCE)
    (binary / "history.csv").write_bytes(b"travel,cutting_force\n\xff\xfe\n")
    headless = run_in(tmp_path / "headless")
    (headless / "summary.json").unlink()
    for options, words in (
        ([run, binary], "can't be read"),
        ([run, headless], "no results here"),
        ([run], "at least two"),
        ([run, run], "is given twice"),
        ([run, tmp_path / "nowhere"], "no such file or folder"),
        ([run, tmp_path / "empty"], "no results here"),
        ([run, metres], "unit of cutting_force: given 'N/m', must be 'N/mm'"),
        ([run, broken], "summary.json: damaged"),
        ([run, metres, "-o", "out.pdf"], "-o: given 'out.pdf'"),
        ([run, broken, "--reference", tmp_path / "other"], "is not compared"),
    ):
        assert status(["compare", *map(str, options)]) == 2
        assert words in capsys.readouterr().err
    other = run_in(tmp_path / "second", cutting_force=FORCE)
    assert status(["compare", str(run), str(other), "--figures", "cuting_force"]) == 2
    assert "did you mean 'cutting_force'?" in capsys.readouterr().err
