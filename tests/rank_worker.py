"""A run of three numbers under mpirun in which something happens; started by test_ranks.py.

mpirun -n 2 python rank_worker.py EVENT DIRECTORY
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import test_driver
from mpi4py import MPI

from pfemcut.method import RunStopped
from pfemcut.output.requests import Request, ask
from pfemcut.validation.options import exit_with

RANK = MPI.COMM_WORLD.rank
STEP = 7  # in which it happens


def on_rank(rank: int, event: Callable[[], None]) -> Callable[[], None]:
    return event if rank == RANK else lambda: None


def raising(error: Exception) -> Callable[[], None]:
    return test_driver.raising(error)


def fill_disk() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, resource.RLIM_INFINITY))


def launcher_process() -> int:
    """Id of mpirun; MPICH's has a process between itself and its ranks."""
    parent = os.getppid()
    name, numbers = Path(f"/proc/{parent}/stat").read_text().split("(", 1)[1].rsplit(")", 1)
    return int(numbers.split()[1]) if name == "hydra_pmi_proxy" else parent


def signalling(number: signal.Signals) -> Callable[[], None]:
    """Send mpirun a signal, and wait until what it makes of it was noted here: that puts the handlers back."""

    def event() -> None:
        noting = signal.getsignal(signal.SIGTERM)
        os.kill(launcher_process(), number)
        while signal.getsignal(signal.SIGTERM) is noting:
            time.sleep(0.01)

    return event


class OtherBits(test_driver.ChaoticMethod):
    """A method whose results differ on rank 1, as on another processor, from the step on."""

    def advance(self) -> None:
        super().advance()
        if self.step == STEP:
            self.x *= 1.0 + 1e-15 * RANK


class FailsToStart(test_driver.ChaoticMethod):
    """A method that does not start on rank 1."""

    def __init__(self, *_: object, **__: object) -> None:
        on_rank(1, raising(ValueError("no start, on purpose")))()
        super().__init__(1)


EVENTS = {
    "nothing": lambda: None,
    "error on rank 1": on_rank(1, raising(ValueError("lost, on purpose"))),
    "error on all ranks": raising(ValueError("lost, on purpose")),
    "stop": raising(RunStopped("no convergence, on purpose")),
    "stop on rank 1": on_rank(1, raising(RunStopped("no convergence, on purpose"))),
    "full disk": on_rank(0, fill_disk),
    "SIGUSR1": on_rank(0, signalling(signal.SIGUSR1)),
    "SIGTERM": on_rank(0, signalling(signal.SIGTERM)),
    "SIGINT": on_rank(0, signalling(signal.SIGINT)),
    "request to stop": on_rank(0, lambda: ask(Path(sys.argv[2]), Request.STOP)),
}
METHODS = {"other bits on rank 1": OtherBits, "no start on rank 1": FailsToStart}


def main() -> None:
    event, directory = sys.argv[1], Path(sys.argv[2])
    test_driver.ChaoticMethod = METHODS.get(event, test_driver.ChaoticMethod)  # type: ignore[misc]
    events = {STEP: EVENTS.get(event, lambda: None)}
    exit_with(lambda _: test_driver.run(directory, events=events).finished)


if __name__ == "__main__":
    main()
