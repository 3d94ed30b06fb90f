"""A long cut of AISI 4340 whose chip curls until it touches the workpiece, is cut off, and goes on; restarted midway.

    python demos/aisi4340_long/run.py [-o DIR] [--resume | --overwrite] [--travel MM]

Two processes, one after the other: ``DIR/first`` cuts half of the travel, ``DIR/second`` starts from the checkpoint
before the last of the first, in a process of its own, and goes to the end. What both cut must agree bit for bit.
``results`` beside this file gets means over each quarter of a millimetre, a thinned history, the memory used, and the
chip at some travels.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import load_case
from pfemcut.inputs import UserError
from pfemcut.method import RunStopped
from pfemcut.output.directory import HISTORY
from pfemcut.output.tables import write_csv
from pfemcut.output.vtu import read_collection
from pfemcut.results.checkpoint import NAME, PREVIOUS, read_checkpoint
from pfemcut.results.history import read_table
from pfemcut.validation.demo import frames_between
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_history, read_summary, recorded_run, sessions
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.whole_files import write_json

FOLDER = Path(__file__).resolve().parent
CASE = FOLDER / "case.toml"
LEGS = ("first", "second")
MEMORY = "memory.csv"
RESTARTED = "restarted_from"
"""File with the step from which the second leg went on."""
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
LAST = ("energy_error", "heat_error", "area_drift", "mass_drift", "cut_off_mass", "step_cuts")
PICTURES = 6


def run_demo(arguments: Sequence[str]) -> bool:
    """Run and record; whether the run came to its end with closed ledgers, and the restart changed nothing."""
    options_parser = parser(__doc__.partition("\n")[0], FOLDER / "out")
    options_parser.add_argument("--leg", choices=LEGS, help="this part of the run only, without results")
    options = options_parser.parse_args(arguments)
    case, _ = load_case(CASE)
    planned = float(case.cutting.travel)
    travel = planned if options.travel is None else options.travel
    start = start_of(options)
    if options.leg:
        end = 0.5 * travel if options.leg == "first" else travel
        directory = options.output / options.leg
        with memory_noted(directory):
            recorded_run(CASE, directory, [f"cutting.travel={end}"], start)
        return True
    for leg in LEGS:
        begun = (options.output / leg / HISTORY).exists()
        if begun and not (start.resume or start.overwrite):
            raise UserError(f"{options.output / leg} holds a run; --resume or --overwrite")
        go_on = leg == "second" or start.resume
        if leg == "second" and (start.overwrite or not begun):
            hand_over(options.output / "first", options.output / "second")
        run_leg(options.output, leg, travel, go_on)
    results = FOLDER / "results" if options.travel is None else options.output / "results"
    return record(options.output, results)


def run_leg(output: Path, leg: str, travel: float, resume: bool) -> None:
    """One part of the run in a process of its own."""
    command = [sys.executable, __file__, "-o", str(output), "--leg", leg, "--travel", str(travel)]
    if subprocess.run([*command, "--resume" if resume else "--overwrite"], check=False).returncode:
        raise RunStopped(f"{output / leg} did not come to its end")


def hand_over(first: Path, second: Path) -> None:
    """Let ``second`` go on from the checkpoint before the last of ``first``."""
    shutil.rmtree(second, ignore_errors=True)
    shutil.copytree(first, second)
    os.replace(second / PREVIOUS, second / NAME)
    (second / MEMORY).unlink()
    step = read_checkpoint(second).step
    (second / RESTARTED).write_text(f"{step}\n", encoding="utf-8")


@contextmanager
def memory_noted(directory: Path) -> Iterator[None]:
    """Every few seconds, write the memory that this process uses and the travel it has come to."""
    done = threading.Event()

    def note() -> None:
        path = directory / MEMORY
        while not done.wait(5.0):
            for travel in last_travel(directory / HISTORY):
                if not path.exists():
                    path.write_text("travel,megabytes\n", encoding="utf-8")
                with path.open("a", encoding="utf-8") as file:
                    file.write(f"{travel:.5g},{resident_megabytes():.1f}\n")

    thread = threading.Thread(target=note, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def last_travel(history: Path) -> Iterator[float]:
    """Travel (mm) of the last row but one, which is whole, or none. Reading all of the file would use memory, too."""
    if not history.exists():
        return
    with history.open("rb") as file:
        names = file.readline().decode().strip().split(",")
        file.seek(max(-8192, file.tell() - history.stat().st_size), os.SEEK_END)
        rows = [row.split(",") for row in file.read().decode().splitlines()[:-1]]
    for row in rows[-1:]:
        if len(row) == len(names):
            yield float(row[names.index("travel")])


def resident_megabytes() -> float:
    """Memory of this process."""
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def record(output: Path, results: Path) -> bool:
    """Tables and pictures of the run; whether all is well."""
    first, second = (output / leg for leg in LEGS)
    history = read_history(second)
    rows = windows(history, memory_of(output))
    for row in rows:
        print("  ".join(f"{name} {value:.4g}" for name, value in row.items()))
    results.mkdir(parents=True, exist_ok=True)
    write_csv(
        results / "windows.csv", list(rows[0]), [[f"{value:.6g}" for value in row.values()] for row in rows]
    )
    write_thinned(results / "history.csv", history)
    found = read_summary(second)
    restart = restart_check(first, second)
    touching = np.flatnonzero(history["self_contact_force"] > 0.0)
    write_json(
        results / "summary.json",
        {
            "ending": found["ending"],
            "travel": found["travel"],
            "steps": found["steps"]["value"],
            "wall_time": found["wall_time"]["value"],
            "touches_from": float(history["travel"][touching[0]]) if touching.size else None,
            "restart": restart,
            "warnings": found["warnings"],
            "sessions": {leg: sessions(output / leg) for leg in LEGS},
            "recorded": provenance(),
        },
    )
    draw(second, history, results)
    sound = abs(float(found["energy_error"]["value"])) < 0.01
    return bool(found["ending"] == "reached its final time" and sound and restart["identical"])


def restart_check(first: Path, second: Path) -> dict[str, Any]:
    """What the two legs say of the steps that both made, but those that the first shortened to end on time."""
    one, two = read_history(first), read_history(second)
    begun = int((second / RESTARTED).read_text(encoding="utf-8"))
    both = (one["step"] > begun) & (one["step"] <= one["step"][-1] - 2)
    rows = np.flatnonzero(both)
    same = all(
        np.array_equal(one[name][rows], two[name][rows], equal_nan=True) for name in one if name in two
    )
    return {
        "from_step": begun,
        "from_travel": float(two["travel"][two["step"] == begun][0]),
        "compared_steps": len(rows),
        "identical": bool(same and len(rows) > 0),
    }


def memory_of(output: Path) -> Mapping[str, NDArray[np.float64]]:
    """Travel and memory of both legs."""
    tables = [read_table(output / leg / MEMORY) for leg in LEGS]
    return {name: np.concatenate([table[name] for table in tables]) for name in ("travel", "megabytes")}


def windows(
    history: Mapping[str, NDArray[np.float64]], memory: Mapping[str, NDArray[np.float64]]
) -> list[dict[str, float]]:
    """Time-weighted means over pieces of the travel, ledgers at their ends, and the most memory in them."""
    travel, step = history["travel"], history["dt"]
    rows = []
    for begin in np.arange(LENGTH, travel[-1] - 0.5 * LENGTH, LENGTH):
        inside = np.flatnonzero((begin < travel) & (travel <= begin + LENGTH))
        row: dict[str, float] = {"from": float(begin), "to": float(travel[inside[-1]])}
        for name in MEANS:
            known = inside[np.isfinite(history[name][inside])]
            row[name] = float(np.average(history[name][known], weights=step[known])) if len(known) else np.nan
        row["cutting_force_std"] = float(history["cutting_force"][inside].std())
        row |= {name: float(history[name][inside[-1]]) for name in LAST}
        noted = memory["megabytes"][(begin < memory["travel"]) & (memory["travel"] <= begin + LENGTH)]
        row["megabytes"] = float(noted.max(initial=0.0))
        rows.append(row)
    return rows


def draw(output: Path, history: Mapping[str, Any], results: Path) -> None:
    """The chip, coloured by plastic strain, at some travels."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    times = np.array(sorted({entry.time for entry in read_collection(output)}))
    wanted = times[-1] * np.linspace(1.0 / PICTURES, 1.0, PICTURES)
    figure, axes = plt.subplots(2, 3, figsize=(13, 8), layout="constrained")
    for axis, time in zip(axes.flat, times[np.argmin(np.abs(times - wanted[:, None]), axis=1)], strict=True):
        for frame in frames_between(output, time, time):
            strain = frame.cell_fields["equivalent_plastic_strain"]
            axis.tripcolor(*frame.points.T, frame.cells, strain, cmap="viridis", vmin=0.0, vmax=3.0)
            for loop in frame.loops:
                axis.plot(*frame.points[np.append(loop, loop[0])].T, color="k", lw=0.6)
            tool = frame.tool[0]
            axis.fill(*tool.outline(3.0).T, color="0.75")
            axis.set(
                aspect="equal",
                xlim=(tool.centre[0] - 1.5, tool.centre[0] + 0.4),
                ylim=(0.35, 1.85),
                title=f"travel {frame.travel:.2f} mm",
            )
    path = output / "chip.png"
    figure.savefig(path, dpi=80)
    plt.close(figure)
    copy_picture(path, results / "chip.png")


if __name__ == "__main__":
    exit_with(run_demo)
