"""Running the verification problems and writing what they found."""

from __future__ import annotations

import csv
import json
import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem

Array = NDArray[np.float64]
Table = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """A finished run: its problem, last state, history columns (with ``time`` and ``dt``) and wall time (s)."""

    problem: Problem
    method: PfemMethod
    history: Mapping[str, Array]
    seconds: float

    @property
    def nodes(self) -> int:
        return len(self.method.current.mesh.points)

    @property
    def newton(self) -> float:
        """Mean linear solves a step."""
        return float(self.history["newton_iterations"].mean())


def case_table(file: Path) -> Table:
    """The case file as a table that can be changed before a run."""
    return tomllib.loads(file.read_text(encoding="utf-8"))


def with_keys(table: Table, keys: Mapping[str, Any]) -> Table:
    """A copy of ``table`` with values at dotted keys; a number in a key is the place in a list."""
    table = deepcopy(table)
    for key, value in keys.items():
        *path, last = (int(name) if name.isdigit() else name for name in key.split("."))
        inside: Any = table
        for name in path:
            inside = inside[name]
        inside[last] = value
    return table


def run(table: Table, folder: Path, watch: Callable[[PfemMethod], None] | None = None) -> Run:
    """Run the case to its end; ``watch`` sees the method after each step."""
    problem = problem_of(*validated(table, folder), folder)
    started = time.perf_counter()
    method = PfemMethod.start(problem)
    rows = []
    while not method.finished:
        method.advance()
        measures = method.measure()
        own = {"time": measures.time, "dt": measures.dt, "energy_error": measures.energy_error}
        rows.append({**own, **method.own_measures()})
        if watch is not None:
            watch(method)
    history = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return Run(problem, method, history, time.perf_counter() - started)


def orders(sizes: Sequence[float], errors: Sequence[float]) -> list[float]:
    """Observed order between each entry and the one before; the first has none."""
    pairs = zip(sizes, sizes[1:], errors, errors[1:], strict=False)
    return [np.nan, *(float(np.log(abs(e0 / e1)) / np.log(h0 / h1)) for h0, h1, e0, e1 in pairs)]


def write_table(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write ``rows`` as CSV, numbers to six digits."""
    file.parent.mkdir(exist_ok=True)
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


def write_summary(folder: Path, figures: Mapping[str, Any]) -> None:
    """Write ``results/summary.json`` with the command that made it and the date."""
    command = f"python -m tests.verification.{folder.name}.verify"
    content = {"command": command, "date": date.today().isoformat(), **figures}
    (folder / "results").mkdir(exist_ok=True)
    text = json.dumps(_rounded(content), indent=2)
    (folder / "results" / "summary.json").write_text(text + "\n", encoding="utf-8")


def _rounded(content: Any) -> Any:
    """``content`` with numbers to six digits."""
    if isinstance(content, Mapping):
        return {key: _rounded(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_rounded(value) for value in content]
    if isinstance(content, float):
        return float(f"{content:.6g}") if np.isfinite(content) else None
    return content
