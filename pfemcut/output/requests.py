"""What can be asked of a run while it goes on: a checkpoint, or to stop.

A request is an empty file in the output directory, which the run looks for after every step; so it works across
machines and without knowing the process. Its disappearance says that the run has done it.
"""

from __future__ import annotations

from enum import Enum
from pathlib import Path

from pfemcut.output.directory import writing


class Request(Enum):
    """A request; the value is the name of its file."""

    CHECKPOINT = "request.checkpoint"
    STOP = "request.stop"


def ask(directory: Path, request: Request) -> None:
    """Ask the run that writes into ``directory``.

    Raises
    ------
    OutputError
        If the directory can't be written.
    """
    with writing(directory):
        (directory / request.value).touch()


def asked(directory: Path) -> tuple[Request, ...]:
    """Return what is asked and not done yet."""
    return tuple(request for request in Request if (directory / request.value).exists())


def done(directory: Path, *requests: Request) -> None:
    """Say that ``requests`` are done, or of no meaning any more."""
    with writing(directory):
        for request in requests:
            (directory / request.value).unlink(missing_ok=True)
