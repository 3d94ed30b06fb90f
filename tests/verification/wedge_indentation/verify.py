"""Hardness, contact length and force of the wedge: three meshes, two steps, three stiffnesses, two wedges."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Run, Table, run, save_picture, write_results
from .reference import contact_length, force, pressure

FOLDER = Path(__file__).parent
SHEAR_YIELD = 200.0 / np.sqrt(3.0)
TIP_RADIUS, YOUNG = 0.002, 200.5e3


def indented(
    fine: float,
    semi_angle: float = 60.0,
    steps: int = 100,
    depth: float = 0.1,
    young: float = YOUNG,
    mesh: dict[str, Any] | None = None,
) -> Run:
    """Run with the spacing ``fine`` (mm) near the wedge of ``semi_angle`` (degrees)."""

    def change(table: Table) -> None:
        table["tool"].update(rake=-semi_angle, clearance=90.0 - semi_angle)
        zone = table["mesh"]["refine"][0]
        zone["growth"] = min(zone["growth"] * fine / 0.01, 0.8)
        zone["size"] = fine
        table["mesh"].update(size=0.4 * max(fine / 0.01, 0.5), **(mesh or {}))
        table["time"].update(step=depth / steps, end=depth)
        table["body"][0]["material"]["young_modulus"] = young

    def each_step(method: PfemMethod, row: Table) -> None:
        frame = method.frame()
        x = frame.points[frame.contact.particles, 0]
        row["reach"] = float(x.max(initial=0.0))
        row["face_pressure"] = float(np.median(frame.contact.pressure)) if len(x) else np.nan
        row["hardness"] = row["thrust_force"] / row["reach"] if row["reach"] else np.nan

    return run(FOLDER / "case.toml", change, each_step)


def sharp_depth(travel: float, semi_angle: float) -> float:
    """Depth (mm) of the apex that the rounded wedge would have if it were sharp."""
    return travel + TIP_RADIUS * (1.0 / np.sin(np.radians(semi_angle)) - 1.0)


def measured(result: Run, semi_angle: float) -> dict[str, Any]:
    """Means over the last third of the travel, relative to the slip-line field."""
    history, psi = result.history, np.radians(semi_angle)
    late = history["travel"] > 2.0 / 3.0 * history["travel"][-1]
    travel = history["travel"][late]
    depth = sharp_depth(travel, semi_angle)
    reference = {
        "face_pressure": pressure(psi, SHEAR_YIELD),
        "hardness": pressure(psi, SHEAR_YIELD),
        "force": force(psi, 1.0, SHEAR_YIELD),
        "reach": contact_length(psi, 1.0) * np.sin(psi),
    }
    found = {
        "face_pressure": float(np.mean(history["face_pressure"][late])),
        "hardness": float(np.mean(history["hardness"][late])),
        "force": float(np.mean(2.0 * history["thrust_force"][late] / depth)),
        "reach": float(np.mean(history["reach"][late] / depth)),
    }
    row: dict[str, Any] = {}
    for name, value in found.items():
        row[name], row[f"{name}_slip_line"] = value, float(reference[name])
        row[f"{name}_difference"] = value / float(reference[name]) - 1.0
    row["area_drift_mm2"] = float(result.method.current.ledger.area_drift)
    row["mass_drift"] = float(history["mass_drift"][-1])
    row["energy_error"] = float(history["energy_error"][-1])
    row["step_cuts"] = int(history["step_cuts"][-1])
    return row


def main() -> None:
    """All variants, the table and the picture."""
    rows, results = [], []
    for fine, semi_angle, steps, young in (
        (0.02, 60.0, 100, YOUNG),
        (0.01, 60.0, 100, YOUNG),
        (0.007, 60.0, 100, YOUNG),
        (0.01, 60.0, 200, YOUNG),
        (0.01, 60.0, 100, 10.0 * YOUNG),
        (0.01, 75.0, 100, YOUNG),
        (0.006, 75.0, 100, YOUNG),
        (0.01, 75.0, 100, 4.0 * YOUNG),
    ):
        result = indented(fine, semi_angle, steps, 0.1 if semi_angle == 60.0 else 0.05, young)
        row = {"fine": fine, "semi_angle": semi_angle, "steps": steps, "young": young}
        row["nodes"] = result.nodes
        row |= measured(result, semi_angle)
        row["seconds"] = result.seconds
        rows.append(row)
        results.append(result)
        print(row, flush=True)
    write_results(FOLDER, rows, {"finest": rows[2]})
    picture(results[:3], rows)


def picture(results: list[Run], rows: list[dict[str, Any]]) -> None:
    """Mesh with plastic strain rate at the end, pressure over the face, force against depth."""
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
    psi = np.radians(60.0)
    frame = results[2].method.frame()
    rate = frame.cell_fields["equivalent_plastic_strain_rate"]
    left.tripcolor(*frame.points.T, frame.cells, rate, vmax=float(np.percentile(rate, 98)), cmap="magma_r")
    left.plot(*frame.tool[0].outline(0.4).T, "k-", lw=0.8)
    left.set(xlim=(0, 0.6), ylim=(-0.4, 0.15), aspect="equal", xlabel="x (mm)", title="plastic strain rate")
    middle.axhline(pressure(psi, SHEAR_YIELD), color="k", lw=0.8, label="slip lines")
    for result, row in zip(results, rows, strict=False):
        last = result.method.frame()
        x = last.points[last.contact.particles, 0]
        middle.plot(x, last.contact.pressure, ".", ms=4, label=f"h = {row['fine']:g} mm")
        right.plot(
            result.history["travel"],
            2.0 * result.history["thrust_force"],
            lw=0.8,
            label=f"h = {row['fine']:g} mm",
        )
    middle.set(xlabel="x (mm)", ylabel="pressure on the face (MPa)", ylim=(0, None))
    depth = np.array([0.0, 0.1])
    right.plot(
        depth,
        [force(psi, sharp_depth(each, 60.0), SHEAR_YIELD) for each in depth],
        "k-",
        lw=0.8,
        label="slip lines",
    )
    right.set(xlabel="travel (mm)", ylabel="force (N/mm)")
    middle.legend(fontsize=7)
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
