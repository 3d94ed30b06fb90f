"""Options that several commands have."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", help="Case file.", show_default=False)]

Jobs = Annotated[
    int | None,
    typer.Option("-j", "--jobs", metavar="N", min=1, help="Runs at a time; all cores if left out."),
]


def jobs_at_a_time(given: int | None) -> int:
    """Number of runs side by side: what ``--jobs`` says, or one for each core that this process may use."""
    return given or len(os.sched_getaffinity(0))


def names_in(text: str) -> list[str]:
    """The names of a list with commas, such as that of ``--figures``."""
    return [name.strip() for name in text.split(",") if name.strip()]
