"""Orthogonal cutting against what theory says of it: shear-plane forces, kinematics, and slip-line theory.

python -m tests.verification.cutting_limits.verify [DIR]

Two cuts with a nearly sharp tool (tip radius a twentieth of the depth): ``sharp.toml`` (AISI 4340) and
``slip_line.toml`` (perfectly plastic, not heating). Runs go to DIR (``out/verification``) and are resumed there.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from meshing.mesh import signed_areas
from pfemcut.case.load import load_case
from pfemcut.case.schema import Case
from pfemcut.driver import run_case
from pfemcut.method import Frame
from pfemcut.output.directory import SUMMARY
from pfemcut.output.vtu import read_last_frame

from ..common import save_picture, write_results

FOLDER = Path(__file__).parent
CASES = ("sharp", "slip_line")
SHEAR_STRENGTH = 900.0 / math.sqrt(3.0)
"""k of ``slip_line.toml`` (MPa)."""


def finished_run(name: str, directory: Path) -> tuple[Case, dict[str, Any], Frame]:
    """The case, the summary and the last frame of a run, which is started, gone on with or only read."""
    case, material = load_case(FOLDER / f"{name}.toml")
    assert isinstance(case, Case)
    if not (directory / SUMMARY).exists():
        run_case(case, material, directory, resume=(directory / "checkpoint.h5").exists())
    return case, json.loads((directory / SUMMARY).read_text()), read_last_frame(directory)


def shear_flow_stress(frame: Frame, depth: float) -> float:
    """Shear stress (MPa) in the primary zone: von Mises over sqrt(3), weighted with the plastic strain rate.

    Elements more than a fifth of the depth from the tool and above the machined surface count, so that the secondary
    zone on the rake face and the tip do not.
    """
    centroids = frame.points[frame.cells].mean(axis=1)
    tool = frame.tool[0]
    away = tool.closest(centroids).gap > 0.2 * depth
    above = centroids[:, 1] > tool.centre[1]
    weight = signed_areas(frame.points, frame.cells) * frame.cell_fields["equivalent_plastic_strain_rate"]
    weight = np.where(away & above, weight, 0.0)
    return float(weight @ frame.cell_fields["von_mises"] / weight.sum() / math.sqrt(3.0))


def limits(name: str, directory: Path) -> tuple[dict[str, Any], Frame]:
    """Computed figures of one cut beside what theory gives."""
    case, summary, frame = finished_run(name, directory)
    mean = {
        key: value["mean"] for key, value in summary.items() if isinstance(value, dict) and "mean" in value
    }
    depth, speed = case.cutting.depth, case.cutting.speed
    phi = math.radians(mean["shear_angle"])
    stress = shear_flow_stress(frame, depth)
    on_plane = mean["cutting_force"] * math.cos(phi) - mean["thrust_force"] * math.sin(phi)
    found = {
        "cutting_force": mean["cutting_force"],
        "cutting_force_std": summary["cutting_force"]["std"],
        "thrust_force": mean["thrust_force"],
        "shear_angle": mean["shear_angle"],
        "shear_angle_band": mean["shear_angle_band"],
        "chip_thickness": mean["chip_thickness"],
        "shear_plane_force": on_plane,
        "shear_flow_stress": stress,
        "shear_plane_force_expected": stress * depth / math.sin(phi),
        "shear_plane_force_difference": on_plane * math.sin(phi) / (stress * depth) - 1.0,
        "chip_flux_difference": mean["chip_speed"] * mean["chip_thickness"] / (speed * depth) - 1.0,
        "energy_error": summary["energy_error"]["value"],
        "travel": summary["travel"],
        "steady": summary["steady"]["value"],
    }
    if name == "slip_line":
        force = 2.0 * SHEAR_STRENGTH * depth
        found["lee_shaffer_cutting_force"] = force
        found["lee_shaffer_cutting_force_difference"] = mean["cutting_force"] / force - 1.0
        found["lee_shaffer_shear_angle"] = 45.0
        found["lee_shaffer_chip_thickness"] = depth
    return found, frame


def main() -> None:
    """Both cuts, the table and the picture."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out") / "verification"
    figure, axes = plt.subplots(1, 2, figsize=(11.0, 5.0), layout="constrained")
    rows, figures = [], {}
    for name, at in zip(CASES, axes, strict=True):
        found, frame = limits(name, root / name)
        rows.append({"case": name, **found})
        figures[name] = found
        draw(at, frame, name, found["shear_angle"])
    write_results(FOLDER, rows, figures)
    save_picture(FOLDER, figure)


def draw(axes: Any, frame: Frame, name: str, shear_angle: float) -> None:
    """Strain rate in the primary zone, with the shear plane of the chip ratio."""
    rate = np.log10(np.maximum(frame.cell_fields["equivalent_plastic_strain_rate"], 1e2))
    axes.tripcolor(*frame.points.T, frame.cells, rate, cmap="magma", vmin=2.0, vmax=6.0)
    tool = frame.tool[0]
    axes.fill(*tool.outline(0.6).T, color="0.8")
    x, y = tool.centre
    reach = 0.16
    phi = math.radians(shear_angle)
    low = y - tool.tip_radius
    axes.plot([x, x - reach * math.cos(phi)], [low, low + reach * math.sin(phi)], "c--", label="shear plane")
    axes.set(
        xlim=(x - 0.3, x + 0.08), ylim=(y - 0.1, y + 0.3), aspect="equal", xlabel="x (mm)", ylabel="y (mm)"
    )
    axes.set_title(f"{name}: log10 of the plastic strain rate (1/s)")
    axes.legend(loc="upper left", fontsize="small")


if __name__ == "__main__":
    main()
