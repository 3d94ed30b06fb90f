"""Contact of a body with itself: uniform pressure across a slit, and a notch that closes and slides."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.pfem.method import PfemMethod
from pfemcut.pfem.self_contact import self_contact_search

from ..common import Run, Table, run, save_picture, set_keys, write_results

FOLDER = Path(__file__).parent
ARMS = (0.45, 0.85)
"""Where the patch test is looked at: half an edge of the coarsest mesh from the ends of the slit (mm)."""
YOUNG = 206.9e3


def slit_block(size: float) -> Run:
    """The patch test with a spacing of ``size`` (mm), and a quarter of it as width of the slit."""

    def change(table: Table) -> None:
        width = 0.25 * size
        outline = table["body"][0]["outline"]
        for corner in (2, 3):
            outline[corner][1] = 0.5 - 0.5 * width
        for corner in (4, 5, 6):
            outline[corner][1] = 0.5 + 0.5 * width
        keys = {"thickness": width, "penalty": YOUNG / width}
        set_keys(table, {"mesh.size": size} | {f"contact.self.{key}": value for key, value in keys.items()})

    return run(FOLDER / "patch.toml", change)


def patch_row(size: float) -> Table:
    """Stress in the arms over the exact, uniform one."""
    result = slit_block(size)
    frame, strain = result.method.frame(), 3e-4
    corners = frame.points[frame.cells]
    x = corners.mean(axis=1)[:, 0]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    inside = (ARMS[0] < x) & (x < ARMS[1])
    ratio = frame.cell_fields["cauchy_stress"][inside, 1] / (-YOUNG * strain)
    below, above = result.history["reaction_bottom_y"][-1], result.history["reaction_top_y"][-1]
    return {
        "case": "slit",
        "size": size,
        "largest_error": float(np.abs(ratio - 1.0).max()),
        "mean_error": float(np.average(ratio, weights=area[inside]) - 1.0),
        "force_imbalance": float(abs(below + above) / abs(below)),
        "iterations": int(result.history["newton_iterations"].sum()),
    }


def closing_notch(friction: float, **keys: Any) -> Run:
    """The notch, with the smallest distance of its walls after each step in the history."""

    def distance(method: PfemMethod, row: Table) -> None:
        mesh = method.current.mesh
        (found,) = self_contact_search(problem, mesh, np.zeros_like(mesh.points))
        row["smallest_distance"] = float(found.facing.distance.min(initial=np.inf))
        row["thickness"] = found.rule.thickness

    table = read_toml(FOLDER / "notch.toml")
    changed = {"contact.self.friction": friction} | keys
    set_keys(table, changed)
    problem = problem_of(*validated(table, FOLDER), FOLDER)
    return run(FOLDER / "notch.toml", lambda table: set_keys(table, changed), distance)


def notch_row(friction: float, result: Run) -> Table:
    """What is left of the distance, and the ledgers."""
    history = result.history
    return {
        "case": "notch",
        "friction": friction,
        "smallest_distance": float((history["smallest_distance"] / history["thickness"]).min()),
        "contact_length": float(history["self_contact_length"][-1]),
        "contact_force": float(history["self_contact_force"][-1]),
        "friction_work": float(history["friction_work"][-1] / history["boundary_work"][-1]),
        "energy_error": float(history["energy_error"][-1]),
        "heat_error": float(history["heat_error"][-1]),
        "halved_steps": int(history["step_cuts"][-1]),
        "iterations": int(history["newton_iterations"].sum()),
    }


def main() -> None:
    """All rows and the picture."""
    rows = [patch_row(size) for size in (0.1, 0.07, 0.05, 0.035)]
    notches = {friction: closing_notch(friction) for friction in (0.0, 0.3)}
    rows += [notch_row(*each) for each in notches.items()]
    for row in rows:
        print(row, flush=True)
    figures = {
        "largest_patch_error": {"value": max(row["largest_error"] for row in rows[:4]), "unit": "1"},
        "largest_mean_error": {"value": max(abs(row["mean_error"]) for row in rows[:4]), "unit": "1"},
        "smallest_distance": {"value": min(row["smallest_distance"] for row in rows[4:]), "unit": "1"},
        "largest_energy_error": {"value": max(abs(row["energy_error"]) for row in rows[4:]), "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(slit_block(0.05), notches[0.3])


def picture(slit: Run, notch: Run) -> None:
    """Vertical stress of the slit block, and plastic strain of the closed notch."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained")
    shown: tuple[tuple[Run, str, NDArray[np.float64], tuple[float, float]], ...] = (
        (
            slit,
            "slit: vertical stress over the exact",
            slit.method.frame().cell_fields["cauchy_stress"][:, 1] / (-YOUNG * 3e-4),
            (0.85, 1.15),
        ),
        (
            notch,
            "notch, friction 0.3: equivalent plastic strain",
            notch.method.frame().cell_fields["equivalent_plastic_strain"],
            (0.0, 1.5),
        ),
    )
    for each, (result, title, values, (low, high)) in zip(axes, shown, strict=True):
        frame = result.method.frame()
        image = each.tripcolor(*frame.points.T, frame.cells, values, cmap="viridis", vmin=low, vmax=high)
        each.triplot(*frame.points.T, frame.cells, color="k", lw=0.15)
        for loop in frame.loops:
            each.plot(*frame.points[np.append(loop, loop[0])].T, color="k", lw=0.8)
        each.set(aspect="equal", title=title)
        figure.colorbar(image, ax=each, shrink=0.8)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
