"""Starts a script under mpirun, as a user does from a shell."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from mpi4py import MPI

TESTS = Path(__file__).resolve().parent
LIMIT = 400.0
"""Seconds after which a hang is taken for one; on a busy machine ranks wait long for each other."""


OPEN_MPI = "Open MPI" in MPI.Get_library_version()


def launcher() -> list[str]:
    """The command of mpi4py's MPI that starts ranks: it lies beside the interpreter, if MPI is a wheel.

    Ranks that wait give their core away: the machine may have fewer than free ones.
    """
    found = shutil.which("mpirun", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    assert found is not None, "no mpirun"
    if OPEN_MPI:
        return [found, "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1"]
    return [found]


def mpirun(*arguments: str | Path, ranks: int = 2, patience: int = 1) -> subprocess.CompletedProcess[str]:
    """Run Python with ``arguments`` under mpirun and return how it ended.

    Of the seconds of ``patience`` Open MPI's mpirun lets twice as many pass between a signal that ends it and a kill.

    Raises
    ------
    subprocess.TimeoutExpired
        If it hangs.
    """
    # This process may have initialised MPI itself, which leaves traces in the environment.
    traces = ("OMPI_", "PMIX_", "ORTE_", "PRTE_", "PMI_", "HYDRA_")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(traces)}
    environment |= {"OMP_NUM_THREADS": "1", "PYTHONPATH": str(TESTS.parent)}
    command = launcher()
    if OPEN_MPI:
        command += ["--mca", "odls_base_sigkill_timeout", str(patience)]
    return subprocess.run(
        [*command, "-n", str(ranks), sys.executable, *map(str, arguments)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
