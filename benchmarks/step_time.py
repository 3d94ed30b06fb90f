"""Wall time of a step by phase at three sizes, beside one MUMPS factorisation of the same matrix; start-up times.

python benchmarks/step_time.py [--factors 0.87 0.51 0.36] [--steps 40] [--output FILE]

Each size is the demo's case with its mesh sizes scaled, cut from first contact; the first steps are left out. The
matrix is that of the last Newton iteration of the last step. Times of MUMPS are of fresh solvers set up like
pfemcut's: setting up a new one analyses and factorises, setting it up again after the values changed factorises only.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from pfemcut.case.cutting import cutting_problem
from pfemcut.case.load import load_case
from pfemcut.fem import momentum_system
from pfemcut.fem.direct_solver import DirectSolver
from pfemcut.pfem.method import PfemMethod
from pfemcut.results.derived.columns import derived_columns
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

Array = NDArray[np.float64]

CASE = ROOT / "demos" / "aisi4340_demo" / "case.toml"
SIZES = ("tip_size", "shear_zone_size", "chip_size", "surface_size", "far_size")
FACTORS = (0.87, 0.51, 0.36)  # about 1.5k, 4k and 8k particles
SKIPPED = 15
REPEATS = 7
ORDERINGS = {0: "AMD", 2: "AMF", 3: "SCOTCH", 4: "PORD", 5: "METIS", 6: "QAMD"}
OUTPUT = ROOT / "benchmarks" / "results" / "step_time.json"


class RememberingSolver(DirectSolver):
    """The step's solver, which keeps a copy of the last system that it was given."""

    wanted = False
    last: dict[str, Any] = {}

    def solve(self, right_hand_side: Array) -> tuple[Array, bool]:
        if RememberingSolver.wanted:
            rows = tuple(each.copy() for each in self.rows)
            RememberingSolver.last = {
                "rows": rows,
                "symmetric": self.symmetric,
                "right": right_hand_side.copy(),
            }
        return super().solve(right_hand_side)


