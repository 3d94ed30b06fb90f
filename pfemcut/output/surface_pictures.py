"""Pictures of what a cut leaves on the workpiece, from the tables that a run wrote."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.tri import Triangulation  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.method import Frame  # noqa: E402
from pfemcut.output.directory import FIGURES, RESIDUAL  # noqa: E402
from pfemcut.output.figures import nodal_average  # noqa: E402
from pfemcut.output.picture_files import write_picture  # noqa: E402
from pfemcut.output.vtu import read_last_frame  # noqa: E402
from pfemcut.results.derived.burr import FACE, Burr, exit_burr  # noqa: E402
from pfemcut.results.derived.patch_recovery import recovered  # noqa: E402
from pfemcut.results.derived.residual import surface_heights  # noqa: E402
from pfemcut.results.history import read_table  # noqa: E402

Array = NDArray[np.float64]

DOTS_PER_INCH = 110
SHOWN = 1.3
"""Depth shown, over the depth beyond which neither stress nor strain is more than a tenth of its largest value."""


def write_surface_pictures(directory: Path, summary: Mapping[str, Any]) -> list[Path]:
    """Draw ``figures/residual.png`` and ``burr.png`` of an output directory whose ``summary`` has them; the paths."""
    drawn: dict[str, Figure] = {}
    if (directory / RESIDUAL).exists():
        drawn["residual"] = draw_residual(read_table(directory / RESIDUAL))
    if "residual_window_begin" in summary:
        ends = [float(summary[f"residual_window_{name}"]["value"]) for name in ("begin", "end")]
        drawn["residual_field"] = draw_field(read_last_frame(directory), *ends)
    if "burr_height" in summary:
        frame = read_last_frame(directory)
        for burr in exit_burr(frame, FACE):
            drawn["burr"] = draw_burr(frame, burr)
    paths = []
    for name, figure in drawn.items():
        paths.append(directory / FIGURES / f"{name}.png")
        paths[-1].parent.mkdir(exist_ok=True)
        write_picture(paths[-1], figure, DOTS_PER_INCH)
        plt.close(figure)
    return paths


def draw_field(frame: Frame, begin: float, end: float) -> Figure:
    """Residual stress along the cut in the workpiece, and the window of its profiles, ``begin`` to ``end`` (mm)."""
    figure, axes = plt.subplots(figsize=(9.0, 4.5), layout="constrained")
    stress = recovered(frame, frame.cell_fields["cauchy_stress"][:, :1])[:, 0]
    largest = max(float(np.percentile(np.abs(stress), 98.0)), 1e-3)
    levels = np.linspace(-largest, largest, 21)
    triangles = Triangulation(frame.points[:, 0], frame.points[:, 1], frame.cells)
    image = axes.tricontourf(triangles, np.clip(stress, -largest, largest), levels=levels, cmap="coolwarm")
    for loop in frame.loops:
        axes.plot(*frame.points[np.append(loop, loop[0])].T, color="black", linewidth=0.6)
    inside = (frame.points[:, 0] > begin) & (frame.points[:, 0] < end)
    top = float(np.median(surface_heights(frame, np.linspace(begin, end, 9)[1:-1])))
    low = float(frame.points[inside, 1].min())
    for x, text in ((begin, "begin"), (end, "end")):
        axes.plot([x, x], [low, top], color="black", linestyle="--", linewidth=1.0)
        axes.text(x, low, f" {text}", va="bottom", fontsize="small")
    middle = 0.5 * (begin + end)
    axes.annotate("", (middle, top - 0.3 * (top - low)), (middle, top), arrowprops={"arrowstyle": "->"})
    axes.text(middle, top - 0.2 * (top - low), " depth", va="center", fontsize="small")
    axes.set(
        title="Residual stress along the cut, xx, and the window of the profiles",
        xlabel="x (mm)",
        ylabel="y (mm)",
    )
    axes.set_aspect("equal")
    figure.colorbar(image, ax=axes, label="MPa", shrink=0.8)
    return figure


def draw_burr(frame: Frame, burr: Burr) -> Figure:
    """The workpiece's end with the burr, its height and its thicknesses, over the plastic strain."""
    figure, axes = plt.subplots(figsize=(7.5, 5.5), layout="constrained")
    strain = nodal_average(frame, frame.cell_fields["equivalent_plastic_strain"])
    levels = np.linspace(0.0, max(float(np.percentile(strain, 98.0)), 1e-3), 21)
    image = axes.tricontourf(
        Triangulation(frame.points[:, 0], frame.points[:, 1], frame.cells),
        np.minimum(strain, levels[-1]),
        levels=levels,
        cmap="viridis",
    )
    for loop in frame.loops:
        axes.plot(*frame.points[np.append(loop, loop[0])].T, color="black", linewidth=0.8)
    low = float(frame.points[frame.points[:, 0] < FACE, 1].min(initial=burr.root_top - burr.root_thickness))
    axes.axvline(FACE, color="tab:red", linestyle="--", linewidth=1.0)
    for at, top, thickness, name in (
        (burr.root, burr.root_top, burr.root_thickness, "root"),
        (burr.neck, burr.neck_top, burr.neck_thickness, "neck"),
    ):
        x = FACE - at
        axes.plot([x, x], [top - thickness, top], color="tab:red", marker="_", markersize=10)
        axes.annotate(
            f"{name} {thickness:.3f} mm",
            (x, top),
            (x, top + 0.12 * burr.overhang),
            color="tab:red",
            ha="center",
            arrowprops={"arrowstyle": "-", "color": "tab:red", "linewidth": 0.7},
        )
    below = low - 0.1 * burr.overhang
    axes.annotate(
        "", (FACE, below), (FACE - burr.neck, below), arrowprops={"arrowstyle": "<->", "color": "tab:red"}
    )
    axes.text(
        FACE - 0.5 * burr.neck, below, f"height {burr.height:.3f} mm", color="tab:red", ha="center", va="top"
    )
    axes.plot([FACE - burr.neck] * 2, [below, burr.neck_top], color="tab:red", linewidth=0.6, linestyle=":")
    highest = float(frame.points[:, 1].max())
    axes.set(
        title="Burr and chip at the end face (dashed: where it was)",
        xlabel="x (mm)",
        ylabel="y (mm)",
        xlim=(FACE - 1.15 * burr.overhang, FACE + 0.7 * burr.overhang),
        ylim=(below - 0.2 * burr.overhang, highest + 0.25 * burr.overhang),
    )
    axes.set_aspect("equal")
    figure.colorbar(image, ax=axes, label="equivalent plastic strain (-)", shrink=0.8)
    return figure


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


def _band(axes: Axes, depth: Array, table: Mapping[str, Array], name: str, label: str, colour: str) -> None:
    mean, std = table[name], table[f"{name}_std"]
    axes.plot(depth, mean, color=colour, label=label)
    axes.fill_between(depth, mean - std, mean + std, color=colour, alpha=0.2, linewidth=0.0)


def _last_large(depth: Array, values: Array) -> float:
    """Depth of the last value of more than a tenth of the largest in size."""
    size = np.abs(values)
    return float(depth[np.flatnonzero(size >= 0.1 * size.max())[-1]])
