"""What the driver needs of MPI: rank 0 writes, all ranks take the same decisions, errors included."""

from __future__ import annotations

import pickle
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any, TypeVar, cast

Result = TypeVar("Result")

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Ranks:
    """The processes of a run.

    Parameters
    ----------
    communicator
        An mpi4py communicator; the world if None.
    """

    def __init__(self, communicator: Any = None) -> None:
        if communicator is None:
            from mpi4py import MPI

            communicator = MPI.COMM_WORLD
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

    def abort_others(self) -> None:
        """End all ranks, with the traceback of this one's error, if there are others: they may wait for this one."""
        if self._comm.size > 1:
            traceback.print_exc()
            sys.stderr.flush()
            self._comm.Abort(1)

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
    """Notes SIGINT and SIGTERM instead of dying, so that the step can be finished; the second one kills.

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
