"""Tables that grow with a run: ``history.csv`` (what the run did) and ``timing.csv`` (how long it took).

Numbers are written with ``repr``, which Python reads back to the same bits, so a resumed run's history can be
compared byte for byte with an uninterrupted one.
"""

from __future__ import annotations

import contextlib
import operator
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from pfemcut.inputs import UserError
from pfemcut.method import Measures
from pfemcut.whole_files import replacing

Array = NDArray[np.float64]
Number = int | float | np.integer | np.floating | np.bool_

CORE_COLUMNS = tuple(field.name for field in fields(Measures))
"""The first columns of ``history.csv``, in order."""


class HistoryError(UserError):
    """A history file that can't be read or continued; the message says why."""


def as_text(value: Number) -> str:
    """``value`` as the shortest text that reads back to the same bits."""
    if isinstance(value, (bool, np.bool_)):
        return str(int(value))
    if isinstance(value, (int, np.integer)):
        return str(operator.index(value))
    return repr(float(value))


def history_row(measures: Measures, own: Mapping[str, Number]) -> dict[str, Number]:
    """One history row: the core columns, then the method's own.

    Parameters
    ----------
    measures
        Core columns.
    own
        The method's own columns.
    """
    row: dict[str, Number] = asdict(measures)
    clash = [name for name in own if name in row]
    if clash:
        raise HistoryError(f"own history columns hide core columns: {', '.join(clash)}")
    return {**row, **own}


class TableWriter:
    """Appends rows to a CSV file; every row is on disk (flushed) before ``append`` returns.

    The first row fixes the columns. A file that holds rows already (a resumed run) fixes them by its header.

    Parameters
    ----------
    path
        The file; appended to if it exists, so truncate it first (:func:`truncate_table`) or remove it.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._columns = _header(path) if path.exists() else ()
        self._file = path.open("a", encoding="ascii", newline="\n")

    def append(self, row: Mapping[str, Number]) -> None:
        """Append one row; its keys must be those of the rows before, in the same order."""
        columns = tuple(row)
        if not self._columns:
            self._columns = columns
            self._file.write(",".join(columns) + "\n")
        elif columns != self._columns:
            odd = sorted(set(columns) ^ set(self._columns)) or ["(the order)"]
            raise HistoryError(f"{self._path}: columns differ from the rows before: {', '.join(odd)}")
        self._file.write(",".join(as_text(value) for value in row.values()) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        # Every row was flushed; what is left is a row that failed and was reported when it did.
        with contextlib.suppress(OSError):
            self._file.close()

    def __enter__(self) -> TableWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def truncate_table(path: Path, last_step: int) -> int:
    """Drop the rows after ``last_step``, and a half-written last line; return the number of rows kept.

    A run that was killed may have rows beyond its checkpoint; resuming repeats those steps. The file is
    replaced at once, so a kill during the truncation loses nothing.
    """
    if not path.exists():
        return 0
    lines = _lines(path)
    kept = [line for line in lines[1:] if line.endswith("\n") and _step(path, line) <= last_step]
    head = [line for line in lines[:1] if line.endswith("\n")]
    with replacing(path) as temporary:
        temporary.write_text("".join(head + kept), encoding="ascii", newline="\n")
    return len(kept)


def read_table(path: Path) -> dict[str, Array]:
    """Columns by name, each of shape (rows,), of a table; a half-written last row is left out."""
    lines = _lines(path)
    columns = _header(path)
    if len(set(columns)) < len(columns):
        raise HistoryError(f"{path}: a column is there twice")
    rows = [line.rstrip("\n").split(",") for line in lines[1:] if line.endswith("\n")]
    if any(len(row) != len(columns) for row in rows):
        raise HistoryError(f"{path}: a row has not {len(columns)} values")
    try:
        values = np.array([[float(text) for text in row] for row in rows], dtype=np.float64)
    except ValueError as error:
        raise HistoryError(f"{path}: {error}") from error
    values = values.reshape(len(rows), len(columns))
    return {name: values[:, i].copy() for i, name in enumerate(columns)}


def require_columns(table: Mapping[str, Array], path: Path, *names: str) -> None:
    """Raise :class:`HistoryError` unless the table read from ``path`` has all of the columns ``names``."""
    missing = [name for name in names if name not in table]
    if missing:
        raise HistoryError(f"{path}: has no column '{missing[0]}'")


def _lines(path: Path) -> list[str]:
    """Its lines with their ends, of which the last may lack its own.

    Raises
    ------
    HistoryError
        If it can't be read as text.
    """
    try:
        with path.open(encoding="ascii", newline="\n") as file:
            return file.readlines()
    except (OSError, UnicodeDecodeError) as error:
        raise HistoryError(f"{path}: can't be read: {error}") from error


def _header(path: Path) -> tuple[str, ...]:
    line = next(iter(_lines(path)), "")
    return tuple(line.rstrip("\n").split(",")) if line.endswith("\n") else ()


def _step(path: Path, line: str) -> int:
    try:
        return int(line.split(",", 1)[0])
    except ValueError as error:
        raise HistoryError(f"{path}: a row doesn't begin with a step number: {line[:40]!r}") from error
