"""Serrated chip of Ti6Al4V at 500 m/min on two meshes: segments, forces, and what the mesh does to them.

    python demos/ti6al4v_serrated/run.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

The meshes differ by the square root of two in all sizes, with the same steps. Segments are measured on the chip of the
last frame and in the cutting force beyond the first 0.15 mm of travel (pfemcut/results/derived/segmentation.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.case.load import load_case
from pfemcut.case.schema import Case
from pfemcut.method import Frame
from pfemcut.output.vtu import read_last_frame
from pfemcut.problem import Cut
from pfemcut.results.derived.segmentation import (
    Oscillation,
    Profile,
    Segmentation,
    force_oscillation,
    segmentation,
    thickness_profile,
)
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.validation.study import Outcome, Study, Variant, main, write_table
from pfemcut.whole_files import finite

FOLDER = Path(__file__).resolve().parent
CASE = FOLDER / "case.toml"
RATIO = math.sqrt(2.0)
SIZES = ("tip_size", "shear_zone_size", "chip_size", "surface_size")
BEGIN = 0.15
"""Travel from which forces are averaged (mm): the entry is not serrated."""


def case_of() -> Case:
    case, _ = load_case(CASE)
    assert isinstance(case, Case)
    return case


def sizes_times(factor: float) -> tuple[str, ...]:
    """All sizes of the case, and their growth, times a factor."""
    mesh = case_of().mesh
    return tuple(f"mesh.{key}={getattr(mesh, key) * factor:.4g}" for key in (*SIZES, "growth"))


def measured(outcome: Outcome, case: Case) -> tuple[Frame, Profile, Segmentation, Oscillation, Oscillation]:
    """Last frame, thickness profile, segments, and the oscillations of cutting and thrust force."""
    frame = read_last_frame(outcome.directory)
    cut = Cut(case.cutting.depth, case.cutting.speed, case.workpiece.height)
    profile = thickness_profile(frame, frame.tool[0], cut)
    found = segmentation(profile, case.cutting.depth, case.cutting.speed)
    history = outcome.history
    later = history["travel"] >= BEGIN
    cutting, thrust = (
        force_oscillation(history["time"][later], history[name][later])
        for name in ("cutting_force", "thrust_force")
    )
    return frame, profile, found, cutting, thrust


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    """Tables and pictures; whether both meshes came to their end with segments that both chip and force show."""
    case = case_of()
    every = [(outcome, *measured(outcome, case)) for outcome in outcomes]
    rows = {
        outcome.variant.name: figures(outcome, found, cutting, thrust)
        for outcome, _, _, found, cutting, thrust in every
    }
    header = ["mesh", *next(iter(rows.values()))]
    write_table(
        results / "serrated.csv",
        "Serrated chip",
        header,
        [[name, *row.values()] for name, row in rows.items()],
    )
    for outcome in outcomes:
        write_thinned(results / f"history_{outcome.variant.name}.csv", outcome.history)
    draw_forces([(o.variant.name, o) for o in outcomes], results)
    draw_chips([(o.variant.name, frame, profile) for o, frame, profile, *_ in every], case, results)
    content = {name: {key: finite(value) for key, value in row.items()} for name, row in rows.items()}
    serrated = all(found.count >= 2 for _, _, _, found, _, _ in every)
    return {"validated": False, "figures": content}, serrated and all(
        outcome.summary["finished"] for outcome in outcomes
    )


def figures(
    outcome: Outcome, found: Segmentation, cutting: Oscillation, thrust: Oscillation
) -> dict[str, float]:
    """What the table shows of a mesh; frequencies in kHz, lengths in mm, forces in N/mm."""
    history = outcome.history
    return {
        "travel": float(history["travel"][-1]),
        "particles": float(history["nodes"][-1]),
        "segments": float(found.count),
        "spacing": found.spacing,
        "spacing_std": found.spacing_std,
        "peak": found.peak,
        "valley": found.valley,
        "degree": found.degree,
        "uncut_length": found.uncut,
        "frequency_chip": 1e-3 * found.frequency,
        "frequency_spectrum": 1e-3 * cutting.spectral_frequency,
        "share_of_variance": cutting.spectral_share,
        "frequency_cycles": 1e-3 * cutting.cycle_frequency,
        "cycles": float(cutting.cycles),
        "cutting_force": cutting.mean,
        "cutting_force_std": cutting.std,
        "cutting_force_swing": cutting.swing,
        "thrust_force": thrust.mean,
        "thrust_force_std": thrust.std,
        "thrust_force_swing": thrust.swing,
        "max_temperature": float(history["max_temperature"].max()),
        "max_eqps": float(history["max_eqps"][-1]),
        "peak_strain_rate": float(np.nanmedian(history["peak_strain_rate"])),
        "energy_error": float(history["energy_error"][-1]),
        "heat_error": float(history["heat_error"][-1]),
        "area_drift": float(history["area_drift"][-1]),
    }


def draw_forces(runs: Sequence[tuple[str, Outcome]], results: Path) -> None:
    """Cutting and thrust force against travel."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
    for name, outcome in runs:
        history = outcome.history
        for axis, key in zip(axes, ("cutting_force", "thrust_force"), strict=True):
            axis.plot(history["travel"], history[key], lw=0.9, label=name)
            axis.set_ylabel(f"{key.replace('_', ' ')} (N/mm)")
    for axis in axes:
        axis.set_ylim(bottom=0.0)
        axis.axvline(BEGIN, color="0.6", lw=0.6, ls="--")
    axes[0].legend()
    axes[1].set_xlabel("travel (mm)")
    save(figure, results / "forces.png")


