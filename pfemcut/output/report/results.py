"""Rows of the result table: each figure with its scatter and its trend over the steady window, and its definition."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.output.report.text import converted, significant, spoken, with_scatter
from pfemcut.results.definition import Taken
from pfemcut.results.definitions import FIGURES
from pfemcut.results.derived.steady_window import SteadyWindow
from pfemcut.results.summary import (
    LARGEST_AREA_DRIFT,
    LARGEST_ENERGY_ERROR,
    LARGEST_HEAT_ERROR,
    figure_mean,
    figure_std,
)

Array = NDArray[np.float64]

LIMITS = {
    "energy_error": LARGEST_ENERGY_ERROR,
    "heat_error": LARGEST_HEAT_ERROR,
    "area_drift": LARGEST_AREA_DRIFT,
}
"""Limits of the checks above which a summary warns."""

HEADLINES = (
    "cutting_force",
    "thrust_force",
    "chip_thickness",
    "contact_length",
    "shear_angle",
    "max_temperature",
)
"""Figures that stand at the top of the page."""


@dataclass(frozen=True)
class ResultRow:
    """One figure as text: mean, scatter, change over the window, unit, mean in a common unit, definition."""

    name: str
    label: str
    value: str
    scatter: str
    change: str
    unit: str
    other: str
    meaning: str


@dataclass(frozen=True)
class CheckRow:
    """One check of the run: its value, the limit above which it warns, and whether it is within."""

    label: str
    value: str
    limit: str
    fine: bool
    meaning: str


def result_rows(
    summary: Mapping[str, Any], history: Mapping[str, Array], window: SteadyWindow
) -> list[ResultRow]:
    """Return the figures that are means over the window, in the order of their definitions."""
    rows = []
    for item in FIGURES:
        figure = summary.get(item.name, {})
        if item.taken is Taken.LAST or not figure:
            continue
        mean, std = figure_mean(summary, item.name), figure_std(summary, item.name)
        value, scatter = with_scatter(mean, std)
        averaged = "std" in figure
        change = trend(history["travel"], history[item.name], window) if item.name in history else math.nan
        rows.append(
            ResultRow(
                item.name,
                item.label,
                value,
                f"± {scatter}" if averaged else "",
                _signed(change) if averaged else "",
                spoken(item.unit),
                converted(float(value), item.unit, 4),
                item.meaning,
            )
        )
    return rows


def check_rows(summary: Mapping[str, Any]) -> list[CheckRow]:
    """Return the figures that say whether the run can be trusted."""
    rows = []
    for item in FIGURES:
        if item.taken is Taken.LAST and item.name in summary:
            value, limit = float(summary[item.name]["value"]), LIMITS.get(item.name, math.inf)
            shown = f"{limit:.1%}" if math.isfinite(limit) else ""
            rows.append(CheckRow(item.label, f"{value:.1e}", shown, abs(value) <= limit, item.meaning))
    return rows


def trend(travel: Array, values: Array, window: SteadyWindow) -> float:
    """Return the change of the straight line fitted to a history column over the window; nan of too few rows.

    Parameters
    ----------
    travel, values
        Columns of the history; shape (rows,).
    window
        The steady window, of the same history.
    """
    use = (window.weights > 0.0) & np.isfinite(values)
    if np.count_nonzero(use) < 3:
        return math.nan
    weights = window.weights[use] / window.weights[use].sum()
    centred = travel[use] - weights @ travel[use]
    slope = float(weights @ (centred * (values[use] - window.mean(values))) / (weights @ centred**2))
    return slope * (window.end - window.begin)


def _signed(change: float) -> str:
    if not math.isfinite(change) or change == 0.0:
        return ""
    return ("+" if change > 0.0 else "−") + significant(abs(change), 2)
