"""The plot of a sweep: main figures against the first parameter, a line for each value of the others."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pfemcut.output.picture_files import write_picture
from pfemcut.results.definitions import FIGURES
from pfemcut.sweep.plan import Plan, short_keys, value_text
from pfemcut.sweep.results import Outcome

PNG = "results.png"
COLUMNS = 3
LOGARITHMIC_FROM = 30.0
"""A parameter that spans more than this ratio has a logarithmic axis."""


def write_plot(plan: Plan, outcomes: Sequence[Outcome], units: Mapping[str, str]) -> list[Path]:
    """Write the plot into the sweep's folder; its path, or nothing if no finished run has a figure to plot.

    Parameters
    ----------
    plan
        The sweep.
    outcomes
        Its outcomes; those that are not finished are left out.
    units
        Units of the parameters, as far as they are known.
    """
    finished = [each for each in outcomes if each.finished]
    names = [name for name in plan.figures if any(math.isfinite(each.mean(name)) for each in finished)]
    if not names:
        return []
    figure = draw(finished, names, plan.keys, units)
    path = plan.output / PNG
    write_picture(path, figure)
    return [path]


def draw(
    outcomes: Sequence[Outcome], names: Sequence[str], keys: Sequence[str], units: Mapping[str, str]
) -> Figure:
    """The picture of the figures ``names`` against the first of the parameters ``keys``."""
    definitions = {item.name: item for item in FIGURES}
    first, *others = keys
    numeric = all(_is_number(each.variant.parameters[first]) for each in outcomes)
    lines = grouped(outcomes, first, others)
    columns = 2 if len(names) == 4 else min(COLUMNS, len(names))
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(3.6 * columns + 0.4, 2.9 * rows + 0.6), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
    colours = _colours(len(lines))
    ticks = list(dict.fromkeys(value_text(each.variant.parameters[first]) for each in outcomes))

    def place(outcome: Outcome) -> float:
        value = outcome.variant.parameters[first]
        return float(value) if numeric else float(ticks.index(value_text(value)))

    # Lines through names would mean nothing: there the values of a name stand side by side.
    shifts = np.zeros(len(lines)) if numeric else (np.arange(len(lines)) + 0.5) / len(lines) - 0.5
    for axes, name in zip(panels, names, strict=False):
        for members, colour, shift in zip(lines.values(), colours, 0.6 * shifts, strict=True):
            ordered = sorted(members, key=place)
            at = [place(each) + float(shift) for each in ordered]
            _draw_line(axes, ordered, at, name, colour, joined=numeric)
        unit = definitions[name].unit
        axes.set_title(definitions[name].label + ("" if unit == "-" else f" ({unit})"), fontsize="medium")
        axes.grid(alpha=0.3)
        _scale(axes, [place(each) for each in outcomes], numeric=numeric)
        if not numeric:
            axes.set_xticks(range(len(ticks)), ticks, rotation=20.0)
            axes.set_xlim(-0.5, len(ticks) - 0.5)
    for index, axes in enumerate(panels):
        axes.set_visible(index < len(names))
        if index + columns >= len(names):
            axes.set_xlabel(first + (f" ({units[first]})" if units.get(first) else ""))
            axes.tick_params(labelbottom=True)
    _legend(figure, list(lines), colours, any(not each.steady for each in outcomes))
    return figure


def grouped(outcomes: Sequence[Outcome], first: str, others: Sequence[str]) -> dict[str, list[Outcome]]:
    """The outcomes of each line by its label, which names the other parameters.

    A parameter whose value follows from those before it (one that goes together with the first) makes no lines.
    """
    kept: list[str] = []
    for key in others:
        seen: dict[tuple[str, ...], str] = {}
        for each in outcomes:
            values = each.variant.parameters
            before = tuple(value_text(values[name]) for name in (first, *kept))
            if seen.setdefault(before, value_text(values[key])) != value_text(values[key]):
                kept.append(key)
                break
    short = short_keys({first, *others})
    lines: dict[str, list[Outcome]] = {}
    for each in outcomes:
        values = each.variant.parameters
        label = ", ".join(f"{short[key]} = {value_text(values[key])}" for key in kept)
        lines.setdefault(label, []).append(each)
    return lines


def _draw_line(
    axes: Axes, members: Sequence[Outcome], at: Sequence[float], name: str, colour: Any, *, joined: bool
) -> None:
    known = [
        (each, across) for each, across in zip(members, at, strict=True) if math.isfinite(each.mean(name))
    ]
    if not known:
        return
    shown, x = zip(*known, strict=True)
    y = [each.mean(name) for each in shown]
    spread = [each.std(name) if math.isfinite(each.std(name)) else 0.0 for each in shown]
    axes.errorbar(
        x, y, yerr=spread, color=colour, linewidth=1.2, capsize=2.5, linestyle="-" if joined else "none"
    )
    for each, across, up in zip(shown, x, y, strict=True):
        axes.plot(
            across, up, "o", color=colour, markersize=5, markerfacecolor=colour if each.steady else "white"
        )


def _scale(axes: Axes, places: Sequence[float], *, numeric: bool) -> None:
    if numeric and min(places) > 0.0 and max(places) / min(places) > LOGARITHMIC_FROM:
        axes.set_xscale("log")
    axes.margins(y=0.12)


def _legend(figure: Figure, labels: Sequence[str], colours: Sequence[Any], unsteady: bool) -> None:
    handles = [
        Line2D([], [], color=colour, marker="o", label=label)
        for label, colour in zip(labels, colours, strict=True)
        if label
    ]
    bars = "bars: standard deviation over the window"
    handles.append(Line2D([], [], color="0.4", marker="|", linestyle="none", label=bars))
    if unsteady:
        handles.append(
            Line2D(
                [],
                [],
                color="0.4",
                marker="o",
                markerfacecolor="white",
                linestyle="none",
                label="open: not steady",
            )
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4), fontsize="small")


def _colours(count: int) -> list[Any]:
    """Colours that follow the order of the lines."""
    if count <= 10:
        return [f"C{index}" for index in range(count)]
    scale = matplotlib.colormaps["viridis"]
    return [scale(index / (count - 1)) for index in range(count)]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
