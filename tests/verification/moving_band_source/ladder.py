"""Ladders, table and picture of a source that moves over a half space; the line and the band differ by the case."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from ..common import Run, Table, norms, orders, run, save_picture, write_results
from .reference import Source

CONDUCTIVITY = 50.0
DIFFUSIVITY = CONDUCTIVITY / (7.844e-9 * 0.46e9)
POWER, VELOCITY, STEP = 5.0e4, -3330.0, 1.041e-7
NEAR = 0.01  # mm, 2.4 thermal lengths: what lies closer to an end of the source is not in the norms
LINE = Source(POWER, 0.0, VELOCITY, CONDUCTIVITY, DIFFUSIVITY)
BAND = Source(POWER, 0.025, VELOCITY, CONDUCTIVITY, DIFFUSIVITY)


def moved(folder: Path, scale: float, slower: float, follow: bool = True, end: float | None = None) -> Run:
    """Run with the whole size field times ``scale`` and the step times ``slower``.

    The fine mesh follows the source by remeshing, or else a mesh at rest is fine all along the path.
    """

    def change(table: Table) -> None:
        mesh, time = table["mesh"], table["time"]
        time["end"] = end or time["end"]
        time["step"] *= slower
        mesh["size"] *= scale
        for zone in mesh["refine"]:
            zone["size"] *= scale
            zone["growth"] *= scale
            if not follow:
                zone["start"][0] += VELOCITY * time["end"]
                zone["end"] = zone.get("end", [0.0, 0.0])
        if not follow:
            mesh.update(remesh=False, velocity=[0.0, 0.0])

    return run(folder / "case.toml", change)


def compared(source: Source, result: Run) -> dict[str, Any]:
    """Differences (K) from the exact solution, and from backward Euler that is exact in space, off the source."""
    x, y = result.mesh.points.T
    time, step = float(result.history["time"][-1]), float(result.history["dt"][0])
    steps = len(result.history["dt"])
    rise = result.temperature - 293.15
    exact = source.transient(x, y, time)
    xi = x - source.velocity * time
    near = np.minimum(np.hypot(xi - source.half_width, y), np.hypot(xi + source.half_width, y))
    away = near > NEAR
    rms, largest = norms(result.mesh, rise - exact, away)
    rms_h, largest_h = norms(result.mesh, rise - source.backward_euler(x, y, steps, step), away)
    developed = away & (xi < 0.05)
    steady = norms(result.mesh, rise - source.quasi_steady(xi, y), developed)[1]
    return {
        "nodes": len(x),
        "inserted": int(result.history["inserted"].sum()),
        "removed": int(result.history["removed"].sum()),
        "highest_away": float(exact[away].max()),
        "rms": rms,
        "max": largest,
        "rms_space": rms_h,
        "max_space": largest_h,
        "max_quasi_steady": steady,
        "peak": float(rise.max()),
        "heat_error": float(result.history["heat_error"][-1]),
    }


def ladders(folder: Path, source: Source) -> None:
    """Run all and write the results."""
    rows: list[dict[str, Any]] = []
    scales, slower = (2.8, 2.0, 1.4, 1.0), (16.0, 8.0, 4.0, 2.0, 1.0)
    ladder = [("spacing", scale, 1.0, True) for scale in scales]
    ladder += [("spacing, mesh at rest", scale, 1.0, False) for scale in scales[:3]]
    ladder += [("step, mesh at rest", 2.0, factor, False) for factor in slower]
    kept: list[Run] = []
    at_rest: list[Run] = []
    for name, scale, factor, follow in ladder:
        result = moved(folder, scale, factor, follow)
        if (scale, factor, follow) == (1.0, 1.0, True):
            kept.append(result)
        if name.startswith("step"):
            at_rest.append(result)
        row = {"ladder": name, "size": 0.002 * scale, "step": STEP * factor, **compared(source, result)}
        print(row, flush=True)
        rows.append(row)
    for name in ("spacing", "spacing, mesh at rest"):
        part = [row for row in rows if row["ladder"] == name]
        sizes, found = [row["size"] for row in part], [row["rms_space"] for row in part]
        for row, order in zip(part, orders(sizes, found), strict=True):
            row["order"] = order
    # On the same mesh the spacing's own error is nearly the same, and drops out of differences between steps.
    differences = [_difference(source, a, b) for a, b in pairwise(at_rest)]
    part = [row for row in rows if row["ladder"].startswith("step")]
    for row, difference, order in zip(part, differences, orders(slower[:-1], differences), strict=False):
        row.update(to_next=difference, order=order)
    finest = rows[3]
    figures = {
        "thermal_length": {"value": DIFFUSIVITY / abs(VELOCITY), "unit": "mm"},
        "highest_rise_away": {"value": finest["highest_away"], "unit": "K"},
        "rms_error_exact": {"value": finest["rms"], "unit": "K"},
        "max_error_exact": {"value": finest["max"], "unit": "K"},
        "max_error_quasi_steady": {"value": finest["max_quasi_steady"], "unit": "K"},
        "order_in_spacing": {"value": _slope(rows, "spacing"), "unit": "1"},
        "order_in_spacing_mesh_at_rest": {"value": _slope(rows, "spacing, mesh at rest"), "unit": "1"},
        "order_in_step": {"value": rows[-2]["order"], "unit": "1"},
        "heat_error": {"value": finest["heat_error"], "unit": "1"},
    }
    if source.half_width:
        exact_peak = _peak(source, float(kept[0].history["time"][-1]))
        figures["peak_rise"] = {"value": finest["peak"], "exact": exact_peak, "unit": "K"}
    write_results(folder, rows, figures)
    _picture(folder, source, kept[0], rows)


def _difference(source: Source, a: Run, b: Run) -> float:
    """Root mean square (K) of the difference of two runs on the same mesh, away from the source."""
    x, y = a.mesh.points.T
    xi = x - source.velocity * float(a.history["time"][-1])
    near = np.minimum(np.hypot(xi - source.half_width, y), np.hypot(xi + source.half_width, y))
    return norms(a.mesh, a.temperature - b.temperature, near > NEAR)[0]


def _slope(rows: list[dict[str, Any]], name: str) -> float:
    """Order in the spacing by a straight line through a whole ladder."""
    part = [row for row in rows if row["ladder"] == name]
    size, error = (np.log([row[key] for row in part]) for key in ("size", "rms_space"))
    return float(np.polyfit(size, error, 1)[0])


def _peak(source: Source, time: float) -> float:
    x = source.velocity * time + np.linspace(-source.half_width, source.half_width, 2001)
    return float(source.transient(x, np.zeros_like(x), time).max())


def _picture(folder: Path, source: Source, result: Run, rows: list[dict[str, Any]]) -> None:
    figure = plt.figure(figsize=(11, 6), layout="constrained")
    grid = figure.add_gridspec(2, 4)
    field, profile = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, :2])
    ladders = figure.add_subplot(grid[1, 2]), figure.add_subplot(grid[1, 3])
    time = float(result.history["time"][-1])
    x, y = result.mesh.points.T
    xi, rise = x - source.velocity * time, result.temperature - 293.15
    field.triplot(xi, y, result.mesh.cells, lw=0.2, color="0.7")
    levels = np.array([1.0, 3.0, 10.0, 30.0, 100.0, 300.0])
    shown = field.tricontour(xi, y, result.mesh.cells, rise, levels, cmap="inferno", linewidths=1.2)
    field.clabel(shown, fontsize=7)
    field.set(
        xlim=(-0.06, 0.26),
        ylim=(-0.1, 0.005),
        aspect="equal",
        xlabel="behind the source (mm)",
        ylabel="y (mm)",
    )
    surface = np.flatnonzero(y > -1e-9)
    surface = surface[np.argsort(xi[surface])]
    line = np.linspace(-0.06, 0.26, 400)
    for depth, colour in ((0.0, "C0"), (-0.02, "C1")):
        at = np.full_like(line, depth)
        exact = source.transient(line + source.velocity * time, at, time)
        profile.plot(line, exact, colour, label=f"exact, depth {abs(depth):g} mm")
        steady = source.quasi_steady(line, at - 1e-9)
        profile.plot(line, steady, "k:", lw=0.8, label="quasi-steady" if depth else None)
    profile.plot(xi[surface], rise[surface], "k.", ms=3, label="particles on the surface")
    top = 1.15 * rise.max() if source.half_width else 400.0
    profile.set(xlim=(-0.06, 0.26), ylim=(-5, top), xlabel="behind the source (mm)", ylabel="rise (K)")
    profile.legend(fontsize=7)
    for axes, name, key, error, order, label in (
        (ladders[0], "spacing", "size", "rms_space", 2, "mesh follows"),
        (ladders[0], "spacing, mesh at rest", "size", "rms_space", 2, "mesh at rest"),
        (ladders[1], "step, mesh at rest", "step", "to_next", 1, "change by halving"),
    ):
        part = [row for row in rows if row["ladder"] == name and error in row]
        at = np.array([row[key] for row in part])
        axes.loglog(at, [row[error] for row in part], "o-", label=label)
        axes.loglog(at, part[0][error] * (at / at[0]) ** order, "k:", lw=0.8)
        axes.xaxis.set_minor_formatter("")
        axes.set(xlabel="h (mm)" if key == "size" else "step (s)")
        axes.legend(fontsize=7)
    ladders[0].set_xticks([0.002, 0.004], ["0.002", "0.004"])
    ladders[0].set(ylabel="rms error away from the source (K)")
    save_picture(folder, figure)
