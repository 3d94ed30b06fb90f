"""Short cuts under mpirun; started by test_two_ranks.py.

    mpirun -n 2 python cut_worker.py DIRECTORY

Rank 0 writes the states of every cut half way and at the end to DIRECTORY: ``NAME_half.npz`` and ``NAME_end.npz``.
From the states that it finds there, ``NAME_start.npz``, it goes on to the end: ``NAME_resumed.npz``. Ends with status 3
if the ranks' states differ in a single bit.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from problems import cut_problem

from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem

State = Mapping[str, NDArray[np.generic]]


def rigid() -> Problem:
    return cut_problem(time={"integrator": "impl-ex"}, contact={"friction": 0.0, "reference_speed": 10.0})


def deformable() -> Problem:
    """A deformable tool with friction, and heat into it."""
    material = {"base": "aisi4340", "hardening": {"law": "elastic"}}
    body = {"material": material, "tip_size": 0.006, "face_size": 0.02, "width": 0.5, "height": 0.5}
    contact = {"friction": 0.3, "reference_speed": 10.0, "conductance": 1e3}
    return cut_problem(tool={"model": "deformable", "body": body}, contact=contact)


def conducting() -> Problem:
    """A rigid tool that conducts heat, with friction."""
    conduction = {
        "conductivity": 100.0,
        "capacity": 0.202e9,
        "density": 14.85e-9,
        "length": 1.0,
        "fine_length": 0.2,
    }
    contact = {"friction": 0.3, "reference_speed": 10.0, "conductance": 1e5}
    return cut_problem(tool={"conduction": conduction}, contact=contact)


@dataclass(frozen=True)
class ShortCut:
    """A cut and half of its number of steps."""

    problem: Callable[[], Problem]
    half: int


CUTS = {
    "rigid": ShortCut(rigid, 10),
    "deformable": ShortCut(deformable, 6),
    "conducting": ShortCut(conducting, 6),
}


def advanced(method: PfemMethod, steps: int) -> State:
    """The state after ``steps`` more steps, and the forces in the last one."""
    for _ in range(steps):
        method.advance()
    return {**method.state(), "tool_force": method.record.tool_force}


def digest(state: State) -> str:
    total = hashlib.sha256()
    for name in sorted(state):
        total.update(np.ascontiguousarray(state[name]).tobytes())
    return total.hexdigest()


def keep(path: Path, state: State) -> None:
    comm = MPI.COMM_WORLD
    if len(set(comm.allgather(digest(state)))) > 1:
        print(f"{path.name}: the ranks' states differ", file=sys.stderr, flush=True)
        comm.Abort(3)
    if comm.rank == 0:
        np.savez(path, **state)


def main() -> None:
    directory = Path(sys.argv[1])
    assert MPI.COMM_WORLD.size == 2
    for name, cut in CUTS.items():
        method = PfemMethod.start(cut.problem())
        keep(directory / f"{name}_half.npz", advanced(method, cut.half))
        keep(directory / f"{name}_end.npz", advanced(method, cut.half))
        resumed = PfemMethod.restore(cut.problem(), np.load(directory / f"{name}_start.npz"))
        keep(directory / f"{name}_resumed.npz", advanced(resumed, cut.half))


if __name__ == "__main__":
    main()
