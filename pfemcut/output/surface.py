"""What a cut leaves on the workpiece, from its last frame: ``residual.csv`` and the figures of the summary."""

from __future__ import annotations

from pathlib import Path

from pfemcut.output.directory import RESIDUAL, writing
from pfemcut.output.tables import write_csv
from pfemcut.output.vtu import read_collection, read_last_frame
from pfemcut.problem import Problem
from pfemcut.results.derived.burr import FACE, burr_figures, exit_burr, has_left
from pfemcut.results.derived.residual import (
    QUANTITIES,
    ResidualProfile,
    machined_surface,
    residual_figures,
    residual_profile,
)

LARGEST_NORMAL = 0.1
"""Of the largest residual stress: what yy at the surface may be without a warning."""

Figures = dict[str, dict[str, float | str]]


def surface_figures(directory: Path, problem: Problem) -> Figures:
    """Measure the machined surface of a run that has unloaded, write ``residual.csv``, and return the figures.

    There are none as long as the tool has not withdrawn.
    """
    if not problem.cut or not problem.after or not read_collection(directory):
        return {}
    frame = read_last_frame(directory)
    if frame.time <= problem.time.end * (1.0 + 1e-9):
        return {}
    figures: Figures = {}
    for surface in machined_surface(problem):
        profile = residual_profile(frame, surface)
        with writing(directory):
            write_residual(directory / RESIDUAL, profile)
        figures.update(residual_figures(profile))
    for burr in exit_burr(frame, FACE) if has_left(problem) else ():
        figures.update(burr_figures(burr))
    return figures


def surface_warnings(problem: Problem, figures: Figures) -> list[str]:
    """What a reader of ``figures`` must know."""
    found = []
    if problem.cut and problem.after and not figures:
        found.append("the machined surface is too short for profiles below it, and there is no burr")
    if "residual_surface_yy" in figures:
        normal = float(figures["residual_surface_yy"]["mean"])
        largest = max(abs(float(figures[f"residual_{name}"]["value"])) for name in ("compression", "tension"))
        if abs(normal) > LARGEST_NORMAL * largest:
            found.append(
                f"yy at the machined surface is {normal:.0f} MPa, where it must vanish: residual stresses nearer to it "
                "than about one spacing of the mesh are not resolved"
            )
    return found


def write_residual(path: Path, profile: ResidualProfile) -> None:
    """Write the profiles against depth: mean and standard deviation of each quantity (mm, MPa, -, K)."""
    columns = {"depth": profile.depth}
    for name in QUANTITIES:
        columns[name] = profile.mean[name]
        columns[f"{name}_std"] = profile.std[name]
    rows = [[f"{values[i]:.6g}" for values in columns.values()] for i in range(len(profile.depth))]
    write_csv(path, list(columns), rows)
