"""The picture of a calibration: measured figures beside the fitted ones, and the parameters between their bounds."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pfemcut.calibrate.cuts import target_names
from pfemcut.calibrate.study import Calibration, Found
from pfemcut.output.picture_files import write_picture

BOTH = 2.0
"""Uncertainties are drawn with this many standard deviations to each side."""


def write_plot(path: Path, study: Calibration, found: Found) -> None:
    """Write the picture as PNG, at once."""
    write_picture(path, draw(study, found))


def draw(study: Calibration, found: Found) -> Figure:
    """The picture."""
    rows = max(len(study.targets), 2)
    height = 1.6 + 0.42 * rows + 0.75 * len(study.parameters)
    figure = Figure(figsize=(8.0, height), layout="constrained")
    above, below = figure.subplots(
        2, 1, height_ratios=[0.42 * rows + 0.6, 0.75 * len(study.parameters) + 0.4]
    )
    _draw_figures(above, study, found)
    _draw_parameters(below, study, found)
    return figure


def _draw_figures(axes: Axes, study: Calibration, found: Found) -> None:
    """Fitted over measured, so that figures of all units share one axis; of those measured as zero, in words."""
    measured = np.array([each.figure.value for each in study.targets])
    uncertainties = np.array([each.figure.uncertainty for each in study.targets])
    computed = found.fit.computed
    at = np.arange(len(measured))[::-1]
    for level, wanted, value, uncertainty in zip(at, measured, computed.values, uncertainties, strict=True):
        if wanted == 0.0:
            text = f"fitted {value:.3g}, {value / uncertainty:+.1f} std from it"
            axes.text(1.0, level, text, ha="center", va="center", fontsize="small", color="C0")
    # Over a measured zero everything is infinite.
    drawn = measured != 0.0
    levels, over = at[drawn], measured[drawn]
    reach = BOTH * uncertainties[drawn] / np.abs(over)
    fitted = computed.values[drawn] / over
    spread = BOTH * np.nan_to_num(computed.deviations[drawn]) / np.abs(over)
    axes.errorbar(
        np.ones_like(over),
        levels + 0.12,
        xerr=reach,
        fmt="s",
        color="0.3",
        capsize=3,
        label="measured ± 2 std",
    )
    axes.errorbar(
        fitted,
        levels - 0.12,
        xerr=spread,
        fmt="o",
        color="C0",
        capsize=3,
        label="fitted ± 2 std over the window",
    )
    names = target_names(study.targets, study.cuts)
    labels = [
        textwrap.fill(f"{name}: {value:.4g} {each.figure.unit}", 40)
        for name, value, each in zip(names, measured, study.targets, strict=True)
    ]
    axes.set_yticks(at, labels, fontsize="small")
    axes.set_ylim(-0.6, len(measured) - 0.4)
    axes.axvline(1.0, color="0.6", linewidth=0.8)
    axes.set_xlabel("Over the measured value")
    axes.grid(axis="x", alpha=0.3)
    axes.legend(fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)


def _draw_parameters(axes: Axes, study: Calibration, found: Found) -> None:
    count = len(study.parameters)
    for index, each in enumerate(found.confidence.estimates):
        level, parameter = count - 1 - index, each.parameter
        axes.plot([0.0, 1.0], [level, level], color="0.8", linewidth=6, solid_capstyle="butt")
        if math.isfinite(each.deviation):
            low, high = (min(max(parameter.scaled(end), 0.0), 1.0) for end in (each.low, each.high))
            axes.plot([low, high], [level, level], color="C0", linewidth=6, solid_capstyle="butt", alpha=0.5)
        axes.plot(parameter.scaled(parameter.start), level, "|", color="0.3", markersize=14)
        axes.plot(parameter.scaled(each.value), level, "o", color="C0")
        axes.text(0.0, level - 0.2, f"{parameter.low:g}", ha="left", va="top", fontsize="small", color="0.4")
        axes.text(
            1.0, level - 0.2, f"{parameter.high:g}", ha="right", va="top", fontsize="small", color="0.4"
        )
        text = f"{each.value:.4g}"
        axes.text(parameter.scaled(each.value), level + 0.22, text, ha="center", fontsize="small", color="C0")
    labels = [textwrap.fill(each.key, 34) for each in study.parameters][::-1]
    axes.set_yticks(range(count), labels, fontsize="small")
    axes.set_ylim(-0.6, count - 0.4)
    axes.set_xlim(-0.02, 1.02)
    axes.set_xticks([])
    axes.set_xlabel("Grey: bounds; bar: 95 % interval within them; tick: start", fontsize="small")
