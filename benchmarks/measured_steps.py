"""Steps of one cut, timed: a worker for the other benchmarks, alone or under mpirun. Prints one line of JSON.

    python benchmarks/measured_steps.py --factor 0.64 [--steps 4] [--skip 2] [--set KEY=VALUE ...]

The cut is demos/aisi4340_rake0 from first contact, all mesh sizes but the far one times the factor.
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from statistics import median

from mpi4py import MPI

from pfemcut.case.cutting import cutting_problem
from pfemcut.case.load import load_case
from pfemcut.converge.refinement import scaled_sizes
from pfemcut.pfem.method import PfemMethod
from pfemcut.validation.provenance import ROOT

CASE = ROOT / "demos" / "aisi4340_rake0" / "case.toml"


def scaled(factor: float) -> list[str]:
    """Changes of the case that scale its mesh sizes but for the far one."""
    sizes = scaled_sizes(load_case(CASE)[0], factor)
    return [f"{key}={value!r}" for key, value in sizes.items() if key != "mesh.far_size"]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--factor", type=float, required=True)
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument(
        "--skip", type=int, default=2, help="first steps that are not timed (default: %(default)s)"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="changes")
    options = parser.parse_args()
    case, material = load_case(CASE, [*scaled(options.factor), *options.changes])
    method = PfemMethod.start(cutting_problem(case, material))
    seconds: list[float] = []
    phases: list[dict[str, float]] = []
    iterations: list[int] = []
    for step in range(options.skip + options.steps):
        MPI.COMM_WORLD.Barrier()
        begun = time.perf_counter()
        method.advance()
        if step >= options.skip:
            seconds.append(time.perf_counter() - begun)
            phases.append(dict(method.timing()))
            iterations.append(method.record.newton_iterations)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    total = MPI.COMM_WORLD.allreduce(memory)
    if MPI.COMM_WORLD.rank:
        return
    found = {
        "ranks": MPI.COMM_WORLD.size,
        "particles": len(method.current.mesh.points),
        "elements": len(method.current.mesh.cells),
        "step_seconds": median(seconds),
        "newton_iterations": sum(iterations) / len(iterations),
        "seconds_per_iteration": sum(seconds) / sum(iterations),
        "phases": {name: median(each[name] for each in phases) for name in phases[0]},
        "memory_mb": total,
        "tool_force": [float(value) for value in method.record.tool_force],
    }
    print(json.dumps(found))


if __name__ == "__main__":
    main()
