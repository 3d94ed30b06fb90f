"""What a sweep shows: how its runs go on while a user waits, and the plot."""

from __future__ import annotations

import json
from io import StringIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pfemcut.problem.course import straight
from pfemcut.results.history import CORE_COLUMNS
from pfemcut.sweep.display import Bars, Lines, last_measures
from pfemcut.sweep.plot import draw, grouped
from pfemcut.sweep.results import Outcome

# What a waiting user sees


def test_a_history_that_is_being_written_shows_its_last_whole_row(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    assert last_measures(path) is None
    header = ",".join([*CORE_COLUMNS, "own"]) + "\n"
    path.write_text(header)
    assert last_measures(path) is None
    rows = [",".join([str(step), *["0.125"] * (len(CORE_COLUMNS) - 2), "9", "7"]) for step in range(1, 300)]
    path.write_text(header + "\n".join(rows))  # no line break at the end: a row that is not whole
    measures = last_measures(path)
    assert measures is not None
    assert (measures.step, measures.cutting_force, measures.nodes) == (298, 0.125, 9)


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [StringIO(), Terminal()])
def test_each_variant_that_ended_gets_a_line(tmp_path: Path, stream: StringIO) -> None:
    course = straight(1.0)
    variants: Any = [
        SimpleNamespace(name=name, directory=tmp_path / name, course=course) for name in ("a", "b")
    ]
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "run.log").write_text("fine\nout of memory\n\n")
    (tmp_path / "a").mkdir()
    summary = {"cutting_force": {"mean": 151.25, "std": 1.0, "unit": "N/mm"}}
    (tmp_path / "a" / "summary.json").write_text(json.dumps(summary))
    with (Bars if stream.isatty() else Lines)(variants, stream) as shown:
        for name, code in (("a", 0), ("b", -9)):
            shown.started(name)
            shown.passing([name])
            shown.ended(name, code)
    text = " ".join(stream.getvalue().split())
    assert "[1/2] a: finished Fc 151.2 N/mm, 0:00:00" in text
    assert "failed with status -9" in text
    assert "out of memory" in text
    assert ("\x1b" in text) == stream.isatty()


# The plot


def outcome(force: float, **parameters: Any) -> Outcome:
    summary = {"cutting_force": {"mean": force, "std": 1.0}, "steady": {"value": force > 2.0}}
    variant: Any = SimpleNamespace(parameters=parameters)
    return Outcome(variant, "finished", summary)


def test_lines_of_the_plot_are_the_values_that_the_first_parameter_does_not_explain() -> None:
    zipped = [outcome(1.0, a=i, b=2 * i, c=c) for i in range(3) for c in ("x", "y")]
    lines = grouped(zipped, "a", ["b", "c"])
    assert {label: len(members) for label, members in lines.items()} == {"c = x": 3, "c = y": 3}
    assert list(grouped(zipped[::2], "a", ["b", "c"])) == [""]


def test_the_plot_has_a_panel_a_figure_with_means_and_deviations() -> None:
    outcomes = [outcome(10.0 * b + a, **{"cutting.speed": a, "b": b}) for a in (3, 1, 2) for b in (0, 1)]
    figure = draw(outcomes, ["cutting_force"], ["cutting.speed", "b"], {"cutting.speed": "mm/s"})
    (axes,) = figure.axes
    assert axes.get_title() == "Cutting force (N/mm)"
    assert axes.get_xlabel() == "cutting.speed (mm/s)"
    drawn = [container.lines[0].get_xydata().tolist() for container in axes.containers]
    assert drawn == [[[1, 1], [2, 2], [3, 3]], [[1, 11], [2, 12], [3, 13]]]
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words[:2] == ["b = 0", "b = 1"]
    assert "open: not steady" in words


def test_the_plot_of_names_has_them_as_ticks() -> None:
    outcomes = [outcome(5.0, material=name) for name in ("steel", "titanium")]
    (axes,) = draw(outcomes, ["cutting_force"], ["material"], {}).axes
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["steel", "titanium"]
