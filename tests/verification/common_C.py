"""What the verification problems of heat and contact share: running a varied case, tables, summaries, pictures."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.pfem.kinematics import lumped
from pfemcut.pfem.method import PfemMethod

Array = NDArray[np.float64]
Change = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class Run:
    """A finished run: its method (with state and last frame), and its history by column."""

    method: PfemMethod
    history: Mapping[str, Array]

    @property
    def mesh(self) -> Mesh:
        return self.method.current.mesh

    @property
    def temperature(self) -> Array:
        return self.method.current.fields.temperature


def run(case_file: Path, change: Change | None = None, each_step: Change | None = None) -> Run:
    """Run a case file after ``change`` edited its table; ``each_step`` may add columns to a history row."""
    table = deepcopy(read_toml(case_file))
    if change is not None:
        change(table)
    case, material = validated(table, case_file.parent)
    method = PfemMethod.start(problem_of(case, material, case_file.parent))
    rows: list[dict[str, Any]] = []
    while not method.finished:
        method.advance()
        row: dict[str, Any] = {**vars(method.measure()), **method.own_measures()}
        if each_step is not None:
            row["method"] = method
            each_step(row)
            del row["method"]
        rows.append(row)
    names = dict.fromkeys(name for row in rows for name in row)
    return Run(method, {name: np.array([row.get(name, np.nan) for row in rows]) for name in names})


def norms(mesh: Mesh, error: Array, inside: NDArray[np.bool_]) -> tuple[float, float]:
    """Root mean square (weighted by particle areas) and maximum of a nodal error over the particles ``inside``."""
    weights = lumped(signed_areas(mesh.points, mesh.cells), mesh.cells, len(mesh.points))[inside]
    values = error[inside]
    return float(np.sqrt(weights @ values**2 / weights.sum())), float(np.abs(values).max())


def orders(steps: Sequence[float], errors: Sequence[float]) -> list[float]:
    """Observed order of convergence between successive rows; the first is nan."""
    s, e = np.log(np.asarray(steps)), np.log(np.asarray(errors))
    return [float("nan"), *map(float, np.diff(e) / np.diff(s))]


def write_results(folder: Path, rows: Sequence[Mapping[str, Any]], figures: Mapping[str, Any]) -> None:
    """Write ``results/convergence.csv`` and ``results/summary.json``, and print the table."""
    results = folder / "results"
    results.mkdir(exist_ok=True)
    names = list(dict.fromkeys(name for row in rows for name in row))
    short = [{name: _short(row.get(name, "")) for name in names} for row in rows]
    with (results / "convergence.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(short)
    command = f"python tests/verification/{folder.name}/{Path(sys.argv[0]).name}"
    summary = {"command": command, "date": date.today().isoformat(), **figures}
    text = json.dumps(summary, indent=2, default=float)
    (results / "summary.json").write_text(text + "\n")
    for row in [dict(zip(names, names, strict=True)), *short]:
        print("  ".join(f"{row[name]!s:>14}" for name in names))
    print(text)


def _short(value: Any) -> Any:
    return f"{value:.5g}" if isinstance(value, float) else value


def save_picture(folder: Path, figure: Any) -> None:
    """Save ``results/NAME.png`` with few colours, so that it stays small."""
    from PIL import Image

    path = folder / "results" / f"{folder.name}.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=90)
    Image.open(path).convert("RGB").quantize(96).save(path, optimize=True)
    print(path, path.stat().st_size // 1024, "KiB")
