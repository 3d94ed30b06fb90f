"""Tables of results: CSV files, and what a terminal shows of them."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pfemcut.whole_files import replacing

LOG_WIDTH = 160
"""Width of tables (characters) where there is no terminal."""


def or_empty(value: float) -> float | str:
    """``value`` for a cell, which is empty without one."""
    return value if math.isfinite(value) else ""


def write_csv(path: Path, header: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """Write a table, at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def print_table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], texts: int = 0) -> None:
    """Print a table, the first ``texts`` columns aligned to the left."""
    # Names that users chose may look like markup.
    table = Table(title=escape(title), title_justify="left", box=SIMPLE_HEAD)
    for index, name in enumerate(header):
        table.add_column(escape(name), justify="left" if index < texts else "right")
    for row in rows:
        table.add_row(*map(escape, row))
    console = Console()
    if not console.is_terminal:
        console = Console(width=LOG_WIDTH)
    console.print(table)


def number_text(value: str | float) -> str:
    """A number to five digits, nothing for nan, text as it is."""
    if isinstance(value, str):
        return value
    return f"{value:.5g}" if math.isfinite(value) else ""
