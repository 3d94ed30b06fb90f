"""The picture of a convergence study: each figure against the relative size, with its extrapolated value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pfemcut.converge.order import LARGEST_ORDER, Behaviour
from pfemcut.converge.results import behaviour_text
from pfemcut.converge.study import Finding, Refined
from pfemcut.output.picture_files import write_picture
from pfemcut.results.definitions import FIGURES
from pfemcut.sweep.plot import COLUMNS

PNG = "convergence.png"


def write_plot(study: Refined, found: Sequence[Finding]) -> list[Path]:
    """Write the picture into the study's folder; its path, or nothing if there is nothing to draw."""
    names = [
        name
        for name in study.plan.figures
        if any(each.figure == name and np.isfinite(each.values).any() for each in found)
    ]
    if not names:
        return []
    path = study.plan.output / PNG
    write_picture(path, draw(study, names, found))
    return [path]


def draw(study: Refined, names: Sequence[str], found: Sequence[Finding]) -> Figure:
    """The picture of the figures ``names``."""
    items = {item.name: item for item in FIGURES}
    columns = min(COLUMNS, len(names))
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(3.8 * columns, 3.2 * rows + 0.5), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    factors = {ladder.name: ladder.factors for ladder in study.ladders}
    colours = {ladder.name: f"C{index}" for index, ladder in enumerate(study.ladders)}
    for axes in panels[len(names) :]:
        axes.set_visible(False)
    for axes, name in zip(panels, names, strict=False):
        shown = [each for each in found if each.figure == name]
        for each in shown:
            _draw_finding(axes, each, np.array(factors[each.ladder]), study.ratio, colours[each.ladder])
        unit = items[name].unit
        said = [f"{each.ladder}: {_short(each)}" for each in shown]
        axes.set_title(items[name].label + ("" if unit == "-" else f" ({unit})"), fontsize="medium")
        axes.set_xlabel("Size relative to the case's\n" + "\n".join(said), fontsize="small")
        axes.set_xlim(left=0.0)
        axes.margins(y=0.12)
        axes.grid(alpha=0.3)
    handles = [
        Line2D([], [], color=colours[ladder.name], marker="o", label=ladder.name) for ladder in study.ladders
    ]
    bars = "bars: standard deviation over the window"
    handles.append(Line2D([], [], color="0.4", marker="|", linestyle="none", label=bars))
    limit = "extrapolated, bar: grid convergence index"
    handles.append(Line2D([], [], color="0.4", marker="D", markersize=4, linestyle=":", label=limit))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), fontsize="small")
    return figure


def _draw_finding(axes: Axes, finding: Finding, factors: np.ndarray, ratio: float, colour: str) -> None:
    values, said = np.array(finding.values), finding.convergence
    spread = np.nan_to_num(np.array(finding.deviations))
    axes.errorbar(factors, values, spread, color=colour, marker="o", markersize=4, linewidth=1.2, capsize=2.5)
    if not math.isfinite(said.extrapolated):
        return
    order = min(said.order, LARGEST_ORDER)
    fine = factors[-1]
    x = np.linspace(0.0, fine, 40)
    curve = said.extrapolated + (values[-1] - said.extrapolated) * (x / fine) ** order
    axes.plot(x, curve, ":", color=colour, linewidth=1.2)
    reach = said.index * abs(values[-1])
    axes.errorbar(
        0.0, said.extrapolated, reach, color=colour, marker="D", markersize=4, capsize=2.5, clip_on=False
    )


def _short(finding: Finding) -> str:
    said = finding.convergence
    if said.behaviour is not Behaviour.MONOTONE:
        return behaviour_text(finding)
    return f"order {said.order:.2f}, index {said.index:.2%}"
