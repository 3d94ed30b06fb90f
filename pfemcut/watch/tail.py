"""Reads tables that a run is writing, each time only what is new."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pfemcut.results.history import HistoryError

Array = NDArray[np.float64]


class TableTail:
    """Some columns of a CSV file that grows, and is cut shorter when a run is resumed.

    Parameters
    ----------
    path
        The file; it may not be there yet.
    columns
        Names of the columns; those that the file lacks are left out.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._path = path
        self._wanted = tuple(columns)
        self._forget()

    def _forget(self) -> None:
        self._read = 0
        self._header: tuple[str, ...] = ()
        self._rows: list[list[float]] = []
        self._last = b""

    def update(self) -> None:
        """Read what was written since the last time.

        Raises
        ------
        HistoryError
            If a row can't be read.
        """
        try:
            with self._path.open("rb") as file:
                if self._was_rewritten(file.seek(0, 2), file):
                    self._forget()
                file.seek(self._read)
                new = file.read()
        except FileNotFoundError:
            self._forget()
            return
        except OSError as error:
            raise HistoryError(f"{self._path}: can't be read: {error.strerror}") from error
        # A half-written last line is read next time.
        new = new[: new.rfind(b"\n") + 1]
        lines = new.splitlines(keepends=True)
        header = self._header
        if lines and not header:
            header = tuple(lines[0].decode("ascii", "replace").strip().split(","))
            lines = lines[1:]
        places = [header.index(name) for name in self._wanted if name in header]
        try:
            rows = [[float(cells[at]) for at in places] for cells in (line.split(b",") for line in lines)]
        except (ValueError, IndexError) as error:
            raise HistoryError(f"{self._path}: damaged ({error})") from error
        # All or nothing: what was damaged is read again next time.
        self._header = header
        self._rows += rows
        self._read += len(new)
        self._last = lines[-1] if lines else self._last

    def _was_rewritten(self, size: int, file) -> bool:  # type: ignore[no-untyped-def]
        """Whether what was read last isn't there any more."""
        if size < self._read:
            return True
        file.seek(self._read - len(self._last))
        return bool(file.read(len(self._last)) != self._last)

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(name for name in self._wanted if name in self._header)

    def columns(self) -> dict[str, Array]:
        """Return the columns read so far, each of shape (rows,)."""
        values = np.array(self._rows, dtype=np.float64).reshape(len(self._rows), len(self._names))
        return {name: values[:, i] for i, name in enumerate(self._names)}
