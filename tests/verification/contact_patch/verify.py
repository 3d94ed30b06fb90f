"""Uniform contact pressure for several meshes, with and without remeshing."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt

from ..common import Run, Table, run, save_picture, write_results
from .reference import contact_pressure

FOLDER = Path(__file__).parent
YOUNG, POISSON, HEIGHT, TRAVEL, STEPS = 200.5e3, 0.3, 0.5, 0.005, 5


def pressed(size: float = 0.2, fine: float = 0.01, penalty: float = 4e7, remesh: bool = False) -> Run:
    """Run with the given largest and smallest spacing (mm) and penalty (MPa/mm)."""

    def change(table: Table) -> None:
        table["mesh"].update(size=size, remesh=remesh)
        table["mesh"]["refine"][0]["size"] = fine
        table["contact"]["penalty"] = penalty
        table["solver"] = {"tolerance": 1e-10}

    return run(FOLDER / "case.toml", change)


def main() -> None:
    """All variants and the picture."""
    rows = []
    results = []
    for size, fine, penalty, remesh in (
        (0.5, 0.5, 4e7, False),
        (0.2, 0.05, 4e7, False),
        (0.2, 0.01, 4e7, False),
        (0.2, 0.01, 4e5, False),
        (0.2, 0.01, 4e7, True),
    ):
        result = pressed(size, fine, penalty, remesh)
        found = result.method.frame().contact.pressure
        force, reference = contact_pressure(TRAVEL, STEPS, HEIGHT, penalty, YOUNG, POISSON)
        rows.append(
            {
                "size": size,
                "fine": fine,
                "penalty": penalty,
                "remesh": str(remesh),
                "nodes": result.nodes,
                "loaded": len(found),
                "lowest": float(found.min()),
                "highest": float(found.max()),
                "exact": reference,
                "spread": float((found.max() - found.min()) / found.mean()),
                "difference": float(found.mean() / reference - 1.0),
                "force": float(result.history["thrust_force"][-1]),
                "force_exact": force,
                "force_difference": float(result.history["thrust_force"][-1]) / force - 1.0,
            }
        )
        results.append(result)
    figures = {
        "largest_spread": {"value": max(row["spread"] for row in rows), "unit": "1"},
        "largest_difference": {"value": max(abs(row["difference"]) for row in rows), "unit": "1"},
        "largest_force_difference": {"value": max(abs(row["force_difference"]) for row in rows), "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(results[2], rows[2]["exact"])


def picture(result: Run, reference: float) -> None:
    """Mesh and contact pressure."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    points, contact = result.mesh.points, result.method.frame().contact
    left.triplot(*points.T, result.mesh.cells, lw=0.5)
    left.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    right.axhline(reference, color="k", lw=0.8, label="one point")
    right.plot(points[contact.particles, 0], contact.pressure, ".", label="particles")
    right.set(ylim=(0, 1.2 * reference), xlabel="x (mm)", ylabel="contact pressure (MPa)")
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
