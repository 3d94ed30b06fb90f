"""One run whose sessions (starts and resumptions) are noted beside its results."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pfemcut.case.load import AnyCase, AnyMaterial, load_case
from pfemcut.driver import run_case
from pfemcut.output.directory import HISTORY, SUMMARY
from pfemcut.ranks import Ranks
from pfemcut.results.checkpoint import NAME, PREVIOUS
from pfemcut.results.history import read_table
from pfemcut.results.summary import Summary
from pfemcut.results.summary_file import SummaryError, read_summary_file, required
from pfemcut.validation.provenance import provenance
from pfemcut.whole_files import write_json

SESSIONS = "sessions.json"


@dataclass(frozen=True)
class Start:
    """How a run starts.

    Attributes
    ----------
    resume
        Go on from the checkpoint in the directory, if there is one.
    overwrite
        Replace the results of an earlier run.
    """

    resume: bool = False
    overwrite: bool = False


def recorded_run(case_file: Path, directory: Path, overrides: Sequence[str], start: Start) -> Summary:
    """Run a case file into ``directory``; see :func:`record_case`."""
    case, material = Ranks().on_first(lambda: load_case(case_file, overrides))
    return record_case(case, material, directory, start, case_file.parent)


def record_case(
    case: AnyCase, material: AnyMaterial, directory: Path, start: Start, base_directory: Path
) -> Summary:
    """Run a case, whose files lie in ``base_directory``, into ``directory``; called by all ranks under MPI.

    A finished run that is resumed costs seconds: it only summarises again, and isn't noted as a session.
    """
    ranks = Ranks()
    resume = ranks.on_first(
        lambda: start.resume and any((directory / name).exists() for name in (NAME, PREVIOUS))
    )
    # A start that was killed before its first checkpoint leaves rows behind; asked to resume, it begins again.
    overwrite = start.overwrite or (start.resume and not resume)
    before = ranks.on_first(lambda: sessions(directory) if resume else [])
    steps = ranks.on_first(lambda: _steps(directory) if resume and is_finished(directory) else 0)
    note = {**provenance(), "resumed": resume}

    def begin() -> None:
        # Not beside a run that the driver is going to refuse to touch.
        if resume or overwrite or not (directory / HISTORY).exists():
            write_json(directory / SESSIONS, [*before, note])

    def end(summary: Summary) -> None:
        if summary.steps != steps:
            return
        write_json(directory / SESSIONS, before)
        made = before[-1]["commit"] if before else "unknown"
        if made != note["commit"]:
            print(f"{directory}: finished before, with commit {made} (--overwrite runs it again)", flush=True)

    ranks.on_first(begin)
    summary = run_case(
        case,
        material,
        directory,
        base_directory=base_directory,
        resume=resume,
        overwrite=overwrite and not resume,
    )
    ranks.on_first(lambda: end(summary))
    return summary


def sessions(directory: Path) -> list[dict[str, Any]]:
    """The sessions noted in ``directory``."""
    path = directory / SESSIONS
    if not path.is_file():
        return []
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise SummaryError(f"{path}: damaged: {error}") from error
    if not isinstance(found, list) or not all(isinstance(each, dict) for each in found):
        raise SummaryError(f"{path}: damaged: is no list of sessions")
    return found


def is_finished(directory: Path) -> bool:
    """Whether the folder holds a run that is finished."""
    return (directory / SUMMARY).is_file() and bool(read_summary(directory).get("finished", False))


def read_summary(directory: Path) -> dict[str, Any]:
    """Content of the run's ``summary.json``.

    Raises
    ------
    SummaryError
        If it is damaged.
    """
    return read_summary_file(directory / SUMMARY)


def read_history(directory: Path) -> Mapping[str, NDArray[Any]]:
    """Columns of the run's ``history.csv``."""
    return read_table(directory / HISTORY)


def _steps(directory: Path) -> int:
    """Steps of the run, from its summary."""
    summary = read_summary(directory)
    required(summary, directory / SUMMARY, "steps")
    return int(summary["steps"]["value"])
