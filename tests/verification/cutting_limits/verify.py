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
from scipy.optimize import brentq

from meshing.mesh import signed_areas
from pfemcut.case.load import load_case
from pfemcut.case.schema import Case
from pfemcut.driver import run_case
from pfemcut.materials.material import Material
from pfemcut.materials.volumetric import volume_ratio_from_pressure
from pfemcut.method import Frame
from pfemcut.output.directory import SUMMARY
from pfemcut.output.vtu import read_last_frame
from pfemcut.results.derived.chip_section import chip_section, to_rake_frame

from ..common import save_picture, write_results, write_table
from .slip_lines import CurledChip, curled_chip
from .variants import budget

FOLDER = Path(__file__).parent
CASES = ("sharp", "slip_line")
SHEAR_STRENGTH = 900.0 / math.sqrt(3.0)
"""k of ``slip_line.toml`` (MPa)."""


FANS = (2.5, 5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0)
"""Fan angles (degrees) of the tabled slip-line fields."""


def finished_run(name: str, directory: Path) -> tuple[Case, Material, dict[str, Any], Frame]:
    """The case, its material, the summary and the last frame of a run, which is started, gone on with or only read."""
    case, material = load_case(FOLDER / f"{name}.toml")
    assert isinstance(case, Case)
    if not (directory / SUMMARY).exists():
        run_case(case, material, directory, resume=(directory / "checkpoint.h5").exists())
    return case, material, json.loads((directory / SUMMARY).read_text()), read_last_frame(directory)


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


def chip_volume_ratio(frame: Frame, material: Material, depth: float) -> float:
    """Mean J of the chip between the stations where its thickness and speed are measured."""
    tool = frame.tool[0]
    along = to_rake_frame(frame.points, tool)[:, 0]
    stations = chip_section(frame, tool, depth).rake_side[:, 0]
    inside = (along > stations.min()) & (along < stations.max())
    pressure, temperature = (
        np.asarray(frame.point_fields[field], dtype=np.float64)[inside]
        for field in ("pressure", "temperature")
    )
    strain = material.thermal_strain(temperature)
    return float(volume_ratio_from_pressure(pressure / material.bulk_modulus, strain).mean())


def curled_chip_as_thick_as(thickness: float) -> CurledChip:
    """The slip-line field whose chip is ``thickness`` times as thick as the cut."""

    def difference(fan: float) -> float:
        return curled_chip(fan).thickness - thickness

    return curled_chip(float(brentq(difference, *np.radians((FANS[0], FANS[-1])), xtol=1e-4)))


def limits(name: str, directory: Path) -> tuple[dict[str, Any], Frame]:
    """Computed figures of one cut beside what theory gives."""
    case, material, summary, frame = finished_run(name, directory)
    mean = {
        key: value["mean"] for key, value in summary.items() if isinstance(value, dict) and "mean" in value
    }
    depth, speed = case.cutting.depth, case.cutting.speed
    phi = math.radians(mean["shear_angle"])
    stress = shear_flow_stress(frame, depth)
    on_plane = mean["cutting_force"] * math.cos(phi) - mean["thrust_force"] * math.sin(phi)
    flux = mean["chip_speed"] * mean["chip_thickness"] / (speed * depth)
    volume_ratio = chip_volume_ratio(frame, material, depth)
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
        "shear_angle_of_speeds": math.degrees(math.atan(mean["chip_speed"] / speed)),
        "chip_flux_difference": flux - 1.0,
        "chip_volume_ratio": volume_ratio,
        "chip_mass_flux_difference": flux / volume_ratio - 1.0,
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
        curled = curled_chip_as_thick_as(mean["chip_thickness"] / depth)
        found["curled_chip_cutting_force"] = curled.cutting_force * force
        found["curled_chip_cutting_force_difference"] = (
            mean["cutting_force"] / (curled.cutting_force * force) - 1.0
        )
        found["curled_chip_contact_length"] = curled.contact_length * depth
        found["curled_chip_curvature"] = curled.curvature / depth
        found |= budget(frame, SHEAR_STRENGTH)
        found["contact_above_tip"] = mean["contact_length"] + case.tool.tip_radius
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
    fields = [{"fan_degrees": fan, **vars(curled_chip(math.radians(fan)))} for fan in FANS]
    write_table(FOLDER / "results" / "slip_line_fields.csv", fields)
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
