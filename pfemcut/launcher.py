"""How this process was started, told from the environment alone: MPI itself is slow to import.

Open MPI's mpirun sets OMPI_COMM_WORLD_RANK, MPICH's and Intel's PMI_RANK, Slurm's srun PMI_RANK or PMIX_RANK. Tasks of
srun without MPI have none of them and are runs of their own.
"""

from __future__ import annotations

import os

_RANK = ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")
_SIZE = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")


def launched() -> bool:
    """Whether mpirun or srun started this process."""
    return any(name in os.environ for name in _RANK)


def speaks() -> bool:
    """Whether this process is the one that prints: rank 0, or alone."""
    return all(os.environ.get(name, "0") == "0" for name in _RANK)


def under_mpirun() -> bool:
    """Whether mpirun started this process, alone or with others."""
    return any(name in os.environ for name in _SIZE)


def processes() -> int:
    """Number of processes that were started together."""
    return max(int(os.environ.get(name, "1")) for name in _SIZE)
