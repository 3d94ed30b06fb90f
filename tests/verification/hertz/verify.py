"""Contact half-width and peak pressure against the load, for three meshes and two penalties."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Run, Table, run, save_picture, write_results
from .reference import beside_hertz, half_width, peak_pressure

FOLDER = Path(__file__).parent
YOUNG, POISSON, RADIUS = 200.5e3, 0.3, 10.0


def pressed(
    fine: float, penalty: float = 1e9, remesh: bool = False, extent: float = 2.0, steps: int = 10
) -> Run:
    """Run with the spacing ``fine`` (mm) under the cylinder, and what was measured in each step."""

    def change(table: Table) -> None:
        table["body"][0]["outline"] = [[0.0, -extent], [extent, -extent], [extent, 0.0], [0.0, 0.0]]
        zone = table["mesh"]["refine"][0]
        table["mesh"].update(size=0.5 * fine / 0.005, remesh=remesh)
        zone.update(size=fine, growth=min(zone["growth"] * fine / 0.005, 0.8))
        table["contact"]["penalty"] = penalty
        table["time"]["step"] = table["time"]["end"] / steps

    def each_step(method: PfemMethod, row: Table) -> None:
        frame = method.frame()
        x, pressure = frame.points[frame.contact.particles, 0], frame.contact.pressure
        row["load"] = 2.0 * row["thrust_force"]
        row["last_loaded"] = float(x.max(initial=0.0))
        # The distribution as a whole: p^2 = p0^2 (1 - x^2 / a^2) is a straight line in x^2.
        inner = x < 0.9 * row["last_loaded"]
        if inner.sum() > 2:
            slope, top = np.polyfit(x[inner] ** 2, pressure[inner] ** 2, 1)
            row["half_width"], row["peak"] = float(np.sqrt(-top / slope)), float(np.sqrt(top))
        row["highest"] = float(pressure.max(initial=0.0))

    return run(FOLDER / "case.toml", change, each_step)


def main() -> None:
    """All meshes, the table and the picture."""
    rows, results = [], []
    for fine, penalty, remesh, extent in (
        (0.02, 1e9, False, 2.0),
        (0.01, 1e9, False, 2.0),
        (0.005, 1e9, False, 2.0),
        (0.0025, 1e9, False, 2.0),
        (0.005, 1e9, True, 2.0),
        (0.005, 4e7, False, 2.0),
        (0.005, 1e10, False, 2.0),
        (0.005, 1e9, False, 4.0),
        (0.005, 1e9, False, 8.0),
    ):
        result = pressed(fine, penalty, remesh, extent)
        history = result.history
        load = float(history["load"][-1])
        a, p0 = half_width(load, RADIUS, YOUNG, POISSON), peak_pressure(load, RADIUS, YOUNG, POISSON)
        rows.append(
            {
                "fine": fine,
                "penalty": penalty,
                "remesh": str(remesh),
                "extent": extent,
                "nodes": result.nodes,
                **beside_hertz(history, a, p0),
                "highest": float(history["highest"][-1]),
                "highest_difference": float(history["highest"][-1]) / p0 - 1.0,
                "iterations": int(history["newton_iterations"].sum()),
            }
        )
        print(rows[-1], flush=True)
        results.append(result)
    fine = rows[3]
    figures = {
        "half_width": {"value": fine["a"], "reference": fine["a_hertz"], "unit": "mm"},
        "peak_pressure": {"value": fine["p0"], "reference": fine["p0_hertz"], "unit": "MPa"},
        "half_width_difference": {"value": fine["a_difference"], "unit": "1"},
        "peak_pressure_difference": {"value": fine["p0_difference"], "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(results[2], rows[2])


def picture(result: Run, row: dict[str, Any]) -> None:
    """Mesh, pressure over the contact, and half-width against load."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.4), layout="constrained")
    frame = result.method.frame()
    left.tripcolor(*frame.points.T, frame.cells, frame.cell_fields["von_mises"], cmap="viridis")
    left.set(xlim=(0, 0.3), ylim=(-0.3, 0.01), aspect="equal", xlabel="x (mm)", title="von Mises stress")
    x = np.linspace(0.0, row["a_hertz"], 400)
    middle.plot(x, row["p0_hertz"] * np.sqrt(1.0 - (x / row["a_hertz"]) ** 2), "k-", lw=0.8, label="Hertz")
    middle.plot(
        frame.points[frame.contact.particles, 0], frame.contact.pressure, ".", label="particles, h = 5 µm"
    )
    middle.set(xlabel="x (mm)", ylabel="contact pressure (MPa)", ylim=(0, None))
    middle.legend(fontsize=7)
    load = np.linspace(1.0, row["load"], 100)
    right.plot(load, [half_width(each, RADIUS, YOUNG, POISSON) for each in load], "k-", lw=0.8, label="Hertz")
    right.plot(result.history["load"], result.history["half_width"], "o", label="fit to the pressure")
    right.plot(result.history["load"], result.history["last_loaded"], "x", label="last loaded particle")
    right.set(xlabel="load (N/mm)", ylabel="half-width (mm)")
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
