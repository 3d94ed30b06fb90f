"""The output directory: its file names, and the promise that a new run never destroys an old one unasked."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pfemcut.inputs import UserError
from pfemcut.output.vtu import COLLECTION, FOLDER
from pfemcut.results.checkpoint import NAME, PREVIOUS

HISTORY = "history.csv"
TIMING = "timing.csv"
SUMMARY = "summary.json"
INPUTS = "inputs.resolved.toml"
FIGURES = "figures"
REPORT = "report.html"
CONTACT = "contact.csv"
PROFILES = "tool_profiles.csv"
RESIDUAL = "residual.csv"

OURS = (
    HISTORY,
    TIMING,
    SUMMARY,
    INPUTS,
    FIGURES,
    REPORT,
    CONTACT,
    PROFILES,
    RESIDUAL,
    COLLECTION,
    FOLDER,
    NAME,
    PREVIOUS,
)


class OutputError(UserError):
    """An output directory that can't be used or written; the message says why."""


def remove_conclusions(directory: Path) -> None:
    """Remove what the end of an earlier run concluded: summary, tables, report and figures."""
    with writing(directory):
        for name in (SUMMARY, REPORT, PROFILES, RESIDUAL):
            (directory / name).unlink(missing_ok=True)
        shutil.rmtree(directory / FIGURES, ignore_errors=True)


def prepare_directory(directory: Path, *, resume: bool, overwrite: bool) -> None:
    """Make ``directory`` ready for a run.

    A fresh run needs a directory without results of another run; other files in it don't matter and stay.

    Parameters
    ----------
    directory
        The output directory; made if missing.
    resume
        Whether the run goes on from the results there.
    overwrite
        Whether a fresh run may remove the results of an earlier one (only the files that a run writes).

    Raises
    ------
    OutputError
        If the directory holds results and neither ``resume`` nor ``overwrite`` is set, or can't be written.
    """
    with writing(directory):
        if directory.exists() and not directory.is_dir():
            raise OutputError(f"{directory}: is a file, not a directory")
        if resume and not directory.is_dir():
            raise OutputError(f"{directory}: there is no run to resume")
        found = [name for name in OURS if (directory / name).exists()]
    if found and not resume and not overwrite:
        raise OutputError(
            f"{directory}: holds the results of another run ({', '.join(found[:3])} ...); "
            "resume it, choose another directory, or ask to overwrite it"
        )
    with writing(directory):
        directory.mkdir(parents=True, exist_ok=True)
        # Say so now, not after the first hundred steps.
        with tempfile.TemporaryFile(dir=directory):
            pass
        if not resume:
            for name in found:
                _remove(directory / name)


@contextmanager
def writing(directory: Path) -> Iterator[None]:
    """Turn the errors of a full disk or a read-only directory into one clear line."""
    try:
        yield
    except ValueError as error:
        if "embedded null" not in str(error):
            raise
        raise OutputError(f"{str(directory)!r}: can't be written: its name has a zero byte") from error
    except OSError as error:
        raise OutputError(
            f"{error.filename or directory}: can't be written: {error.strerror or error}"
        ) from error


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink()
