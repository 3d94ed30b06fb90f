"""What the verification problems share: the run of a varied case, norms, and the files they leave in ``results``."""

from __future__ import annotations

import csv
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.pfem.kinematics import lumped
from pfemcut.pfem.method import PfemMethod
from pfemcut.validation.provenance import commit

matplotlib.use("Agg")

Array = NDArray[np.float64]
Table = dict[str, Any]


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

    @property
    def nodes(self) -> int:
        return len(self.mesh.points)

    @property
    def newton(self) -> float:
        """Mean linear solves a step."""
        return float(self.history["newton_iterations"].mean())

    @property
    def seconds(self) -> float:
        return float(self.history["wall_time"][-1])


def run(
    case_file: Path,
    change: Callable[[Table], None] | None = None,
    each_step: Callable[[PfemMethod, Table], None] | None = None,
) -> Run:
    """Run a case file after ``change`` edited its table; ``each_step`` may add columns to a step's row."""
    table = read_toml(case_file)
    if change is not None:
        change(table)
    case, material = validated(table, case_file.parent)
    started = time.perf_counter()
    method = PfemMethod.start(problem_of(case, material, case_file.parent))
    rows: list[Table] = []
    while not method.finished:
        method.advance()
        row = {**vars(method.measure()), **method.own_measures(), "wall_time": time.perf_counter() - started}
        if each_step is not None:
            each_step(method, row)
        rows.append(row)
    return Run(method, {name: np.array([row.get(name, np.nan) for row in rows]) for name in _columns(rows)})


def set_keys(table: Table, keys: Mapping[str, Any]) -> None:
    """Set values at dotted keys; a number in a key is the place in a list."""
    for key, value in keys.items():
        *path, last = (int(name) if name.isdigit() else name for name in key.split("."))
        inside: Any = table
        for name in path:
            inside = inside[name]
        inside[last] = value


def weights(mesh: Mesh) -> Array:
    """Area of each particle (mm²)."""
    return lumped(signed_areas(mesh.points, mesh.cells), mesh.cells, len(mesh.points))


def norms(mesh: Mesh, error: Array, inside: NDArray[np.bool_]) -> tuple[float, float]:
    """Root mean square (weighted by particle areas) and maximum of a nodal error over the particles ``inside``."""
    area, values = weights(mesh)[inside], error[inside]
    return float(np.sqrt(area @ values**2 / area.sum())), float(np.abs(values).max())


def orders(steps: Sequence[float], errors: Sequence[float]) -> list[float]:
    """Observed order of convergence between successive rows; the first is nan."""
    s, e = np.log(np.asarray(steps)), np.log(np.abs(errors))
    return [float("nan"), *map(float, np.diff(e) / np.diff(s))]


def write_results(folder: Path, rows: Sequence[Mapping[str, Any]], figures: Mapping[str, Any]) -> None:
    """Write ``results/convergence.csv`` and ``results/summary.json``, which says where it comes from."""
    write_table(folder / "results" / "convergence.csv", rows)
    origin = {
        "command": f"python -m tests.verification.{folder.name}.verify",
        "date": date.today().isoformat(),
        **commit(),
    }
    text = json.dumps(_rounded({**origin, **figures}), indent=2)
    (folder / "results" / "summary.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def write_table(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write ``rows`` as CSV, numbers to six digits, nothing where a row lacks a column."""
    file.parent.mkdir(exist_ok=True)
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, _columns(rows), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()})


def save_picture(folder: Path, figure: Any) -> None:
    """Save ``results/NAME.png`` with few colours, so that it stays small."""
    from PIL import Image

    path = folder / "results" / f"{folder.name}.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=90)
    Image.open(path).convert("RGB").quantize(96).save(path, optimize=True)
    print(path, path.stat().st_size // 1024, "KiB")


def _columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row))


def _rounded(content: Any) -> Any:
    """``content`` with numbers to six digits."""
    if isinstance(content, Mapping):
        return {key: _rounded(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_rounded(value) for value in content]
    if isinstance(content, np.generic):
        content = content.item()
    if isinstance(content, float):
        return float(f"{content:.6g}") if np.isfinite(content) else None
    return content
