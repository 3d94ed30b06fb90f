"""Starts a script under mpirun, as a user does from a shell."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parent
LIMIT = 400.0
"""Seconds after which a hang is taken for one; on a busy machine ranks wait long for each other."""


def mpirun(*arguments: str | Path, ranks: int = 2, patience: int = 1) -> subprocess.CompletedProcess[str]:
    """Run Python with ``arguments`` under mpirun and return how it ended.

    Of the seconds of ``patience`` mpirun lets twice as many pass between a signal that ends it and a kill.

    Raises
    ------
    subprocess.TimeoutExpired
        If it hangs.
    """
    # This process may have initialised MPI itself, which leaves traces in the environment.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "ORTE_"))}
    environment |= {"OMP_NUM_THREADS": "1", "PYTHONPATH": str(TESTS.parent)}
    # Ranks that wait give their core away: the machine may have fewer than free ones.
    polite = ["--oversubscribe", "--mca", "mpi_yield_when_idle", "1"]
    patient = ["--mca", "odls_base_sigkill_timeout", str(patience)]
    command = ["mpirun", "--allow-run-as-root", *polite, *patient, "-n", str(ranks), sys.executable]
    return subprocess.run(
        [*command, *map(str, arguments)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
