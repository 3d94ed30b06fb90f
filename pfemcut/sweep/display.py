"""What a waiting user sees of a sweep: a bar a running variant on a terminal, else a line a finished one."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TaskProgressColumn, TextColumn

from pfemcut.method import Measures
from pfemcut.output.directory import HISTORY, SUMMARY
from pfemcut.output.progress import duration, state_text
from pfemcut.results.history import CORE_COLUMNS
from pfemcut.results.summary import figure_mean
from pfemcut.sweep.pool import Watcher
from pfemcut.sweep.prepare import Prepared
from pfemcut.validation.recorded_run import read_summary

INTERVAL = 1.0
"""Seconds between looks at the histories of running variants."""
LOG = "run.log"
_TAIL = 8192


def display(variants: Sequence[Prepared], stream: TextIO | None = None) -> Lines:
    """The display of these variants' runs that suits ``stream`` (standard output if None); a context manager."""
    stream = stream or sys.stdout
    return Bars(variants, stream) if stream.isatty() else Lines(variants, stream)


class Lines(Watcher):
    """One line for each variant that ended.

    Parameters
    ----------
    variants
        The variants that run.
    stream
        Where to write.
    """

    def __init__(self, variants: Sequence[Prepared], stream: TextIO) -> None:
        self._variants = {variant.name: variant for variant in variants}
        self._stream = stream
        self._begun: dict[str, float] = {}
        self._ended = 0

    def started(self, name: str) -> None:
        """Note the time."""
        self._begun[name] = time.monotonic()

    def ended(self, name: str, status: int) -> None:
        """Write the line."""
        self._ended += 1
        took = duration(time.monotonic() - self._begun[name])
        text = ended_text(self._variants[name].directory, status)
        self._write(f"[{self._ended}/{len(self._variants)}] {name}: {text}, {took}")

    def stopping(self) -> None:
        """Say what is waited for."""
        self._write("stopping: runs finish their step and write a checkpoint; a second signal kills them")

    def _write(self, line: str) -> None:
        print(line, file=self._stream, flush=True)

    def __enter__(self) -> Lines:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class Bars(Lines):
    """Bars of the running variants below the lines of the others.

    Parameters
    ----------
    variants
        The variants that run.
    stream
        A terminal.
    """

    def __init__(self, variants: Sequence[Prepared], stream: TextIO) -> None:
        super().__init__(variants, stream)
        self._bars = Progress(
            BarColumn(bar_width=8),
            TaskProgressColumn(),
            TextColumn("{task.description}", markup=False),
            console=Console(file=stream),
        )
        self._all = self._bars.add_task(f"{len(variants)} variants", total=len(variants))
        self._tasks: dict[str, TaskID] = {}
        self._looked = float("-inf")

    def started(self, name: str) -> None:
        """Add a bar."""
        super().started(name)
        self._tasks[name] = self._bars.add_task(f"{name}  starting", total=1.0)

    def ended(self, name: str, status: int) -> None:
        """Remove the bar and write the line."""
        self._bars.remove_task(self._tasks.pop(name))
        super().ended(name, status)
        self._bars.update(self._all, completed=self._ended)

    def passing(self, running: Sequence[str]) -> None:
        """Look at the histories, now and then."""
        if time.monotonic() - self._looked < INTERVAL:
            return
        self._looked = time.monotonic()
        for name in running:
            measures = last_measures(self._variants[name].directory / HISTORY)
            if measures is not None:
                self._bars.update(
                    self._tasks[name],
                    completed=self._variants[name].course.share(measures.time),
                    description=f"{name}  {state_text(measures)}",
                )

    def _write(self, line: str) -> None:
        self._bars.console.print(line, markup=False, highlight=False)

    def __enter__(self) -> Bars:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()


def ended_text(directory: Path, status: int) -> str:
    """How a run with this exit status ended, from what it left in its folder."""
    summary = read_summary(directory) if (directory / SUMMARY).is_file() else {}
    if status == 0:
        forces = (("Fc", "cutting_force"), ("Ft", "thrust_force"))
        shown = [f"{label} {figure_mean(summary, name):.1f}" for label, name in forces if name in summary]
        return " ".join(["finished", *shown, *(["N/mm"] if shown else [])])
    if status == 1 and summary:
        ending = str(summary.get("ending", ""))
        return ending if ending.startswith("stopped") else f"stopped: {ending}"
    last = _last_line(directory / LOG)
    return f"failed with status {status}, see {directory / LOG}{': ' + last if last else ''}"


def last_measures(history: Path) -> Measures | None:
    """The core columns of the last whole row of a history that is being written; None if there is none yet."""
    try:
        with history.open("rb") as file:
            names = file.readline().decode("ascii").rstrip("\n").split(",")
            file.seek(max(file.tell(), history.stat().st_size - _TAIL))
            rows = file.read().decode("ascii").splitlines(keepends=True)
    except (FileNotFoundError, UnicodeDecodeError):
        return None
    # The tail may begin in the middle of a row, and end in one.
    whole = [row for row in rows if row.endswith("\n") and row.count(",") == len(names) - 1]
    if not whole:
        return None
    values = dict(zip(names, map(float, whole[-1].split(",")), strict=True))
    core = {name: values[name] for name in CORE_COLUMNS}
    return Measures(**{**core, "step": int(core["step"]), "nodes": int(core["nodes"])})  # type: ignore[arg-type]


def _last_line(log: Path) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").split("\n") if log.is_file() else []
    return next((line.strip() for line in reversed(lines) if line.strip()), "")
