"""Mesh and step convergence of the forces, with observed order and grid convergence index.

    python demos/aisi4340_rake0/convergence.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block of demos/aisi4340_demo: three meshes at twice the paper's step (all sizes refined by the same
ratio), and three steps on the middle mesh: the paper's, twice and four times that. Grid convergence index after Roache
(1994), see pfemcut/converge/order.py.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.converge.order import grid_convergence_index, observed_order
from pfemcut.validation.study import Outcome, Study, Variant, main, write_table
from pfemcut.whole_files import finite

RATIO = math.sqrt(2.0)
STEP = 2.082e-7
SIZES = {"tip_size": 0.005, "shear_zone_size": 0.01, "chip_size": 0.015, "surface_size": 0.015}
GROWTH = 0.08
FIGURES = ("cutting_force", "thrust_force", "chip_thickness", "contact_length", "max_temperature")


def steps(factor: float = 1.0) -> tuple[str, str]:
    return f"time.step={STEP * factor!r}", f"time.largest_step={STEP * factor!r}"


def mesh_variant(name: str, factor: float) -> Variant:
    sizes = tuple(f"mesh.{key}={value * factor!r}" for key, value in SIZES.items())
    return Variant(name, (*sizes, f"mesh.growth={GROWTH * factor!r}", *steps()))


def step_variant(name: str, factor: float) -> Variant:
    return Variant(name, steps(factor))


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    by_name = {outcome.variant.name: outcome for outcome in outcomes}
    header = ["run", "particles", *(f"{name}{part}" for name in FIGURES for part in ("", "_std"))]
    rows: list[list[str | float]] = [
        [
            name,
            float(outcome.history["nodes"][-1]),
            *(value for figure in FIGURES for value in (outcome.mean(figure), outcome.std(figure))),
        ]
        for name, outcome in by_name.items()
    ]
    write_table(results / "convergence.csv", "Convergence of the cut", header, rows)
    content: dict[str, Any] = {}
    for ladder, names, ratio in (
        ("mesh", ("mesh_coarse", "reference", "mesh_fine"), RATIO),
        ("step", ("step_long", "reference", "step_short"), 2.0),
    ):
        content[ladder] = {}
        for figure in FIGURES:
            values = [by_name[name].mean(figure) for name in names]
            order = observed_order(*values, ratio)
            index = grid_convergence_index(values[2], values[1], ratio, order)
            content[ladder][figure] = {
                "values": [finite(value) for value in values],
                "observed_order": finite(order),
                "grid_convergence_index": finite(index),
            }
    return content, all(outcome.summary["finished"] for outcome in outcomes)


STUDY = Study(
    "convergence",
    Path(__file__).resolve().parent,
    (
        Variant("reference", steps()),
        mesh_variant("mesh_coarse", RATIO),
        mesh_variant("mesh_fine", 1.0 / RATIO),
        step_variant("step_long", 2.0),
        step_variant("step_short", 0.5),
    ),
    conclude,
    travel=0.4,
)

if __name__ == "__main__":
    main(STUDY)
