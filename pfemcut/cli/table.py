"""The result table that a finished run prints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from pfemcut.units import in_other

if TYPE_CHECKING:
    from pfemcut.results.summary import Summary


def result_lines(summary: Summary) -> list[str]:
    """Return the summary as lines: how the run ended, each figure with its unit, warnings."""
    begin, end = summary.window
    lines = [
        f"{summary.title}: {summary.ending}",
        f"{summary.steps} steps, {summary.travel:.4g} mm of travel, {summary.wall_time:.0f} s; "
        f"means over {begin:.3g} to {end:.3g} mm, {'steady' if summary.steady else 'not steady'}",
        *(f"  {name:<24} {figure_in_column(figure)}" for name, figure in summary.figures.items()),
    ]
    return [*lines, *(f"warning: {text}" for text in summary.warnings)]


def figure_in_column(figure: Mapping[str, float | str]) -> str:
    """Return a figure of the summary as text in a column."""
    unit = "" if figure["unit"] in ("-", "1") else f" {figure['unit']}"
    value = float(figure["mean"] if "mean" in figure else figure["value"])
    other = in_other(value, str(figure["unit"]))
    also = f" = {other[0]:.4g} {other[1]}" if other else ""
    if "mean" not in figure:
        return f"{value:>10.4g}{unit}{also}"
    return f"{value:>10.4g} +- {figure['std']:.2g}{unit}{also}"
