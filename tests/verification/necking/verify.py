"""Necking on three meshes, isothermal and adiabatic, with and without remeshing, against the F-bar solution.

    python -m tests.verification.necking.verify

takes three minutes; ``--reference`` solves the reference anew as well (two minutes).
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..common import Table, run, save_picture, write_results, write_table
from .reference import considere_force, read_curve, solve

FOLDER = Path(__file__).parent

SIZES = (1.6, 0.8, 0.4)
ELONGATION = {"isothermal": 10.0, "adiabatic": 7.0}
STATIONS = {"isothermal": (5.0, 6.0, 7.0, 8.0, 9.0, 10.0), "adiabatic": (4.0, 5.0, 6.0, 7.0)}
REFERENCE_MESHES = ((16, 5), (32, 10), (48, 15))
NECK, WIDTH = 6.297566, 2.0


def curve(size: float, heating: str, remesh: bool, step: float = 0.004) -> dict[str, np.ndarray]:
    """Force (N/mm), neck half-width (mm), warming (K) against elongation (mm) by pfemcut, and its costs."""
    zone = {"start": [0.0, 0.0], "end": [0.0, 6.413], "radius": 4.0, "size": size, "growth": 0.1}

    def change(table: Table) -> None:
        table["mesh"].update(size=2.0 * size, refine=[zone], remesh=remesh)
        table["body"][0]["material"]["taylor_quinney"] = 0.9 if heating == "adiabatic" else 0.0
        table["time"].update(step=step, end=ELONGATION[heating] / 10.0)  # a second is 10 mm of elongation

    history = run(FOLDER / "case.toml", change).history
    return {
        "elongation": 10.0 * history["time"],
        "force": WIDTH * history["reaction_end_x"],
        "neck": NECK + history["neck_uy"],
        "warming": history["max_temperature"] - 293.15,
        "nodes": history["nodes"],
        "iterations": history["newton_iterations"],
        "mass_drift": history["mass_drift"],
        "wall_time": history["wall_time"],
    }


def value(found: dict[str, np.ndarray], name: str, elongation: float) -> float:
    """A column at ``elongation``."""
    return float(np.interp(elongation, found["elongation"], found[name]))


def difference(found: dict[str, np.ndarray], other: dict[str, np.ndarray], name: str, upto: float) -> float:
    """Largest relative difference from 0.5 mm, beyond the elastic knee, to ``upto``, at the steps of ``found``.

    ``other`` has steps that are as long or shorter, so that its linear interpolation adds nothing.
    """
    at = found["elongation"]
    compared = (at > 0.5 - 1e-9) & (at < upto + 1e-9)
    expected = np.interp(at, other["elongation"], other[name])
    return float(np.abs(found[name] / expected - 1.0)[compared].max())


def solve_references() -> None:
    """The reference on its meshes, of which the finest curves are stored."""
    rows = []
    for heating, elongation in ELONGATION.items():
        for nx, ny in REFERENCE_MESHES:
            found = solve(nx, ny, elongation, round(25 * elongation), heating == "adiabatic")
            for at in STATIONS[heating]:
                values = {name: value(found, name, at) for name in ("force", "neck", "warming")}
                rows.append({"heating": heating, "quadrilaterals": f"{nx}x{ny}", "elongation": at, **values})
            print(rows[-1], flush=True)
        write_table(
            FOLDER / f"reference_{heating}.csv",
            [dict(zip(found, map(float, line), strict=True)) for line in zip(*found.values(), strict=True)],
        )
    write_table(FOLDER / "results" / "reference_convergence.csv", rows)


def ladder() -> tuple[list[dict], dict, dict]:
    """Convergence rows, summary figures and curves of all runs."""
    rows, figures, curves = [], {"considere_force": considere_force()}, {}
    for heating, elongation in ELONGATION.items():
        reference = read_curve(FOLDER / f"reference_{heating}.csv")
        curves[heating, 0.0, False] = reference
        for size in SIZES:
            for remesh in (False, True):
                found = curves[heating, size, remesh] = curve(size, heating, remesh)
                for at in STATIONS[heating]:
                    row = {"heating": heating, "h": size, "remesh": remesh, "elongation": at}
                    for name in ("force", "neck", "warming"):
                        row |= {name: value(found, name, at), f"reference_{name}": value(reference, name, at)}
                    rows.append(row)
                figures[f"{heating} h={size} remesh={remesh}"] = {
                    "peak_force": float(found["force"].max()),
                    "reference_peak_force": float(reference["force"].max()),
                    "force_difference_to_reference_to_8_mm": difference(
                        found, reference, "force", min(8.0, elongation)
                    ),
                    "force_difference_to_reference": difference(found, reference, "force", elongation),
                    "neck_difference_to_reference": difference(found, reference, "neck", elongation),
                    "nodes": int(found["nodes"][-1]),
                    "iterations": float(found["iterations"].mean()),
                    "mass_drift": float(found["mass_drift"][-1]),
                    "wall_time": float(found["wall_time"][-1]),
                }
                print(heating, size, remesh, figures[f"{heating} h={size} remesh={remesh}"], flush=True)
            pair = curves[heating, size, True], curves[heating, size, False]
            figures[f"remeshing changes, {heating} h={size}"] = {
                f"{name}_to_{upto:g}_mm": difference(*pair, name, upto)
                for name in ("force", "neck")
                for upto in (min(8.0, elongation), elongation)
            }
    return rows, figures, curves


def step_ladder() -> list[dict]:
    """Peak force and end values for four step lengths on the middle mesh, not remeshed."""
    rows = []
    for heating in ELONGATION:
        for step in (0.016, 0.008, 0.004, 0.002):
            found = curve(0.8, heating, False, step)
            last = {name: float(found[name][-1]) for name in ("force", "neck", "warming")}
            rows.append(
                {
                    "heating": heating,
                    "h": 0.8,
                    "step": step,
                    "peak_force": float(found["force"].max()),
                    **last,
                }
            )
    return rows


def draw(curves: dict) -> None:
    """Force and neck half-width against elongation."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for heating, colour in (("isothermal", "C0"), ("adiabatic", "C3")):
        for (case, size, remesh), found in curves.items():
            if case != heating:
                continue
            style = {
                "color": "k" if size == 0.0 else colour,
                "alpha": 1.0 if size in (0.0, 0.4) else {1.6: 0.35, 0.8: 0.6}[size],
                "linestyle": ":" if size == 0.0 else "-" if remesh else "--",
                "linewidth": 1.6 if size == 0.0 else 1.0,
                "zorder": 3 if size == 0.0 else 2,
            }
            label = (
                "F-bar reference"
                if size == 0.0
                else f"{heating}, h {size} mm{', remeshed' if remesh else ''}"
            )
            label = label if size or heating == "isothermal" else None
            for axis, name, scale in ((axes[0], "force", 1e-3), (axes[1], "neck", 1.0)):
                axis.plot(found["elongation"], scale * found[name], label=label, **style)
    axes[0].axhline(1e-3 * considere_force(), color="0.6", linewidth=0.8)
    axes[0].annotate("Considère, 1D", (0.1, 1e-3 * considere_force() + 0.03), color="0.4", fontsize=8)
    axes[0].set(ylabel="force of the full width (kN/mm)", ylim=(6.5, 9.5))
    axes[1].set(ylabel="neck half-width (mm)")
    for axis in axes:
        axis.set(xlabel="elongation (mm)", xlim=(0, 10))
    axes[1].legend(fontsize=7, loc="lower left")
    save_picture(FOLDER, figure)


def main() -> None:
    if "--reference" in sys.argv:
        solve_references()
    rows, figures, curves = ladder()
    write_results(FOLDER, rows, figures)
    write_table(FOLDER / "results" / "step_convergence.csv", step_ladder())
    draw(curves)


if __name__ == "__main__":
    main()