def draw_chips(runs: Sequence[tuple[str, Frame, Profile]], case: Case, results: Path) -> None:
    """The last chips: plastic strain, temperature, and the thickness along the rake side."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(runs), 3, figsize=(16, 5.5 * len(runs)), layout="constrained")
    depth, surface = case.cutting.depth, case.workpiece.height
    for (name, frame, profile), (strain, heat, thickness) in zip(runs, axes, strict=True):
        tool = frame.tool[0]
        x, y = frame.points.T
        shown = strain.tripcolor(
            x,
            y,
            frame.cells,
            frame.cell_fields["equivalent_plastic_strain"],
            cmap="viridis",
            vmin=0.0,
            vmax=6.0,
        )
        figure.colorbar(shown, ax=strain, label="equivalent plastic strain (-)", shrink=0.8)
        hot = heat.tripcolor(
            x, y, frame.cells, frame.point_fields["temperature"], cmap="inferno", shading="gouraud"
        )
        figure.colorbar(hot, ax=heat, label="temperature (K)", shrink=0.8)
        for axis in (strain, heat):
            for loop in frame.loops:
                axis.plot(*frame.points[np.append(loop, loop[0])].T, color="k", lw=0.4)
            axis.fill(*tool.outline(2.0).T, color="0.75")
            axis.set(
                aspect="equal",
                xlim=(tool.centre[0] - 4.0 * depth, tool.centre[0] + 1.5 * depth),
                ylim=(surface - 1.8 * depth, surface + 5.0 * depth),
                title=f"{name}, travel {frame.travel:.2f} mm",
                xlabel="x (mm)",
                ylabel="y (mm)",
            )
        thickness.plot(profile.along, profile.thickness, color="k", lw=1.0)
        thickness.set(
            xlabel="along the rake side (mm)", ylabel="chip thickness (mm)", ylim=(0.0, None), title=name
        )
    save(figure, results / "chips.png")


def save(figure: Any, path: Path) -> None:
    """Write a figure small enough to keep."""
    import matplotlib.pyplot as plt

    large = path.with_suffix(".large.png")
    figure.savefig(large, dpi=80)
    plt.close(figure)
    copy_picture(large, path)
    large.unlink()


STUDY = Study(
    "serrated",
    FOLDER,
    (Variant("coarse", sizes_times(RATIO)), Variant("fine")),
    conclude,
    travel=case_of().cutting.travel,
    case=CASE,
)

if __name__ == "__main__":
    main(STUDY)
