"""The picture of a comparison: forces against travel of all sources, and their figures as bars."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pfemcut.compare.sources import Kind, Source
from pfemcut.compare.table import Comparison, Row
from pfemcut.output.picture_files import write_picture
from pfemcut.results.measured import FORCES
from pfemcut.results.published import KNOWN

COLUMNS = 4
LINES = {"cutting_force": "-", "thrust_force": "--"}
TITLE_WIDTH = 26
LARGEST = 12
"""Bars of so many figures at most: the first ones. The picture says how many are left out."""


def write_plot(path: Path, comparison: Comparison) -> None:
    """Write the picture as PNG, at once."""
    write_picture(path, draw(comparison))


def draw(comparison: Comparison) -> Figure:
    """The picture."""
    sources, rows = comparison.sources, comparison.rows[:LARGEST]
    curves = any(source.curve is not None for source in sources)
    columns = min(COLUMNS, max(len(rows), 1))
    lines = -(-len(rows) // columns)
    heights = ([3.2] if curves else []) + [1.9] * lines
    figure = Figure(figsize=(9.0, sum(heights) + 0.7), layout="constrained")
    grid = figure.add_gridspec(len(heights), columns, height_ratios=heights)
    colours = _colours(len(sources))
    if curves:
        _draw_curves(figure.add_subplot(grid[0, :]), sources, colours)
    for index, row in enumerate(rows):
        at = index // columns + (1 if curves else 0)
        _draw_bars(figure.add_subplot(grid[at, index % columns]), row, sources, colours)
    handles = [
        Line2D([], [], color=colour, linewidth=5, label=plain(source.label))
        for source, colour in zip(sources, colours, strict=True)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4), fontsize="small")
    if left_out := left_out_of(comparison):
        figure.suptitle(left_out, fontsize="small", color="0.4", x=0.99, ha="right")
    return figure


def left_out_of(comparison: Comparison) -> str:
    """What the picture does not show, in words; nothing if it shows all figures."""
    count = len(comparison.rows) - LARGEST
    return f"bars of the first {LARGEST} figures; the table has {count} more" if count > 0 else ""


def _draw_curves(axes: Axes, sources: Sequence[Source], colours: Sequence[Any]) -> None:
    for source, colour in zip(sources, colours, strict=True):
        if source.curve is None:
            _draw_levels(axes, source, colour)
            continue
        for name, values in source.curve.forces.items():
            width = 1.1 if source.kind is Kind.RUN else 2.0
            axes.plot(source.curve.travel, values, LINES[name], color=colour, linewidth=width)
    handles = [Line2D([], [], color="0.3", linestyle=LINES[name], label=KNOWN[name].label) for name in FORCES]
    axes.legend(handles=handles, fontsize="small", loc="lower right")
    axes.set_xlabel("Travel (mm)")
    axes.set_ylabel("Force (N/mm)")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.grid(alpha=0.3)


def _draw_levels(axes: Axes, source: Source, colour: Any) -> None:
    """Forces without a curve, such as published ones, as level lines with their spread."""
    for name in FORCES:
        if (entry := source.entries.get(name)) is None:
            continue
        axes.axhline(entry.value, color=colour, linestyle=LINES[name], linewidth=1.6)
        if math.isfinite(entry.spread):
            axes.axhspan(
                entry.value - entry.spread,
                entry.value + entry.spread,
                color=colour,
                alpha=0.15,
                linewidth=0.0,
            )


def _draw_bars(axes: Axes, row: Row, sources: Sequence[Source], colours: Sequence[Any]) -> None:
    for index, (entry, colour) in enumerate(zip(row.entries, colours, strict=True)):
        if entry is None:
            axes.text(index, 0.0, "–", ha="center", va="bottom", color="0.4", fontsize="large")
            continue
        hatch = "" if sources[index].kind is Kind.RUN else "//"
        axes.bar(index, entry.value, 0.8, color=colour, hatch=hatch, edgecolor="white", linewidth=0.0)
        if math.isfinite(entry.spread):
            axes.errorbar(index, entry.value, entry.spread, color="black", capsize=3, linewidth=1.0)
    title = row.label + ("" if row.unit == "-" else f" ({row.unit})")
    axes.set_title(textwrap.fill(title, TITLE_WIDTH), fontsize="small")
    axes.set_xticks([])
    axes.set_xlim(-0.6, len(sources) - 0.4)
    axes.axhline(0.0, color="0.3", linewidth=0.6)
    axes.tick_params(labelsize="small")
    axes.grid(axis="y", alpha=0.3)
    axes.set_axisbelow(True)


def plain(text: str) -> str:
    """``text`` as it stands, for matplotlib: no formula between dollars, and in a legend though it begins with _."""
    return ("\u200b" if text.startswith("_") else "") + text.replace("$", r"\$")


def _colours(count: int) -> list[Any]:
    if count <= 10:
        return [f"C{index}" for index in range(count)]
    scale = matplotlib.colormaps["viridis"]
    return [scale(index / (count - 1)) for index in range(count)]
