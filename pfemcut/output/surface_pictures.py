"""Pictures of what a cut leaves on the workpiece, from the tables that a run wrote."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.output.directory import FIGURES, RESIDUAL  # noqa: E402
from pfemcut.results.history import read_table  # noqa: E402

Array = NDArray[np.float64]

DOTS_PER_INCH = 110
SHOWN = 1.3
"""Depth shown, over the depth beyond which neither stress nor strain is more than a tenth of its largest value."""


def write_surface_pictures(directory: Path) -> list[Path]:
    """Draw ``figures/residual.png`` of an output directory that has ``residual.csv``; the paths written."""
    if not (directory / RESIDUAL).exists():
        return []
    (directory / FIGURES).mkdir(exist_ok=True)
    path = directory / FIGURES / "residual.png"
    figure = draw_residual(read_table(directory / RESIDUAL))
    figure.savefig(path, dpi=DOTS_PER_INCH, metadata={"Software": None})
    plt.close(figure)
    return [path]


def draw_residual(table: Mapping[str, Array]) -> Figure:
    """Residual stresses and plastic strain against depth; bands are one standard deviation along the surface."""
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.5, 4.2), width_ratios=(1.8, 1.0), layout="constrained"
    )
    depth = table["depth"]
    for name, label, colour in (
        ("stress_xx", "xx, along the cut", "tab:blue"),
        ("stress_zz", "zz, out of plane", "tab:orange"),
        ("stress_yy", "yy, normal to the surface", "tab:green"),
    ):
        _band(left, depth, table, name, label, colour)
    left.axhline(0.0, color="black", linewidth=0.8)
    left.set(title="Residual stress (plane strain)", ylabel="MPa")
    left.legend(fontsize="small")
    _band(right, depth, table, "plastic_strain", "equivalent plastic strain", "tab:red")
    right.set(title="Equivalent plastic strain", ylabel="-")
    right.set_ylim(bottom=0.0)
    far = SHOWN * max(
        _last_large(depth, table[name]) for name in ("stress_xx", "stress_zz", "plastic_strain")
    )
    for axes in (left, right):
        axes.set(
            xlabel="depth below the machined surface (mm)", xlim=(0.0, min(max(far, depth[1]), depth[-1]))
        )
        axes.grid(alpha=0.3)
    return figure


def _band(
    axes: plt.Axes, depth: Array, table: Mapping[str, Array], name: str, label: str, colour: str
) -> None:
    mean, std = table[name], table[f"{name}_std"]
    axes.plot(depth, mean, color=colour, label=label)
    axes.fill_between(depth, mean - std, mean + std, color=colour, alpha=0.2, linewidth=0.0)


def _last_large(depth: Array, values: Array) -> float:
    """Depth of the last value of more than a tenth of the largest in size."""
    size = np.abs(values)
    return float(depth[np.flatnonzero(size >= 0.1 * size.max())[-1]])
