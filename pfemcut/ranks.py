"""What a run needs of MPI: rank 0 reads and writes, all ranks take the same decisions and end together."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, TypeVar, cast

from pfemcut import launcher
from pfemcut.inputs import UserError
from pfemcut.method import RunStopped

Result = TypeVar("Result")

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)
"""Ask a run to stop. mpirun kills its ranks a second after the first two, but hands the third on and waits."""

_FIRST_SPEAKS = 2.0
"""Seconds for which the other ranks leave it to rank 0 to report an error that all of them may have."""


class RanksDiffer(RunStopped):
    """The ranks, which compute the same from the same numbers, came to different results."""


class Ranks:
    """The processes of a run.

    Parameters
    ----------
    communicator
        An mpi4py communicator; the world if None.

    Raises
    ------
    UserError
        If several processes were started, but MPI sees only this one.
    """

    def __init__(self, communicator: Any = None) -> None:
        if communicator is None:
            from mpi4py import MPI

            communicator = MPI.COMM_WORLD
            if communicator.size == 1 < launcher.processes():
                raise UserError(
                    f"started as one of {launcher.processes()} processes, but MPI sees only this one: "
                    "mpirun and mpi4py belong to different MPI libraries"
                )
        self._comm = communicator
        self.first = communicator.rank == 0

    def on_first(self, function: Callable[[], Result]) -> Result:
        """Call ``function`` on rank 0 only; its result, or its error, is that of all ranks.

        Without the error on all ranks, the others would wait for ever in their next collective call.
        """
        result: Any = None
        failure: Exception | None = None
        if self.first:
            try:
                result = function()
            except Exception as error:
                failure = error
        if self._comm.size > 1:
            result, failure = self._comm.bcast((result, _portable(failure)), root=0)
        if failure is not None:
            raise failure
        return cast(Result, result)

    @contextmanager
    def together(self) -> Iterator[None]:
        """End all ranks with the traceback of an error in the block: the others may wait for this one for ever.

        Only what a user can mend and what stops a run go on as they are: all ranks have those, through
        :meth:`on_first` or :meth:`require_same`.
        """
        try:
            yield
        except (UserError, RunStopped):
            raise
        except (Exception, KeyboardInterrupt):
            if self._comm.size > 1:
                if not self.first:
                    time.sleep(_FIRST_SPEAKS)
                print(
                    f"error on rank {self._comm.rank}:\n{traceback.format_exc()}", file=sys.stderr, flush=True
                )
                self._comm.Abort(1)
                os._exit(1)  # MPICH 5 returns, and ends the ranks a moment later
            raise

    def require_same(self, value: object, when: str) -> None:
        """Raise :class:`RanksDiffer`, naming ``when``, on all ranks if ``value`` prints differently on any two."""
        if self._comm.size > 1 and len(set(self._comm.allgather(repr(value)))) > 1:
            raise RanksDiffer(
                f"the ranks came to different results {when}; they need equal processors and libraries"
            )

    def largest(self, value: int) -> int:
        """Return the largest of the ranks' values."""
        return value if self._comm.size == 1 else max(self._comm.allgather(value))


def _portable(failure: Exception | None) -> Exception | None:
    """``failure``, or its words if it can't be sent to other ranks."""
    try:
        pickle.loads(pickle.dumps(failure))
    except Exception:
        return RuntimeError(repr(failure))
    return failure


class SignalNotes:
    """Notes the signals that ask to stop instead of dying, so that the step can be finished; the second one kills.

    A context manager; outside the main thread, where Python can't handle signals, it notes nothing.
    """

    def __init__(self) -> None:
        self._noted = 0
        self._before: dict[signal.Signals, Any] = {}

    @property
    def noted(self) -> int:
        """The signal's number, or zero."""
        return self._noted

    def __enter__(self) -> SignalNotes:
        if threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._note) for number in SIGNALS}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._restore()

    def _note(self, number: int, _: FrameType | None) -> None:
        self._noted = number
        self._restore()

    def _restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before = {}
