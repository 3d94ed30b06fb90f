"""Growth of step time and memory with the number of particles, and one against two MPI ranks.

    python benchmarks/scaling.py [--factors F ...] [--rank-factors F ...] [--output FILE]

Each measurement is a process of its own, one BLAS thread, see benchmarks/measured_steps.py. The slopes are of a line
through the logarithms. On a machine with other work, ranks wait for each other: see the recorded load.
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

from pfemcut.output.tables import print_table
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

WORKER = Path(__file__).resolve().parent / "measured_steps.py"
FACTORS = (1.15, 0.64, 0.36, 0.205, 0.145)  # about 2k, 6k, 18k, 52k and 100k particles
RANK_FACTORS = (0.5, 0.21)  # about 10k and 50k
OUTPUT = ROOT / "benchmarks" / "results" / "scaling.json"


def measured(factor: float, ranks: int = 0) -> dict[str, Any]:
    """What the worker printed, alone (0) or started by mpirun with ``ranks`` processes."""
    command = [sys.executable, str(WORKER), "--factor", repr(factor)]
    if ranks:
        command = ["mpirun", "--allow-run-as-root", "--bind-to", "core", "-n", str(ranks), *command]
    done = subprocess.run(
        command, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=True, capture_output=True, text=True
    )
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def slope(rows: list[dict[str, Any]], figure: str) -> float:
    particles = np.log([row["particles"] for row in rows])
    return float(np.polyfit(particles, np.log([row[figure] for row in rows]), 1)[0])


def print_tables(content: dict[str, Any]) -> None:
    print_table(
        "One process",
        ("particles", "s/step", "iterations", "s/iteration", "MB"),
        [
            (
                str(row["particles"]),
                f"{row['step_seconds']:.3f}",
                f"{row['newton_iterations']:.1f}",
                f"{row['seconds_per_iteration']:.3f}",
                f"{row['memory_mb']:.0f}",
            )
            for row in content["growth"]
        ],
    )
    for name, value in content["slopes"].items():
        print(f"slope of {name}: {value:.2f}")
    for row in content["ranks"]:
        print(
            f"{row['one']['particles']} particles: {row['one']['step_seconds']:.3f} s a step with one rank, "
            f"{row['two']['step_seconds']:.3f} s with two: {row['ratio']:.2f} times faster, forces differ by "
            f"{row['force_difference']:.1e}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--factors", type=float, nargs="*", default=FACTORS)
    parser.add_argument("--rank-factors", type=float, nargs="*", default=RANK_FACTORS)
    parser.add_argument("--output", type=Path, default=OUTPUT)
    options = parser.parse_args()
    content: dict[str, Any] = {**provenance(), "load_average": round(os.getloadavg()[0], 2), "ranks": []}
    content["growth"] = [measured(factor) for factor in options.factors]
    figures = ("step_seconds", "seconds_per_iteration", "memory_mb")
    content["slopes"] = (
        {name: slope(content["growth"], name) for name in figures} if len(options.factors) > 1 else {}
    )
    for factor in options.rank_factors:
        one, two = measured(factor, 1), measured(factor, 2)
        force = np.array(one["tool_force"])
        content["ranks"].append(
            {
                "one": one,
                "two": two,
                "ratio": one["step_seconds"] / two["step_seconds"],
                "force_difference": float(
                    np.linalg.norm(np.array(two["tool_force"]) - force) / np.linalg.norm(force)
                ),
            }
        )
    write_json(options.output, content)
    print_tables(content)
    print(f"results  {options.output}")


if __name__ == "__main__":
    main()
