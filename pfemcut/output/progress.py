"""What a waiting user sees: travel, time to go, forces and highest temperature.

On a terminal a live line; elsewhere (a log file, a batch queue, under mpirun) a plain line every few seconds.
"""

from __future__ import annotations

import contextlib
import math
import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Protocol, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from pfemcut.launcher import launched
from pfemcut.method import Measures
from pfemcut.problem.course import Course

PLAIN_INTERVAL = 5.0
PLAIN_INTERVAL_LATER = 60.0
_PART = 0.05  # of the time that a run has taken, between lines: a log of a long run stays short


class ProgressDisplay(Protocol):
    """Shows the state of a run; a context manager around it."""

    def show(self, measures: Measures) -> None:
        """Show the state after a step."""

    def __enter__(self) -> ProgressDisplay: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def progress_display(
    course: Course, stream: TextIO | None = None, *, visible: bool = True
) -> ProgressDisplay:
    """Return the display that suits ``stream`` (standard output if None).

    Parameters
    ----------
    course
        How far the run is at each time.
    stream
        Where to show it. Under mpirun it is no terminal, even if it says so: Open MPI's mpirun gives its processes a
        pseudo-terminal, whatever its own output is.
    visible
        False for the silent display of all ranks but the first.
    """
    if not visible:
        return Silent()
    stream = stream or sys.stdout
    return Live(course, stream) if stream.isatty() and not launched() else PlainLines(course, stream)


def state_text(measures: Measures) -> str:
    """Return travel, forces and highest temperature; short enough for a terminal of 80 columns."""
    if math.isnan(measures.max_temperature):
        # No heat, no tool.
        return f"travel {measures.travel:.4f} mm"
    return (
        f"travel {measures.travel:.4f} mm  Fc {measures.cutting_force:.1f} Ft {measures.thrust_force:.1f} N/mm  "
        f"Tmax {measures.max_temperature:.0f} K"
    )


def state_line(measures: Measures) -> str:
    """Return the state of a run in one line of a log."""
    return f"{state_text(measures)}  {measures.nodes} particles  step {measures.step}"


def remaining(begun: float, now: float, first: float, present: float) -> float:
    """Return the wall time to go (s), at the mean pace since the run began or was resumed; inf at first.

    Parameters
    ----------
    begun, now
        Wall clock at the first time and now (s).
    first, present
        Part of the run that was done at the first time and is now.
    """
    if present <= first:
        return float("inf")
    return max(1.0 - present, 0.0) * (now - begun) / (present - first)


def duration(seconds: float) -> str:
    """Return seconds as h:mm:ss, or ``?`` if unknown."""
    if seconds == float("inf"):
        return "?"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"


class _Pace:
    """The pace of the run since its first step here, for the time to go."""

    def __init__(self, course: Course, clock: Callable[[], float]) -> None:
        self._course = course
        self._clock = clock
        self._first: tuple[float, float] | None = None

    def to_go(self, time: float) -> str:
        now, present = self._clock(), self._course.share(time)
        if self._first is None:
            self._first = (now, present)
        begun, first = self._first
        return duration(remaining(begun, now, first, present))


class Silent:
    """Shows nothing."""

    def show(self, measures: Measures) -> None:
        """Show nothing."""

    def __enter__(self) -> Silent:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class PlainLines(Silent):
    """One line every few seconds, later every minute, and the last state at the end.

    Parameters
    ----------
    course
        How far the run is at each time.
    stream
        Where to write.
    interval
        Seconds between lines at first.
    clock
        Wall clock; another one for tests.
    """

    def __init__(
        self,
        course: Course,
        stream: TextIO,
        interval: float = PLAIN_INTERVAL,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._stream = stream
        self._interval = interval
        self._clock = clock
        self._pace = _Pace(course, clock)
        self._begun = clock()
        self._last_line = float("-inf")
        self._unshown = ""

    def show(self, measures: Measures) -> None:
        """Write a line if the last one is old enough."""
        self._unshown = f"{state_line(measures)}  to go {self._pace.to_go(measures.time)}"
        now = self._clock()
        patience = max(self._interval, min(_PART * (now - self._begun), PLAIN_INTERVAL_LATER))
        if now - self._last_line >= patience:
            self._write()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._unshown:
            self._write()

    def _write(self) -> None:
        # A reader that left, or a full disk under the log, is no reason to end the run.
        with contextlib.suppress(OSError):
            print(self._unshown, file=self._stream, flush=True)
        self._last_line, self._unshown = self._clock(), ""


class Live:
    """A progress bar with the state of the run.

    Parameters
    ----------
    course
        How far the run is at each time.
    stream
        A terminal.
    """

    def __init__(self, course: Course, stream: TextIO) -> None:
        self._course = course
        self._pace = _Pace(course, time.monotonic)
        self._bar = Progress(
            BarColumn(bar_width=8),
            TaskProgressColumn(),
            TextColumn("{task.description}"),
            TextColumn("to go {task.fields[to_go]}"),
            console=Console(file=stream),
        )
        self._task = self._bar.add_task("starting", total=1.0, to_go="?")

    def show(self, measures: Measures) -> None:
        """Update the bar."""
        self._bar.update(
            self._task,
            completed=self._course.share(measures.time),
            description=state_text(measures),
            to_go=self._pace.to_go(measures.time),
        )

    def __enter__(self) -> Live:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
