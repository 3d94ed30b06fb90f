"""One run whose sessions (starts and resumptions) are noted beside its results."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from pfemcut.case.load import load_case
from pfemcut.driver import run_case
from pfemcut.output.directory import HISTORY, SUMMARY
from pfemcut.ranks import Ranks
from pfemcut.results.checkpoint import NAME, PREVIOUS
from pfemcut.results.history import read_table
from pfemcut.results.published import write_json
from pfemcut.results.summary import Summary
from pfemcut.validation.provenance import provenance

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
    """Run a case into ``directory``; called by all ranks under MPI.

    A finished run that is resumed costs a second: it only summarises again.
    """
    ranks = Ranks()
    case, material = load_case(case_file, overrides)
    resume = ranks.on_first(
        lambda: start.resume and any((directory / name).exists() for name in (NAME, PREVIOUS))
    )
    note = {**provenance(), "resumed": resume}

    def noted() -> None:
        before = sessions(directory) if resume else []
        write_json(directory / SESSIONS, [*before, note])

    if resume:
        ranks.on_first(noted)
    # A start that was killed before its first checkpoint leaves rows behind; asked to resume, it begins again.
    overwrite = start.overwrite or (start.resume and not resume)
    if not resume:
        ranks.on_first(lambda: _refuse_or_note(directory, overwrite, noted))
    return run_case(case, material, directory, resume=resume, overwrite=overwrite and not resume)


def _refuse_or_note(directory: Path, overwrite: bool, noted: Any) -> None:
    """Note the session, unless the directory holds a run that the driver will refuse to touch."""
    if overwrite or not (directory / HISTORY).exists():
        noted()


def sessions(directory: Path) -> list[dict[str, Any]]:
    """The sessions noted in ``directory``."""
    path = directory / SESSIONS
    return list(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else []


def read_summary(directory: Path) -> dict[str, Any]:
    """Content of the run's ``summary.json``."""
    return dict(json.loads((directory / SUMMARY).read_text(encoding="utf-8")))


def read_history(directory: Path) -> Mapping[str, NDArray[Any]]:
    """Columns of the run's ``history.csv``."""
    return read_table(directory / HISTORY)
