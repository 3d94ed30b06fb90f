"""The summary: figures from the window with units, and warnings where they are due."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from pfemcut.results.definitions import FIGURES
from pfemcut.results.summary import Summary, summarise, write_summary

ROWS = 1000


def history(**changes: np.ndarray) -> dict[str, np.ndarray]:
    ones = np.ones(ROWS)
    travel = np.linspace(0.0, 1.0, ROWS + 1)[1:]
    columns = {
        "step": np.arange(1.0, ROWS + 1),
        "travel": travel,
        "cutting_force": np.where(travel < 0.7, 100.0, 200.0),
        "thrust_force": 60.0 * ones,
        "tool_work": np.cumsum(ones),
        "elastic_energy": 2.0 * ones,
        "energy_error": np.linspace(0.5, 0.01, ROWS),
        "chip_thickness": np.where(travel < 0.9, np.nan, 0.2),
        "chip_complete": ones,
        "area_drift": 1e-4 * ones,
    }
    return columns | changes


def summary(**changes: np.ndarray) -> Summary:
    timing = {"step": np.arange(2.0), "momentum": np.array([1.0, 3.0]), "total": np.array([2.0, 4.0])}
    return summarise(history(**changes), timing, title="a", finished=True, ending="done", depth=0.1, rake=0.0)


def test_figures_are_window_means_with_units_and_drifts_are_last_values() -> None:
    figures = summary().to_json()
    assert figures["cutting_force"] == {
        "mean": pytest.approx(200.0),
        "std": pytest.approx(0.0),
        "unit": "N/mm",
    }
    assert figures["chip_thickness"] == {"mean": pytest.approx(0.2), "std": pytest.approx(0.0), "unit": "mm"}
    assert figures["specific_energy"]["mean"] == pytest.approx(2000.0)
    assert figures["apparent_friction"]["mean"] == pytest.approx(0.3)
    assert figures["energy_error"] == {"value": 0.01, "unit": "-"}
    assert figures["area_drift"] == {"value": 1e-4, "unit": "-"}
    assert figures["steady"] == {"value": True, "unit": "-"}
    assert figures["wall_time"] == {"value": 6.0, "unit": "s"}
    assert figures["seconds_per_step"] == {"momentum": 2.0, "total": 3.0}
    assert figures["ledgers"] == {"tool_work": 1000.0, "elastic_energy": 2.0}
    assert "heat_error" not in figures
    assert summary().warnings == ()


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        ({"cutting_force": np.linspace(100.0, 200.0, ROWS)}, "not steady: the cutting force drifts"),
        ({"energy_error": np.full(ROWS, -0.05)}, "energy_error is 5.00%"),
        ({"heat_error": np.full(ROWS, 0.02)}, "heat_error"),
        ({"area_drift": np.full(ROWS, 0.003)}, "area_drift"),
        ({"chip_complete": np.zeros(ROWS)}, "too short"),
    ],
)
def test_what_a_reader_must_know_is_a_warning(changes: dict[str, np.ndarray], warning: str) -> None:
    assert any(warning in text for text in summary(**changes).warnings)


def test_summary_file_is_strict_json_even_when_figures_have_no_value(tmp_path: Path) -> None:
    write_summary(tmp_path / "summary.json", summary(chip_thickness=np.full(ROWS, np.nan)))
    text = (tmp_path / "summary.json").read_text()
    assert "NaN" not in text
    assert "chip_thickness" not in json.loads(text)


def test_an_empty_history_gives_a_summary_too() -> None:
    empty = {name: values[:0] for name, values in history().items()}
    found = summarise(empty, {}, title="a", finished=False, ending="stopped at once")
    assert (found.steps, found.figures, found.steady) == (0, {}, False)


def test_every_figure_has_a_label_a_unit_and_a_definition() -> None:
    assert len({item.name for item in FIGURES}) == len(FIGURES)
    assert all(item.label and item.unit and item.meaning.endswith(".") for item in FIGURES)


def test_a_row_at_the_edge_of_the_window_is_no_short_chip() -> None:
    """One of 250: nobody is told of 0 %."""
    complete = np.ones(ROWS)
    complete[-ROWS // 4 + 1] = 0.0
    assert summary(chip_complete=complete).warnings == ()
