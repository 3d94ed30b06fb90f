"""The state of a run as its output directory tells it."""

from __future__ import annotations

import json
import math
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import InputError, UserError
from pfemcut.output.directory import HISTORY, INPUTS, SUMMARY, TIMING
from pfemcut.output.requests import asked
from pfemcut.output.vtu import FieldsError, read_collection
from pfemcut.problem.course import Course, straight
from pfemcut.results.checkpoint import NAME as CHECKPOINT
from pfemcut.watch.tail import TableTail

Array = NDArray[np.float64]

COLUMNS = (
    "step",
    "time",
    "travel",
    "cutting_force",
    "thrust_force",
    "max_temperature",
    "max_eqps",
    "energy_error",
    "nodes",
    "newton_iterations",
    "dt",
)
RECENT = 200
"""Rows from which the pace is taken."""

PATIENCE = 60.0
"""Seconds without a new step after which a run is called silent, unless its steps take as long."""


class Status(Enum):
    """How a run is."""

    STARTING = "starting"
    RUNNING = "running"
    SILENT = "silent"
    ENDED = "ended"


@dataclass(frozen=True)
class RunState:
    """A run at the moment.

    Attributes
    ----------
    title
        Title of the case.
    status, words
        How it is, and the same in a sentence.
    share
        Part of the run that is done, 0 to 1, with what comes after the cut; nan if the case doesn't say.
    to_go
        Wall time to go (s) at the present pace; nan if unknown.
    latest
        Last row of the history, of the columns that are followed.
    travel_end
        Travel at the end (mm); nan without a cut.
    frame
        Step of the last frame of fields; -1 without one.
    checkpoint_age
        Seconds since the last checkpoint; nan without one.
    requests
        What is asked of it and not done yet.
    warnings
        Of the summary of a run that ended.
    """

    title: str
    status: Status
    words: str
    share: float
    to_go: float
    latest: dict[str, float]
    travel_end: float
    frame: int
    checkpoint_age: float
    requests: tuple[str, ...]
    warnings: tuple[str, ...]


class RunReader:
    """Reads the state of a run again and again.

    Parameters
    ----------
    directory
        Output directory of a run.
    clock
        Wall clock that fits the files' times (s since the epoch); another one for tests.

    Raises
    ------
    InputError
        If there is no run.
    """

    def __init__(self, directory: Path, clock: Callable[[], float] = time.time) -> None:
        if not (directory / INPUTS).is_file():
            raise InputError([f"{directory}: no run here ({INPUTS} is missing)"])
        try:
            given = tomllib.loads((directory / INPUTS).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError([f"{directory / INPUTS}: can't be read ({error})"]) from error
        self.directory = directory
        self.title = str(given.get("title", ""))
        self._clock = clock
        self._course, self._travel_end = _course(given, directory), _travel_end(given)
        self._history = TableTail(directory / HISTORY, COLUMNS)
        self._timing = TableTail(directory / TIMING, ("step", "total"))

    def history(self) -> dict[str, Array]:
        """Return the history so far, of the columns that are followed."""
        self._history.update()
        return self._history.columns()

    def state(self) -> RunState:
        """Return the state now."""
        history = self.history()
        self._timing.update()
        timing = self._timing.columns()
        steps = history.get("step", np.zeros(0)).size
        latest = {name: float(values[-1]) for name, values in history.items()} if steps else {}
        summary = self._summary()
        pace = _pace(history, timing, self._course)
        status, words = self._status(summary, steps > 0, timing)
        done = self._course.share(latest.get("time", 0.0))
        return RunState(
            title=self.title,
            status=status,
            words=words,
            share=done,
            to_go=(1.0 - done) * pace if status is Status.RUNNING and done < 1.0 else math.nan,
            latest=latest,
            travel_end=self._travel_end,
            frame=self._frame(),
            checkpoint_age=self._age(CHECKPOINT),
            requests=tuple(request.name.lower() for request in asked(self.directory)),
            warnings=tuple(map(str, summary.get("warnings", ()))),
        )

    def _status(self, summary: dict[str, Any], begun: bool, timing: dict[str, Array]) -> tuple[Status, str]:
        if summary:
            how = "finished" if summary.get("finished") else "not finished"
            return Status.ENDED, f"{how}: {summary.get('ending', '')}"
        if not begun:
            return Status.STARTING, "starting; no step is done yet"
        # The timing has a row a step, the history perhaps not.
        ages = [age for age in (self._age(TIMING), self._age(HISTORY)) if not math.isnan(age)]
        age = min(ages, default=math.nan)
        recent = timing.get("total", np.zeros(0))[-RECENT:]
        if age > max(PATIENCE, 10.0 * float(recent.max(initial=0.0))):
            return Status.SILENT, f"no step for {age:.0f} s: killed, stopped, or in a very long step"
        return Status.RUNNING, "running"

    def _summary(self) -> dict[str, Any]:
        """The summary, if the run has ended: a history that goes on after it was written says that it hasn't."""
        try:
            written = (self.directory / SUMMARY).stat().st_mtime
            if (self.directory / HISTORY).stat().st_mtime > written:
                return {}
            return dict(json.loads((self.directory / SUMMARY).read_text(encoding="utf-8")))
        except (OSError, ValueError):
            return {}

    def _frame(self) -> int:
        try:
            return max((entry.step for entry in read_collection(self.directory)), default=-1)
        except FieldsError:
            return -1

    def _age(self, name: str) -> float:
        try:
            return max(self._clock() - (self.directory / name).stat().st_mtime, 0.0)
        except OSError:
            return math.nan


def _course(given: dict[str, Any], directory: Path) -> Course:
    """How far the run of a resolved case is at each time; nan throughout if it doesn't say."""
    try:
        return problem_of(*validated(given, directory), directory).course
    except UserError:
        pass  # A case of another version.
    cutting, clock = given.get("cutting", {}), given.get("time", {})
    try:
        if "travel" in cutting and "speed" in cutting:
            return straight(float(cutting["travel"]) / float(cutting["speed"]))
        return straight(float(clock["end"]))
    except (TypeError, ValueError, KeyError, ZeroDivisionError):
        return Course((0.0, 1.0), (math.nan, math.nan))


def _travel_end(given: dict[str, Any]) -> float:
    """Travel (mm) at the end; nan without a cut."""
    try:
        return float(given["cutting"]["travel"])
    except (TypeError, ValueError, KeyError):
        return math.nan


def _pace(history: dict[str, Array], timing: dict[str, Array], course: Course) -> float:
    """Wall seconds for the whole of the run at the pace of the recent steps; nan if unknown."""
    steps, times = history.get("step", np.zeros(0)), history.get("time", np.zeros(0))
    if steps.size < 2 or times.size != steps.size or "total" not in timing:
        return math.nan
    first = max(0, steps.size - RECENT - 1)
    within = (timing["step"] > steps[first]) & (timing["step"] <= steps[-1])
    done = float(np.diff(course.shares_at(times[[first, -1]]))[0])
    return float(timing["total"][within].sum()) / done if done > 0.0 else math.nan