def seconds(work: Callable[[], Any]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def mumps_times(last: dict[str, Any]) -> dict[str, Any]:
    """Medians (s) of a new set-up, of a set-up with changed values, and of a solve; the ordering that was used."""
    times: dict[str, list[float]] = {"setup": [], "factorisation": [], "solve": []}
    for _ in range(REPEATS):
        solver = DirectSolver(
            MPI.COMM_SELF, *last["rows"], block=momentum_system.COMPONENTS, symmetric=last["symmetric"]
        )
        ksp = solver.solver
        preconditioner = ksp.getPC()
        times["setup"].append(seconds(preconditioner.setUp))
        solver.update()  # the same values, but PETSc takes them for new ones
        times["factorisation"].append(seconds(preconditioner.setUp))
        right, solution = solver.matrix.createVecs()
        right.array[:] = last["right"]
        times["solve"].append(seconds(lambda: ksp.solve(right, solution)))  # noqa: B023
        ordering = preconditioner.getFactorMatrix().getMumpsInfog(7)
        for each in (right, solution, solver):
            each.destroy()
    found: dict[str, Any] = {name: median(values) for name, values in times.items()}
    found["analysis"] = max(
        median(a - b for a, b in zip(times["setup"], times["factorisation"], strict=True)), 0.0
    )
    found["ordering"] = ORDERINGS.get(ordering, str(ordering))
    found["factors"] = "LDL^T" if last["symmetric"] else "LU"
    return found


def one_size(factor: float, steps: int) -> dict[str, Any]:
    """Medians (s) of the steps of one mesh, by phase."""
    case, _ = load_case(CASE)
    # The paper's step and integrator, a step whose cost does not depend on how fast it may grow.
    fixed = ['time.integrator="impl-ex"', f"time.largest_step={case.time.step!r}"]
    changes = [f"mesh.{name}={factor * getattr(case.mesh, name)!r}" for name in SIZES if name != "far_size"]
    # Insertion by plastic power follows the spacing, growth decides how fast it widens: both scale with it.
    case, material = load_case(
        CASE, [*fixed, *changes, f"mesh.growth={max(factor * case.mesh.growth, 0.01)!r}"]
    )
    problem = cutting_problem(case, material)
    method = PfemMethod.start(problem)
    rows: list[dict[str, float]] = []
    iterations: list[int] = []
    for step in range(steps):
        RememberingSolver.wanted = step == steps - 1
        begun = time.perf_counter()
        method.advance()
        advanced = time.perf_counter()
        method.measure()
        method.own_measures()
        derived_columns(method.frame(), problem.cut[0])
        ended = time.perf_counter()
        if step >= SKIPPED:
            phases = dict(method.timing())
            phases["history"] = ended - advanced
            phases["rest"] = advanced - begun - sum(method.timing().values())
            rows.append({**phases, "step": ended - begun})
            iterations.append(method.record.newton_iterations)
    RememberingSolver.wanted = False
    last = RememberingSolver.last
    phases = {name: median(row[name] for row in rows) for name in rows[0]}
    mumps = mumps_times(last)
    whole = mumps["analysis"] + mumps["factorisation"] + mumps["solve"]
    return {
        "factor": factor,
        "particles": len(method.current.mesh.points),
        "elements": len(method.current.mesh.cells),
        "unknowns": len(last["right"]),
        "nonzeros": len(last["rows"][2]),
        "newton_iterations": float(np.mean(iterations)),
        "seconds": phases,
        "mumps_seconds": mumps,
        "step_over_factorisation": phases["step"] / mumps["factorisation"],
        "step_over_analysis_factorisation_solve": phases["step"] / whole,
    }


def first_step() -> dict[str, float]:
    """Seconds from the start of this process's work to the end of its first step."""
    begun = time.perf_counter()
    case, material = load_case(CASE)
    method = PfemMethod.start(cutting_problem(case, material))
    started = time.perf_counter()
    method.advance()
    stepped = time.perf_counter()
    method.advance()
    return {
        "start": started - begun,
        "first_step": stepped - started,
        "second_step": time.perf_counter() - stepped,
    }


def start_up() -> dict[str, Any]:
    """Wall times of `pfemcut check`, and of two steps in new processes with empty and with filled caches."""
    check = [seconds(lambda: quiet([sys.executable, "-m", "pfemcut", "check", str(CASE)])) for _ in range(3)]
    with tempfile.TemporaryDirectory() as caches:
        environment = {
            "XDG_CACHE_HOME": caches,
            "FFCX_CACHE_DIR": caches,
            "NUMBA_CACHE_DIR": str(Path(caches) / "numba"),
        }
        found: dict[str, Any] = {"check": median(check)}
        for state in ("cold", "warm"):
            begun = time.perf_counter()
            text = quiet([sys.executable, __file__, "--first-step"], environment)
            found[state] = {**json.loads(text.splitlines()[-1]), "process": time.perf_counter() - begun}
    return found


def quiet(command: list[str], environment: dict[str, str] | None = None) -> str:
    done = subprocess.run(
        command, env={**os.environ, **(environment or {})}, check=True, capture_output=True, text=True
    )
    return done.stdout


def tables(content: dict[str, Any], console: Console) -> None:
    sizes = content["sizes"]
    table = Table(title="Milliseconds a step", title_justify="left", box=SIMPLE_HEAD)
    table.add_column("phase")
    for size in sizes:
        table.add_column(f"{size['particles']} particles", justify="right")
    for name in sizes[0]["seconds"]:
        table.add_row(
            name,
            *(f"{1e3 * size['seconds'][name]:.1f}" for size in sizes),
            style="bold" if name == "step" else "",
            end_section=name == "step",
        )
    for name in ("analysis", "factorisation", "solve"):
        table.add_row(f"one MUMPS {name}", *(f"{1e3 * size['mumps_seconds'][name]:.1f}" for size in sizes))
    table.add_row("MUMPS ordering", *(size["mumps_seconds"]["ordering"] for size in sizes))
    table.add_row("Newton iterations", *(f"{size['newton_iterations']:.1f}" for size in sizes))
    table.add_row("step / factorisation", *(f"{size['step_over_factorisation']:.2f}" for size in sizes))
    table.add_row(
        "step / (analysis + factorisation + solve)",
        *(f"{size['step_over_analysis_factorisation_solve']:.2f}" for size in sizes),
    )
    console.print(table)
    if "start_up" in content:
        started = content["start_up"]
        console.print(f"pfemcut check: {started['check']:.2f} s")
        for state in ("cold", "warm"):
            times = ", ".join(
                f"{name.replace('_', ' ')} {value:.2f} s" for name, value in started[state].items()
            )
            console.print(f"{state} start: {times}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--factors", type=float, nargs="+", default=FACTORS, help="of the demo's mesh sizes")
    parser.add_argument("--steps", type=int, default=40, help="steps of each size (default: %(default)s)")
    parser.add_argument("--output", type=Path, default=OUTPUT, help="JSON file (default: %(default)s)")
    parser.add_argument("--no-start-up", action="store_true", help="leave start-up times out")
    parser.add_argument("--first-step", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.first_step:
        print(json.dumps(first_step()))
        return
    if options.steps <= SKIPPED:
        parser.error(f"--steps must be above {SKIPPED}, the steps that are left out")
    momentum_system.DirectSolver = RememberingSolver
    content: dict[str, Any] = {**provenance(), "load_average": round(os.getloadavg()[0], 2)}
    content["sizes"] = [one_size(factor, options.steps) for factor in options.factors]
    if not options.no_start_up:
        content["start_up"] = start_up()
    write_json(options.output, content)
    console = Console()
    tables(content, console if console.is_terminal else Console(width=120))
    print(f"results  {options.output}")


if __name__ == "__main__":
    main()
