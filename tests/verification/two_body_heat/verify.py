"""Surface temperatures of two bodies that rub, or that touch at two temperatures, against half spaces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from ..common import Run, Table, run, save_picture, set_keys, weights, write_results
from .reference import conduction_warming, effusivity, friction_warming

FOLDER = Path(__file__).parent
SPEED, HOTTER, CONDUCTANCE = 200.0, 500.0, 320.0
STEEL = effusivity(50.0, 7.844e-9, 0.46e9)
CARBIDE = effusivity(80.0, 15e-9, 0.2e9)
Array = NDArray[np.float64]


def computed(fine: float, keys: Table) -> Run:
    """Run with the spacing ``fine`` (mm) at the interface, and steps in proportion to its square."""
    step = 5e-6 * (fine / 0.02) ** 2

    def change(table: Table) -> None:
        zone = table["mesh"]["refine"][0]
        zone.update(size=fine)
        table["time"]["step"] = step
        for component in ("x", "y"):
            table["boundary"][1]["displacement"][component]["time"][1] = step
        table["boundary"][1]["displacement"]["x"]["value"][1] = 0.005 + SPEED * step
        set_keys(table, keys)

    return run(FOLDER / "case.toml", change)


def middle(result: Run) -> NDArray[np.bool_]:
    """Particles in contact away from the ends of the blocks."""
    return np.abs(result.mesh.points[result.method.frame().contact.particles, 0] - 1.0) < 0.3


def warmings(result: Run) -> tuple[Array, Array, Array]:
    """Time, and the warming of both probes (K)."""
    history = result.history
    start = 293.15
    return history["time"], history["steel_temperature"] - start, history["carbide_temperature"] - start


def rubbed(fine: float = 0.02, keys: Table | None = None) -> tuple[Run, dict[str, Any]]:
    """Sliding, and the slope of the squared warming, which does not know when sliding began, over the exact one."""
    result = computed(fine, keys or {})
    time, steel, carbide = warmings(result)
    flux = SPEED * float(result.method.frame().contact.shear[middle(result)].mean())
    late = time > 0.4 * time[-1]
    exact = friction_warming(flux, np.ones(1), STEEL, CARBIDE)[0]

    def coefficient(warming: Array) -> float:
        return float(np.sqrt(np.polyfit(time[late], warming[late] ** 2, 1)[0]) / exact - 1.0)

    return result, {
        "fine": fine,
        "flux": flux,
        "steel_end": float(steel[-1]),
        "carbide_end": float(carbide[-1]),
        "exact_end": float(friction_warming(flux, time[-1:], STEEL, CARBIDE)[0]),
        "steel_difference": coefficient(steel),
        "carbide_difference": coefficient(carbide),
        "heat_error": float(result.history["heat_error"][-1]),
        "energy_error": float(result.history["energy_error"][-1]),
    }


def touched(fine: float = 0.02, conductance: float = CONDUCTANCE) -> tuple[Run, dict[str, Any]]:
    """Conduction from the carbide, which is hotter, without sliding."""
    result = computed(
        fine,
        {
            "contact.0.conductance": conductance,
            "contact.0.friction": 0.0,
            "body.1.temperature": 293.15 + HOTTER,
            "boundary.1.displacement.x": 0.0,
        },
    )
    time, steel, carbide = warmings(result)
    exact = conduction_warming(HOTTER, conductance, time, STEEL, CARBIDE)
    exact_carbide = HOTTER - conduction_warming(HOTTER, conductance, time, CARBIDE, STEEL)
    return result, {
        "fine": fine,
        "conductance": conductance,
        "steel_end": float(steel[-1]),
        "steel_exact_end": float(exact[-1]),
        "steel_difference": float(np.abs(steel - exact).max() / HOTTER),
        "carbide_difference": float(np.abs(carbide - exact_carbide).max() / HOTTER),
        "heat_error": float(result.history["heat_content"][-1]) / moved_heat(result),
    }


def moved_heat(result: Run) -> float:
    """Heat (mJ/mm) that the steel block has taken up."""
    steel = result.mesh.particle_ranges[0]
    area = weights(result.mesh)[steel]
    return float(7.844e-9 * 0.46e9 * area @ (result.temperature[steel] - 293.15))


def main() -> None:
    """All variants, the table and the picture."""
    rows: list[dict[str, Any]] = []
    sliding = []
    for fine in (0.04, 0.02):
        result, row = rubbed(fine)
        rows.append({"kind": "friction, conductance 1e6", **row})
        sliding.append(result)
        print(rows[-1], flush=True)
    share = STEEL / (STEEL + CARBIDE)
    _, row = rubbed(0.02, {"contact.0.conductance": 0.0, "contact.0.heat_partition": share})
    rows.append({"kind": f"friction, partition {share:.4f}", **row})
    print(rows[-1], flush=True)
    still = []
    for fine in (0.04, 0.02):
        result, row = touched(fine)
        rows.append({"kind": "conduction", **row})
        still.append(result)
        print(rows[-1], flush=True)
    figures = {
        "friction_difference": {
            "value": max(abs(rows[1]["steel_difference"]), abs(rows[1]["carbide_difference"])),
            "unit": "1",
        },
        "partition_difference": {
            "value": max(abs(rows[2]["steel_difference"]), abs(rows[2]["carbide_difference"])),
            "unit": "1",
        },
        "conduction_difference": {
            "value": max(rows[4]["steel_difference"], rows[4]["carbide_difference"]),
            "unit": "1",
        },
        "largest_heat_error": {"value": max(abs(row["heat_error"]) for row in rows), "unit": "1"},
    }
    write_results(FOLDER, rows, figures)
    picture(sliding[1], rows[1], still[1])


def picture(sliding: Run, row: dict[str, Any], still: Run) -> None:
    """Warming of both surfaces against time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    time, steel, carbide = warmings(sliding)
    left.plot(1e3 * time, friction_warming(row["flux"], time, STEEL, CARBIDE), "k-", lw=0.8, label="exact")
    left.plot(1e3 * time, steel, "--", label="steel")
    left.plot(1e3 * time, carbide, ":", label="carbide")
    left.set(xlabel="time (ms)", ylabel="warming of the surface (K)", title="friction")
    time, steel, carbide = warmings(still)
    exact = conduction_warming(HOTTER, CONDUCTANCE, time, STEEL, CARBIDE)
    other = HOTTER - conduction_warming(HOTTER, CONDUCTANCE, time, CARBIDE, STEEL)
    right.plot(1e3 * time, exact, "k-", lw=0.8, label="exact")
    right.plot(1e3 * time, other, "k-", lw=0.8)
    right.plot(1e3 * time, steel, "--", label="steel")
    right.plot(1e3 * time, carbide, ":", label="carbide")
    right.set(xlabel="time (ms)", title="conduction")
    left.legend(fontsize=7)
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
