"""What a figure of ``summary.json`` is, and how it comes from the history."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Taken(Enum):
    """How a figure comes from its history column."""

    WINDOW = "mean and standard deviation over the steady window"
    LAST = "last row"
    END = "last row, a result rather than a check"
    FRAME = "last frame, after unloading"
    INSTANTS = "mean and standard deviation over the instants recorded in the steady window"


@dataclass(frozen=True)
class Definition:
    """One figure.

    Attributes
    ----------
    name
        Key in ``summary.json`` and, unless the summary or the profiles compute it, column of ``history.csv``.
    label
        What the report calls it.
    unit
        Unit; ``-`` for a pure number.
    meaning
        Definition in one sentence.
    taken
        How it comes from the history, or from the contact records.
    """

    name: str
    label: str
    unit: str
    meaning: str
    taken: Taken = Taken.WINDOW
