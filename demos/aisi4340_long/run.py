"""A long cut of AISI 4340 whose chip curls until it touches the workpiece, and goes on.

    python demos/aisi4340_long/run.py [-o DIR] [--resume | --overwrite] [--travel MM]

The run goes to ``out``. ``results`` beside this file gets the means over each quarter of a millimetre before and after
the touch, a thinned history, and pictures of the chip at some travels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.output.tables import write_csv
from pfemcut.output.vtu import read_collection
from pfemcut.ranks import Ranks
from pfemcut.validation.demo import frames_between
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_history, read_summary, recorded_run, sessions
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.whole_files import write_json

FOLDER = Path(__file__).resolve().parent
LENGTH = 0.25
"""Travel of a row of the table (mm)."""
MEANS = (
    "cutting_force",
    "thrust_force",
    "self_contact_force",
    "self_contact_length",
    "chip_thickness",
    "contact_length",
    "shear_angle",
    "chip_curvature",
    "max_temperature",
    "nodes",
    "newton_iterations",
)
LAST = ("energy_error", "heat_error", "area_drift", "mass_drift", "step_cuts")
TRAVELS = (1.0, 1.5, 2.4, 3.5, 4.5, 5.4)
"""Where the chip is drawn (mm)."""


def run_demo(arguments: Sequence[str]) -> bool:
    """Run and record; whether the run came to the end of its travel with closed ledgers."""
    options = parser(__doc__.partition("\n")[0], FOLDER / "out").parse_args(arguments)
    overrides = [] if options.travel is None else [f"cutting.travel={options.travel}"]
    summary = recorded_run(FOLDER / "case.toml", options.output, overrides, start_of(options))
    results = options.output / "results" if overrides else FOLDER / "results"
    Ranks().on_first(lambda: record(options.output, results))
    sound = abs(float(summary.figures["energy_error"]["value"])) < 0.01
    return summary.ending == "reached its final time" and sound


def record(output: Path, results: Path) -> None:
    """Tables and pictures of a run."""
    history = read_history(output)
    rows = windows(history)
    for row in rows:
        print("  ".join(f"{name} {value:.4g}" for name, value in row.items()))
    write_csv(
        results / "windows.csv", list(rows[0]), [[f"{value:.6g}" for value in row.values()] for row in rows]
    )
    write_thinned(results / "history.csv", history)
    found = read_summary(output)
    touching = np.flatnonzero(history["self_contact_force"] > 0.0)
    write_json(
        results / "summary.json",
        {
            "ending": found["ending"],
            "travel": found["travel"],
            "steps": found["steps"]["value"],
            "wall_time": found["wall_time"]["value"],
            "touches_from": float(history["travel"][touching[0]]) if touching.size else None,
            "warnings": found["warnings"],
            "sessions": sessions(output),
            "recorded": provenance(),
        },
    )
    draw(output, history, results)


def windows(history: Mapping[str, NDArray[np.float64]]) -> list[dict[str, float]]:
    """Time-weighted means over pieces of the travel, and ledgers at their ends."""
    travel, step = history["travel"], history["dt"]
    rows = []
    for begin in np.arange(0.25, travel[-1] - 0.5 * LENGTH, LENGTH):
        inside = np.flatnonzero((begin < travel) & (travel <= begin + LENGTH))
        row: dict[str, float] = {"from": float(begin), "to": float(travel[inside[-1]])}
        for name in MEANS:
            known = inside[np.isfinite(history[name][inside])]
            row[name] = float(np.average(history[name][known], weights=step[known])) if len(known) else np.nan
        row |= {name: float(history[name][inside[-1]]) for name in LAST}
        rows.append(row)
    return rows


def draw(output: Path, history: Mapping[str, Any], results: Path) -> None:
    """The chip, coloured by plastic strain, at the frames nearest to TRAVELS."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    times = np.array(sorted({entry.time for entry in read_collection(output)}))
    reached = [each for each in TRAVELS if each <= history["travel"][-1]]
    speed = float(history["travel"][-1] / history["time"][-1])
    figure, axes = plt.subplots(2, 3, figsize=(13, 7), layout="constrained")
    for axis, wanted in zip(axes.flat, reached, strict=False):
        time = float(times[np.argmin(np.abs(times - wanted / speed))])
        for frame in frames_between(output, time, time):
            axis.tripcolor(
                *frame.points.T,
                frame.cells,
                frame.cell_fields["equivalent_plastic_strain"],
                cmap="viridis",
                vmin=0.0,
                vmax=3.0,
            )
            for loop in frame.loops:
                axis.plot(*frame.points[np.append(loop, loop[0])].T, color="k", lw=0.6)
            tip = frame.tool[0].centre[0]
            axis.set(
                aspect="equal",
                xlim=(tip - 1.5, tip + 0.4),
                ylim=(0.35, 1.85),
                title=f"travel {frame.travel:.2f} mm",
            )
    path = output / "chip.png"
    figure.savefig(path, dpi=80)
    plt.close(figure)
    copy_picture(path, results / "chip.png")


if __name__ == "__main__":
    exit_with(run_demo)
