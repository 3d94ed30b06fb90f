"""Stress between two blocks whose meshes do not match, for kinds of contact and ratios of the spacings."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from ..common import Run, Table, run, save_picture, write_results

FOLDER = Path(__file__).parent
MASTER = 0.1
"""Spacing of the lower block (mm)."""


def pressed(slave: float = 0.07, points: str = "edges", smooth: bool = False) -> Run:
    """Run with the spacing ``slave`` (mm) on the upper block."""

    def change(table: Table) -> None:
        table["contact"][0].update(points=points, smooth=smooth)
        table["mesh"]["size"] = MASTER
        table["body"][1]["coarser"] = slave / MASTER

    return run(FOLDER / "case.toml", change)


def stresses(result: Run) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Vertical stress (MPa) of all elements, and the contact pressure of the particles."""
    frame = result.method.frame()
    every = [frame.cell_fields, *(each.cell_fields for each in frame.others)]
    return np.concatenate([each["cauchy_stress"][:, 1] for each in every]), frame.contact.pressure


def main() -> None:
    """All variants and the picture."""
    rows, results = [], []
    for points, smooth in (("edges", False), ("nodes", False), ("edges", True), ("nodes", True)):
        for slave in (0.1, 0.07, 0.03, 0.15, 0.3):
            result = pressed(slave, points, smooth)
            stress, pressure = stresses(result)
            uniform = float(abs(result.history["reaction_bottom_y"][-1]))
            imbalance = result.history["reaction_bottom_y"][-1] + result.history["reaction_top_y"][-1]
            rows.append(
                {
                    "points": points,
                    "smooth": str(smooth),
                    "slave": slave,
                    "master": MASTER,
                    "loaded": len(pressure),
                    "stress_spread": float(np.ptp(stress) / uniform),
                    "pressure_spread": float(np.ptp(pressure) / uniform),
                    "force_imbalance": float(abs(imbalance) / uniform),
                    "iterations": int(result.history["newton_iterations"].sum()),
                }
            )
            print(rows[-1], flush=True)
            results.append(result)
    nodes = [row for row in rows[5:10] if row["slave"] < MASTER]
    figures = {
        "largest_spread": {"value": max(row["stress_spread"] for row in rows[:5]), "unit": "1"},
        "largest_spread_of_nodes": {"value": max(row["stress_spread"] for row in nodes), "unit": "1"},
        "largest_imbalance": {"value": max(row["force_imbalance"] for row in rows), "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(results[6], results[1])


def picture(nodes: Run, edges: Run) -> None:
    """Vertical stress with either kind of contact."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    for each, result, title in zip(axes, (nodes, edges), ("nodes to segments", "edges"), strict=True):
        frame = result.method.frame()
        reference = abs(result.history["reaction_bottom_y"][-1])
        for body in (frame, *frame.others):
            stress = body.cell_fields["cauchy_stress"][:, 1] / reference
            image = each.tripcolor(
                *body.points.T, body.cells, stress, cmap="coolwarm", vmin=-1.15, vmax=-0.85
            )
            each.triplot(*body.points.T, body.cells, color="k", lw=0.2)
        each.set(aspect="equal", title=f"{title}: vertical stress over the mean")
    figure.colorbar(image, ax=axes)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
