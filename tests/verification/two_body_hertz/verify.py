"""Contact half-width and peak pressure of two elastic bodies against the load, for meshes and kinds of contact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Run, Table, run, save_picture, write_results
from ..hertz.reference import beside_hertz
from .reference import half_width, peak_pressure

FOLDER = Path(__file__).parent
RADIUS = 10.0
PLANE, CYLINDER = (200.5e3, 0.3), (600e3, 0.22)
"""Young's modulus (MPa) and Poisson's ratio."""


def pressed(
    fine: float,
    coarser: float = 1.0,
    points: str = "nodes",
    smooth: bool = True,
    swap: bool = False,
    penalty: float = 1e9,
    steps: int = 10,
) -> Run:
    """Run with the spacing ``fine`` (mm) in the contact, ``coarser`` times that on the cylinder.

    ``swap`` makes the cylinder the slave.
    """

    def change(table: Table) -> None:
        table["mesh"]["size"] = 0.5 * max(fine / 0.005, 1.0)
        zone = table["mesh"]["refine"][0]
        zone.update(size=fine, growth=min(zone["growth"] * fine / 0.005, 0.8))
        contact = table["contact"][0]
        contact.update(penalty=penalty, points=points, smooth=smooth)
        if swap:
            contact["slave"], contact["master"] = contact["master"], contact["slave"]
        table["time"]["step"] = table["time"]["end"] / steps
        table["body"][1]["coarser"] = coarser

    def each_step(method: PfemMethod, row: Table) -> None:
        frame = method.frame()
        points = method.current.mesh.points
        x, pressure = points[frame.contact.particles, 0], frame.contact.pressure
        row["load"] = 2.0 * abs(row["reaction_bottom_y"])
        row["last_loaded"] = float(x.max(initial=0.0))
        # The distribution as a whole: p^2 = p0^2 (1 - x^2 / a^2) is a straight line in x^2.
        inner = x < 0.9 * row["last_loaded"]
        if inner.sum() > 2:
            slope, top = np.polyfit(x[inner] ** 2, pressure[inner] ** 2, 1)
            row["half_width"], row["peak"] = float(np.sqrt(-top / slope)), float(np.sqrt(top))
            fitted = np.sqrt(np.maximum(top + slope * x[inner] ** 2, 0.0))
            row["scatter"] = float(np.abs(pressure[inner] - fitted).max() / row["peak"])

    return run(FOLDER / "case.toml", change, each_step)


def row_of(result: Run) -> dict[str, Any]:
    """Measured figures beside Hertz's at the same load."""
    history = result.history
    load = float(history["load"][-1])
    a, p0 = half_width(load, RADIUS, PLANE, CYLINDER), peak_pressure(load, RADIUS, PLANE, CYLINDER)
    return {
        "nodes": result.nodes,
        **beside_hertz(history, a, p0),
        "scatter": float(history["scatter"][-1]),
        "iterations": int(history["newton_iterations"].sum()),
    }


def main() -> None:
    """All variants, the table and the picture."""
    rows, results = [], []
    for given in (
        {"fine": 0.02},
        {"fine": 0.01},
        {"fine": 0.005},
        {"fine": 0.0025},
        {"fine": 0.005, "smooth": False},
        {"fine": 0.005, "points": "edges"},
        {"fine": 0.005, "points": "edges", "smooth": False},
        {"fine": 0.005, "coarser": 1.6},
        {"fine": 0.005, "coarser": 1.6, "points": "edges"},
        {"fine": 0.005, "coarser": 1.6, "points": "edges", "smooth": False},
        {"fine": 0.008, "coarser": 0.625},
        {"fine": 0.008, "coarser": 0.625, "points": "edges"},
        {"fine": 0.005, "swap": True},
        {"fine": 0.005, "penalty": 4e7},
    ):
        result = pressed(**given)
        variant = {"coarser": 1.0, "points": "nodes", "smooth": True, "swap": False, "penalty": 1e9, **given}
        rows.append(
            {**{k: str(v) if isinstance(v, bool) else v for k, v in variant.items()}, **row_of(result)}
        )
        print(rows[-1], flush=True)
        results.append(result)
    fine = rows[3]
    figures = {
        "half_width": {"value": fine["a"], "reference": fine["a_hertz"], "unit": "mm"},
        "peak_pressure": {"value": fine["p0"], "reference": fine["p0_hertz"], "unit": "MPa"},
    }
    write_results(FOLDER, rows, figures)
    picture(results[2], rows[2])


def picture(result: Run, row: dict[str, Any]) -> None:
    """Von Mises stress in both bodies, and the pressure over the contact."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    frame = result.method.frame()
    (other,) = frame.others
    top = max(frame.cell_fields["von_mises"].max(), other.cell_fields["von_mises"].max())
    for each in (frame, other):
        left.tripcolor(
            *each.points.T, each.cells, each.cell_fields["von_mises"], cmap="viridis", vmin=0.0, vmax=top
        )
    left.set(xlim=(0, 0.3), ylim=(-0.25, 0.25), aspect="equal", xlabel="x (mm)", title="von Mises stress")
    x = np.linspace(0.0, row["a_hertz"], 400)
    right.plot(x, row["p0_hertz"] * np.sqrt(1.0 - (x / row["a_hertz"]) ** 2), "k-", lw=0.8, label="Hertz")
    points = result.mesh.points[frame.contact.particles, 0]
    right.plot(points, frame.contact.pressure, ".", label="particles, h = 5 µm")
    right.set(xlabel="x (mm)", ylabel="contact pressure (MPa)", ylim=(0, None))
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
