"""``contact.csv``: what the particles in contact do to the tool, every tenth step, from which profiles are averaged.

A row is a particle; the rows of one step follow each other. Numbers have seven digits, to keep the table small: it is
there to be averaged. A step without contact is one row of zero length.
"""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pfemcut.results.derived.tool_profiles import ToolLoads
from pfemcut.results.history import read_table

Array = NDArray[np.float64]

EVERY = 10
"""Steps between records."""
COLUMNS = ("step", *(each.name for each in fields(ToolLoads)))


def append_contact(path: Path, step: int, loads: ToolLoads) -> None:
    """Append the ``loads`` of a step, with the header if the file is new."""
    columns = [getattr(loads, name) for name in COLUMNS[1:]]
    rows = np.column_stack(columns) if loads.arc.size else np.zeros((1, len(columns)))
    lines = [",".join([str(step), *(f"{value:.7g}" for value in row)]) for row in rows.tolist()]
    head = [] if path.exists() and path.stat().st_size else [",".join(COLUMNS)]
    with path.open("a", encoding="ascii", newline="\n") as file:
        file.write("\n".join([*head, *lines]) + "\n")


def read_contact(path: Path) -> tuple[Array, list[ToolLoads]]:
    """Steps, rising, and the loads recorded at each; none if there is no such file.

    Raises
    ------
    pfemcut.results.history.HistoryError
        If the file is damaged.
    """
    if not path.exists():
        return np.empty(0), []
    table = read_table(path)
    if not table or not table["step"].size:
        return np.empty(0), []
    steps, first = np.unique(table["step"], return_index=True)
    parts = [np.split(table[name], first[1:]) for name in COLUMNS[1:]]
    return steps, [ToolLoads(*values) for values in zip(*parts, strict=True)]
