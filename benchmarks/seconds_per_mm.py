"""Wall seconds for one steady millimetre of cut, and what the longer steps cost in accuracy.

    python benchmarks/seconds_per_mm.py [--only NAME ...] [--ranks N] [--travel MM] [--output FILE]

`pfemcut run` of demos/aisi4340_rake0 at 3330 mm/s with other mesh sizes, steps as long as the flow allows up to
LONGEST, from 0.05 mm of travel on; set-up and compilation are not in it, fields, history and checkpoints are. `12k`
cuts 0.4 mm only. `half` repeats `6k` with half its steps for 0.6 mm: means over the last 0.25 mm of that are compared.
Runs that are finished are taken as they are (out/bench).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measured_steps import CASE
from scipy.integrate import trapezoid

from pfemcut.output.tables import print_table
from pfemcut.results.history import read_table
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

LONGEST = 4.7e-7  # s, 4.5 of the paper's steps
TOLERANCE = 0.15
ENTRY = 0.05  # mm that do not count
# Sizes (mm) at the tip, in the shear zone, in the chip and on the surface, and growth; part of the longest step.
FINE = (0.004, 0.0044, 0.0095, 0.0095, 0.035)
RUNS = {
    "1.5k": ((0.0054, 0.0095, 0.0149, 0.0162, 0.081), 1.0),
    "6k": (FINE, 1.0),
    "half": (FINE, 0.5),
    "12k": ((0.003, 0.0032, 0.0045, 0.005, 0.026), 1.0),
}
SIZES = ("tip_size", "shear_zone_size", "chip_size", "surface_size", "growth")
SHORTER = {"half": 0.6, "12k": 0.4}  # mm
WINDOW = (0.35, 0.6)  # mm of travel, in which the runs with whole and half steps are compared
FIGURES = ("cutting_force", "thrust_force", "chip_thickness", "contact_length", "max_temperature")
OUTPUT = ROOT / "benchmarks" / "results" / "seconds_per_mm.json"


def folder(name: str, ranks: int) -> Path:
    """Folder of a run; the one with half the steps is for its forces and takes one rank."""
    ranks = 1 if name == "half" else ranks
    return ROOT / "out" / "bench" / f"{name}_{ranks}"


def run(name: str, travel: float, ranks: int) -> Path:
    sizes, part = RUNS[name]
    directory = folder(name, ranks)
    if (directory / "summary.json").is_file():
        return directory
    changes = [
        *(f"mesh.{key}={value!r}" for key, value in zip(SIZES, sizes, strict=True)),
        f"time.largest_step={part * LONGEST!r}",
        # Half the steps have to be half as long where the tolerance rules, too.
        f"time.step_tolerance={part * TOLERANCE!r}",
        "output.figures=false",
    ]
    travel = min(travel, SHORTER.get(name, travel))
    arguments = [word for change in changes for word in ("--set", change)]
    command = [sys.executable, "-m", "pfemcut", "run", str(CASE), "-o", str(directory)]
    if ranks > 1 and name != "half":
        command = ["mpirun", "--allow-run-as-root", "-n", str(ranks), *command]
    command += ["--travel", repr(travel), "--overwrite", *arguments]
    subprocess.run(command, check=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    return directory


def window_means(directory: Path) -> dict[str, float]:
    """Means of the figures over the window, by travel and not by step, whatever the steps; defined ones only."""
    history = read_table(directory / "history.csv")
    travel = history["travel"]
    inside = (WINDOW[0] <= travel) & (travel <= WINDOW[1])
    length = np.ptp(travel[inside])
    return {
        name: float(trapezoid(history[name][inside], travel[inside]) / length)
        for name in FIGURES
        if np.all(np.isfinite(history[name][inside]))
    }


def measured(directory: Path) -> dict[str, Any]:
    history, timing = read_table(directory / "history.csv"), read_table(directory / "timing.csv")
    counted = np.flatnonzero(history["travel"] > ENTRY)
    first, steps = counted[0], counted[1:]  # the first one's work lies before
    travelled = history["travel"][-1] - history["travel"][first]
    summary = json.loads((directory / "summary.json").read_text())
    return {
        "seconds_per_mm": float(timing["total"][steps].sum() / travelled),
        "travelled": float(travelled),
        "least_particles": float(history["nodes"].min()),
        "most_particles": float(history["nodes"].max()),
        "steps": len(steps),
        "mean_step": float((history["time"][-1] - history["time"][first]) / len(steps)),
        "newton_iterations": float(history["newton_iterations"][counted].mean()),
        "halved_steps": float(history["step_cuts"][-1]),
        "phases": {name: float(timing[name][counted].mean()) for name in timing if name != "step"},
        "steady": summary["steady"],
        "figures": {name: summary[name]["mean"] for name in FIGURES if name in summary},
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=list(RUNS), default=list(RUNS))
    parser.add_argument("--travel", type=float, default=1.06, help="mm (default: %(default)s)")
    parser.add_argument("--ranks", type=int, default=2, help="MPI ranks (default: %(default)s)")
    parser.add_argument("--output", type=Path, default=OUTPUT)
    options = parser.parse_args()
    content: dict[str, Any] = {**provenance(), "load_average": round(os.getloadavg()[0], 2)}
    content["ranks"] = options.ranks
    content["runs"] = {name: measured(run(name, options.travel, options.ranks)) for name in options.only}
    if {"6k", "half"} <= set(options.only):
        whole, half = (window_means(folder(name, options.ranks)) for name in ("6k", "half"))
        content["window"] = list(WINDOW)
        content["difference_to_half_the_step"] = {name: whole[name] / half[name] - 1.0 for name in whole}
    write_json(options.output, content)
    print_table(
        "One steady millimetre",
        ("run", "particles", "s/mm", "steps", "iterations", "Fc (N/mm)", "Ft (N/mm)"),
        [
            (
                name,
                f"{each['least_particles']:.0f}-{each['most_particles']:.0f}",
                f"{each['seconds_per_mm']:.0f}",
                str(each["steps"]),
                f"{each['newton_iterations']:.1f}",
                f"{each['figures']['cutting_force']:.2f}",
                f"{each['figures']['thrust_force']:.2f}",
            )
            for name, each in content["runs"].items()
        ],
    )
    for name, value in content.get("difference_to_half_the_step", {}).items():
        print(f"{name}: {value:+.2%} against half the step")
    print(f"results  {options.output}")


if __name__ == "__main__":
    main()
