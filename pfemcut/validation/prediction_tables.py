"""Tables and plot of predicted cuts beside measured ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

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

PARTS = {"rake": "rake face", "tip": "edge (tip circle)", "flank": "flank"}
SHARES = tuple(f"{force}_on_{part}" for part in PARTS for force in ("cutting", "thrust"))
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
    shares = {str(row[0]): _row_shares(header, row) for row in rows}
    draw_shares(path.with_name("force_shares.png"), f"{title}: parts of the tool", run, shares, measured)
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
    _label_cuts(axes[-1], cuts)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def draw_shares(
    path: Path,
    title: str,
    cuts: Sequence[PlannedCut],
    shares: Mapping[str, NDArray[np.float64]],
    measured: Mapping[str, Mapping[str, Figure]],
) -> None:
    """What the parts of the tool bear of the forces, stacked, beside the measured forces.

    ``shares`` has cutting and thrust force (N/mm) on rake face, edge and flank by cut; shape (3, 2).
    """
    figure, axes = plt.subplots(2, 1, figsize=(8.0, 6.5), layout="constrained", sharex=True)
    places = np.arange(len(cuts), dtype=float)
    borne = np.array([shares[cut.name] for cut in cuts]).reshape(len(cuts), len(PARTS), 2)
    for panel, (column, name) in zip(axes, enumerate(("cutting_force", "thrust_force")), strict=True):
        up, down = np.zeros(len(cuts)), np.zeros(len(cuts))
        for number, part in enumerate(PARTS.values()):
            height = borne[:, number, column]
            panel.bar(places - 0.1, height, 0.5, np.where(height >= 0.0, up, down), label=part)
            up, down = up + np.maximum(height, 0.0), down + np.minimum(height, 0.0)
        panel.plot(places - 0.1, borne[:, :, column].sum(axis=1), "k_", markersize=18, label="sum")
        given = [(at, measured[cut.name][name]) for at, cut in enumerate(cuts) if cut.name in measured]
        panel.errorbar(
            [at + 0.28 for at, _ in given],
            [found.value for _, found in given],
            yerr=[found.half_width for _, found in given],
            fmt="ks",
            capsize=3.0,
            label="measured",
        )
        panel.axhline(0.0, color="k", linewidth=0.8)
        panel.set(ylabel=LABELS[name])
        panel.grid(alpha=0.3, axis="y")
        panel.margins(y=0.08)
    axes[0].set_title(title)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(PARTS) + 2)
    _label_cuts(axes[-1], cuts)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def write_sensitivities(
    path: Path,
    title: str,
    references: Mapping[str, tuple[str, PlannedCut]],
    outcomes: Mapping[str, Outcome],
) -> dict[str, Any]:
    """Write the figures of runs, each with its relative change to another run of the same cut.

    ``references`` has the other run and the cut by the name of each; a run is left out while one of both is missing.
    """
    header = ["run", "relative_to", *LABELS, *(f"{name}_change" for name in LABELS)]
    header += [*SHARES, "contact_length", "tip_arc_contact", "max_temperature", "steady", "chip_complete"]
    rows: list[list[str | float]] = []
    for name, (reference, cut) in references.items():
        if name not in outcomes or reference not in outcomes:
            continue
        outcome = outcomes[name]
        found, base = predicted(outcome, cut.depth), predicted(outcomes[reference], cut.depth)
        rows.append(
            [
                name,
                reference,
                *(found[label].value for label in LABELS),
                *(found[label].value / base[label].value - 1.0 for label in LABELS),
                *_shares(outcome, cut.speed),
                *(outcome.mean(key) for key in ("contact_length", "tip_arc_contact", "max_temperature")),
                "yes" if outcome.summary["steady"]["value"] else "no",
                "yes" if _complete_in_window(outcome) else "no",
            ]
        )
    write_table(path, title, header, rows)
    return {"sensitivities": finite_figures(header, rows)}


def _shares(outcome: Outcome, speed: float) -> list[float]:
    frame = read_last_frame(outcome.directory)
    found = force_shares(frame, frame.tool[0], speed * 1000.0 / 60.0)
    return [float(force) for part in (found.rake, found.tip, found.flank) for force in part]


def _row_shares(header: Sequence[str], row: Sequence[str | float]) -> NDArray[np.float64]:
    """The forces on the parts in a table's row; (3, 2)."""
    named = dict(zip(header, row, strict=True))
    return np.array([float(named[name]) for name in SHARES]).reshape(len(PARTS), 2)


def _label_cuts(axis: Axes, cuts: Sequence[PlannedCut]) -> None:
    axis.set_xticks(range(len(cuts)), [f"{1e3 * cut.depth:g}\n{cut.speed:g}" for cut in cuts])
    axis.set_xlabel("uncut chip thickness (µm) over cutting speed (m/min)")


def _complete_in_window(outcome: Outcome) -> bool:
    """Whether the chip was, all over the window, long enough for the whole range of its thickness."""
    begin, end = outcome.summary["window"]
    travel = outcome.history["travel"]
    inside = (travel >= begin) & (travel <= end)
    return bool(inside.any() and np.all(outcome.history["chip_complete"][inside] >= 1.0))
