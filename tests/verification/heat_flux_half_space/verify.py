"""Convergence in the spacing and in the step, and the cutting step itself."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from ..common import Array, Run, Table, norms, orders, run, save_picture, write_results
from .reference import backward_euler, exact

FOLDER = Path(__file__).parent
FLUX, CONDUCTIVITY = 2.0e5, 50.0
DIFFUSIVITY = CONDUCTIVITY / (7.844e-9 * 0.46e9)
END = 1.041e-4


def heated(size: float, steps: int, remesh: bool = True) -> Run:
    """Run with spacing ``size`` (mm) and ``steps`` steps."""

    def change(table: Table) -> None:
        table["mesh"].update(size=size, remesh=remesh)
        table["time"]["step"] = END / steps

    return run(FOLDER / "case.toml", change)


def errors(result: Run, reference: Array) -> tuple[float, float, float]:
    """Root mean square, maximum and surface mean of the temperature's error (K)."""
    error = result.temperature - 293.15 - reference
    everywhere = np.ones(len(error), dtype=bool)
    surface = result.mesh.points[:, 1] > -1e-9
    return (*norms(result.mesh, error, everywhere), float(np.mean(error[surface])))


def depth(result: Run) -> Array:
    return -result.mesh.points[:, 1]


def main() -> None:
    """Both ladders, the cutting step, the picture."""
    rows = []
    spacing = (0.02, 0.01, 0.005, 0.0025)
    found = []
    for size in spacing:
        result = heated(size, 50)
        semi = backward_euler(depth(result), 50, END / 50, FLUX, CONDUCTIVITY, DIFFUSIVITY)
        found.append((size, 50, "exact in space, backward Euler", result, errors(result, semi)))
    add(rows, found, spacing)
    steps = (8, 16, 32, 64, 128)
    found = []
    for count in steps:
        result = heated(0.0025, count)
        true = exact(depth(result), END, FLUX, CONDUCTIVITY, DIFFUSIVITY)
        found.append((0.0025, count, "exact", result, errors(result, true)))
    add(rows, found, [END / count for count in steps])
    # The spacing's own error does not change with the step, and drops out of differences on the same mesh.
    fields = [each[3].temperature for each in found]
    differences = [float(np.abs(b - a).max()) for a, b in pairwise(fields)]
    for row, order in zip(rows[-4:-1], orders(steps[:4], differences)[1:], strict=True):
        row["order_of_differences"] = -order
    cut = heated(0.005, 1000)
    true = exact(depth(cut), END, FLUX, CONDUCTIVITY, DIFFUSIVITY)
    add(rows, [(0.005, 1000, "exact, cutting step", cut, errors(cut, true))], [1.0])
    top = float(exact(np.zeros(1), END, FLUX, CONDUCTIVITY, DIFFUSIVITY)[0])
    figures = {
        "surface_rise_exact": {"value": top, "unit": "K"},
        "surface_rise_cutting_step": {"value": top + errors(cut, true)[2], "unit": "K"},
        "heat_error_cutting_step": {"value": float(cut.history["heat_error"][-1]), "unit": "1"},
        "order_in_spacing": {"value": rows[3]["order_rms"], "unit": "1"},
        "order_in_step": {"value": rows[7]["order_of_differences"], "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(cut, rows)


def add(rows: list[dict[str, Any]], found: list[Any], parameters: Any) -> None:
    """Append a ladder's rows, with the observed orders of the rms and the surface error."""
    rms = orders(parameters, [each[4][0] for each in found])
    surface = orders(parameters, [abs(each[4][2]) for each in found])
    for (size, steps, against, result, error), order, order_surface in zip(found, rms, surface, strict=True):
        rows.append(
            {
                "size": size,
                "steps": steps,
                "nodes": result.nodes,
                "rms": error[0],
                "max": error[1],
                "surface": error[2],
                "order_rms": order,
                "order_surface": order_surface,
                "against": against,
            }
        )


def picture(cut: Run, rows: list[dict[str, Any]]) -> None:
    """Profile at the end, and both ladders."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    line = np.linspace(0.0, 0.2, 200)
    left.plot(line, exact(line, END, FLUX, CONDUCTIVITY, DIFFUSIVITY), "k-", label="exact")
    left.plot(depth(cut), cut.temperature - 293.15, ".", ms=3, label="all particles, h = 5 µm, cutting step")
    left.set(xlim=(0, 0.2), xlabel="depth (mm)", ylabel="temperature rise (K)")
    left.legend(fontsize=7)
    for axes, part, key, name, order in (
        (middle, rows[:4], "size", "spacing h (mm)", 2),
        (right, rows[4:9], "steps", "step (s)", 1),
    ):
        x = np.array([row["size"] if key == "size" else END / row["steps"] for row in part])
        for error in ("rms", "max"):
            axes.loglog(x, [row[error] for row in part], "o-", label=error)
        axes.loglog(x, part[0]["rms"] * (x / x[0]) ** order, "k:", label=f"order {order}")
        axes.xaxis.set_minor_formatter("")
        axes.set(xlabel=name, ylabel="error (K)")
        axes.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
