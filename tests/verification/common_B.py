"""Runs of general case files in memory, and the small files that a verification problem leaves."""

from __future__ import annotations

import csv
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import load_case
from pfemcut.case.translate import problem_of
from pfemcut.pfem.method import PfemMethod

Array = NDArray[np.float64]


def run(
    path: Path, overrides: Sequence[str] = (), watch: Callable[[PfemMethod], None] | None = None
) -> dict[str, Array]:
    """History of a case by column name, with ``wall_time`` (s); ``watch`` is called after each step."""
    case, material = load_case(path, overrides)
    method = PfemMethod.start(problem_of(case, material, path.parent))
    rows: list[dict[str, float]] = []
    started = time.perf_counter()
    while not method.finished:
        method.advance()
        measures = method.measure()
        core = {
            name: float(getattr(measures, name)) for name in ("time", "nodes", "max_temperature", "max_eqps")
        }
        rows.append({**core, **method.own_measures(), "wall_time": time.perf_counter() - started})
        if watch is not None:
            watch(method)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """A CSV file with one line a row."""
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{x:.6g}" if isinstance(x, float) else x for key, x in row.items()})


def write_summary(path: Path, figures: Mapping[str, Any]) -> None:
    """Figures with the command and the date that gave them."""
    path.parent.mkdir(exist_ok=True)
    command = " ".join(["python", *sys.argv])
    path.write_text(
        json.dumps({"command": command, "date": date.today().isoformat(), **figures}, indent=1) + "\n"
    )
