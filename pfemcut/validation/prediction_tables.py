"""Tables and plot of predicted cuts beside measured ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.output.vtu import read_last_frame
from pfemcut.results.derived.force_shares import force_shares
from pfemcut.validation.prediction import (
    LABELS,
    Figure,
    PlannedCut,
    differences,
    half_width,
    mean_and_largest,
    predicted,
)
from pfemcut.validation.study import Outcome, finite_figures, write_table

SHARES = tuple(f"{force}_on_{part}" for part in ("rake", "tip", "flank") for force in ("cutting", "thrust"))
"""Forces on the parts of the tool (N/mm), in the last frame."""


def write_predictions(
    path: Path,
    title: str,
    cuts: Sequence[PlannedCut],
    outcomes: Mapping[str, Outcome],
    parts: Sequence[Mapping[str, float]],
    measured: Mapping[str, Mapping[str, Figure]],
) -> dict[str, Any]:
    """Write table and plot of the cuts that were run; return what the study's JSON file takes.

    Parameters
    ----------
    path
        Of the table, ``.csv``; the plot lies beside it.
    title
        Of the table and of the plot.
    cuts, outcomes
        The planned cuts, and the runs by name.
    parts
        Relative parts of the uncertainty (mesh, step), by figure.
    measured
        Measured figures by cut.
    """
    run = [cut for cut in cuts if cut.name in outcomes]
    scattered = {cut.name: predicted(outcomes[cut.name], cut.depth) for cut in run}
    predictions = {
        cut: {
            name: Figure(
                figure.value, half_width(figure.value, [part[name] for part in parts], figure.half_width)
            )
            for name, figure in figures.items()
        }
        for cut, figures in scattered.items()
    }
    found = differences(predictions, measured)
    header = ["cut", "depth_mm", "speed_m_min"]
    for name in LABELS:
        header += [name, f"{name}_uncertainty", f"{name}_window_std"]
        header += [f"{name}_measured", f"{name}_measured_scatter", f"{name}_difference"]
    header += [
        *SHARES,
        "contact_length",
        "max_temperature",
        "steady",
        "chip_complete",
        "particles_at_end",
        "steps",
    ]
    rows: list[list[str | float]] = []
    for cut in run:
        outcome = outcomes[cut.name]
        row: list[str | float] = [cut.name, cut.depth, cut.speed]
        for name in LABELS:
            figure, deviation = predictions[cut.name][name], scattered[cut.name][name].half_width
            given = measured.get(cut.name, {}).get(name, Figure(math.nan, math.nan))
            difference = found.get(cut.name, {}).get(name, math.nan)
            row += [figure.value, figure.half_width, deviation, given.value, given.half_width, difference]
        row += [
            *_shares(outcome, cut.speed),
            outcome.mean("contact_length"),
            outcome.mean("max_temperature"),
            "yes" if outcome.summary["steady"]["value"] else "no",
            "yes" if _complete_in_window(outcome) else "no",
            float(outcome.history["nodes"][-1]),
            float(outcome.summary["steps"]["value"]),
        ]
        rows.append(row)
    write_table(path, title, header, rows)
    draw(path.with_suffix(".png"), title, run, predictions, measured)
    return {
        "predictions": finite_figures(header, rows),
        "errors": mean_and_largest(found),
        "not_run": [cut.name for cut in cuts if cut.name not in outcomes],
    }


def draw(
    path: Path,
    title: str,
    cuts: Sequence[PlannedCut],
    predictions: Mapping[str, Mapping[str, Figure]],
    measured: Mapping[str, Mapping[str, Figure]],
) -> None:
    """Predicted and measured figures of the cuts with their half-widths."""
    figure, axes = plt.subplots(len(LABELS), 1, figsize=(8.0, 8.0), layout="constrained", sharex=True)
    places = np.arange(len(cuts), dtype=float)
    for panel, (name, label) in zip(axes, LABELS.items(), strict=True):
        for shift, style, source, legend in (
            (-0.1, "o", predictions, "predicted"),
            (0.1, "s", measured, "measured"),
        ):
            chosen = [
                (at, source[cut.name][name])
                for at, cut in zip(places, cuts, strict=True)
                if cut.name in source
            ]
            panel.errorbar(
                [at + shift for at, _ in chosen],
                [found.value for _, found in chosen],
                yerr=[found.half_width for _, found in chosen],
                fmt=style,
                capsize=3.0,
                label=legend,
            )
        panel.set(ylabel=label, ylim=(0.0, None))
        panel.grid(alpha=0.3)
    axes[0].set_title(title)
    axes[0].legend(fontsize="small")
    axes[-1].set_xticks(places, [f"{1e3 * cut.depth:g} µm\n{cut.speed:g} m/min" for cut in cuts])
    figure.savefig(path, dpi=90)
    plt.close(figure)


def write_sensitivities(
    path: Path,
    title: str,
    reference: str,
    names: Sequence[str],
    outcomes: Mapping[str, Outcome],
    cut: PlannedCut,
) -> dict[str, Any]:
    """Write the figures of the runs ``names`` and their relative change to the run ``reference``."""
    header = ["run", *LABELS, *(f"{name}_change" for name in LABELS)]
    header += [*SHARES, "contact_length", "tip_arc_contact", "max_temperature", "steady"]
    if reference not in outcomes:
        return {}
    base = predicted(outcomes[reference], cut.depth)
    rows: list[list[str | float]] = []
    for name in [reference, *names]:
        if name not in outcomes:
            continue
        outcome = outcomes[name]
        found = predicted(outcome, cut.depth)
        rows.append(
            [
                name,
                *(found[label].value for label in LABELS),
                *(found[label].value / base[label].value - 1.0 for label in LABELS),
                *_shares(outcome, cut.speed),
                *(outcome.mean(key) for key in ("contact_length", "tip_arc_contact", "max_temperature")),
                "yes" if outcome.summary["steady"]["value"] else "no",
            ]
        )
    write_table(path, title, header, rows)
    return {"reference": reference, "sensitivities": finite_figures(header, rows)}


def _shares(outcome: Outcome, speed: float) -> list[float]:
    frame = read_last_frame(outcome.directory)
    found = force_shares(frame, frame.tool[0], speed * 1000.0 / 60.0)
    return [float(force) for part in (found.rake, found.tip, found.flank) for force in part]


def _complete_in_window(outcome: Outcome) -> bool:
    """Whether the chip was, all over the window, long enough for the whole range of its thickness."""
    begin, end = outcome.summary["window"]
    travel = outcome.history["travel"]
    inside = (travel >= begin) & (travel <= end)
    return bool(inside.any() and np.all(outcome.history["chip_complete"][inside] >= 1.0))
