"""Lines for the user; under mpirun only rank 0 speaks."""

from __future__ import annotations

import os
import sys


def say(line: str) -> None:
    """Print a line."""
    if _speaks():
        print(line, flush=True)


def complain(*lines: str) -> None:
    """Print lines of an error."""
    if _speaks():
        for line in lines:
            print(f"pfemcut: {line}", file=sys.stderr)


def _speaks() -> bool:
    """Whether this process is rank 0, told from the launcher's environment (MPI itself is slow to import)."""
    ranks = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID")
    return all(os.environ.get(name, "0") == "0" for name in ranks)
