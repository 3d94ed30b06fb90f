"""How far the mesh moves the profiles below the machined surface: the recorded run beside one with a coarser mesh.

    python demos/aisi4340_surface/mesh.py [-o DIR] [--resume | --overwrite] [--travel MM]

run.py comes first.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from pfemcut.output.directory import RESIDUAL, SUMMARY
from pfemcut.results.history import read_table
from pfemcut.results.summary import figure_mean, figure_std
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

FOLDER = Path(__file__).resolve().parent
SIZES = {"tip_size": 0.009, "shear_zone_size": 0.018, "chip_size": 0.022, "surface_size": 0.012}
FIGURES = (
    "residual_surface_xx",
    "residual_surface_zz",
    "residual_surface_yy",
    "residual_affected_depth",
    "deformed_depth",
    "surface_plastic_strain",
    "residual_section_force",
    "cutting_force",
)
DEPTHS = (0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05)  # mm


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    (coarse,) = outcomes
    recorded = json.loads((FOLDER / "results" / SUMMARY).read_text(encoding="utf-8"))
    runs = {
        "recorded": (recorded, read_table(FOLDER / "results" / RESIDUAL)),
        coarse.variant.name: (coarse.summary, read_table(coarse.directory / RESIDUAL)),
    }
    header = ["mesh", *(part for name in FIGURES for part in (name, f"{name}_std"))]
    header += [f"xx_at_{1000.0 * depth:g}um" for depth in DEPTHS]
    rows: list[list[str | float]] = [
        [
            name,
            *(
                part
                for figure in FIGURES
                for part in (figure_mean(summary, figure), figure_std(summary, figure))
            ),
            *(float(np.interp(depth, table["depth"], table["stress_xx"])) for depth in DEPTHS),
        ]
        for name, (summary, table) in runs.items()
    ]
    write_table(results / "mesh.csv", "Machined surface of AISI 4340: mesh", header, rows)
    draw({name: table for name, (_, table) in runs.items()}, results / "mesh.png")
    return finite_figures(header, rows), bool(coarse.summary["finished"])


def draw(tables: Mapping[str, Mapping[str, NDArray[np.float64]]], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.5, 4.0), layout="constrained")
    for (label, table), style in zip(tables.items(), ("-", "--"), strict=True):
        for name, colour in (
            ("stress_xx", "tab:blue"),
            ("stress_zz", "tab:orange"),
            ("stress_yy", "tab:green"),
        ):
            axes.plot(table["depth"], table[name], style, color=colour, label=f"{name[-2:]}, {label}")
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set(xlabel="depth below the machined surface (mm)", ylabel="residual stress (MPa)", xlim=(0.0, 0.08))
    axes.legend(fontsize="small", ncols=2)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study(
    "mesh",
    FOLDER,
    (
        Variant(
            "coarse",
            (
                'title="AISI 4340, machined surface, coarse"',
                *(f"mesh.{name}={size}" for name, size in SIZES.items()),
            ),
        ),
    ),
    conclude,
    travel=0.62,
    case=FOLDER / "case.toml",
)

if __name__ == "__main__":
    main(STUDY)
