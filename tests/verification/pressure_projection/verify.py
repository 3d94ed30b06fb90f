"""Elastic against secant modulus in the pressure projection: roughness of the pressure, and what it does to the rest.

    python -m tests.verification.pressure_projection.verify [DIR]

Cook's membrane, Prandtl's punch, thick cylinder and necking as in their own folders, and the reduced AISI 4340 cut
over 0.3 mm, whose runs go to DIR (``out/verification/pressure_projection``) and are resumed there (10 minutes).
"""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.case.load import validated
from pfemcut.driver import run_case
from pfemcut.inputs import read_toml
from pfemcut.method import Frame
from pfemcut.output.directory import SUMMARY
from pfemcut.output.vtu import read_last_frame

from ..common import Run, Table, run, set_keys, write_results
from ..cook_membrane.verify import plastic, roughness, taylor_hood, tip
from ..necking.reference import read_curve
from ..necking.verify import FOLDER as NECKING
from ..prandtl_punch.verify import FOLDER as PUNCH
from ..prandtl_punch.verify import LIMIT, mean_pressure
from ..thick_cylinder.verify import FOLDER as CYLINDER
from ..thick_cylinder.verify import figures

FOLDER = Path(__file__).parent
DEMO = FOLDER.parents[2] / "demos" / "aisi4340_demo"
RULES = ("elastic", "secant")


def pressure_roughness(frame: Frame, reach: tuple[float, ...] = ()) -> float:
    """Distance of the pressure from the plane through its neighbours (RMS, % of the RMS pressure), off the surface.

    Of all particles, or of those in the box (x, y) +- ``reach`` about the tool's tip.
    """
    pressure = np.asarray(frame.point_fields["pressure"], dtype=np.float64)
    inside = np.ones(len(pressure), dtype=bool)
    inside[np.concatenate(frame.loops)] = False
    for axis, half in enumerate(reach):
        inside &= np.abs(frame.points[:, axis] - frame.tool[0].centre[axis]) < half
    rms = float(np.sqrt(np.mean(pressure[inside] ** 2)))
    return 100.0 * roughness(frame.points, frame.cells, pressure, inside) / rms


def varied(folder: Path, rule: str, keys: dict[str, Any]) -> Run:
    """The case in ``folder`` with the projection's ``rule`` and other keys."""

    def change(table: Table) -> None:
        table["solver"] = {**table.get("solver", {}), "stabilisation_modulus": rule}
        set_keys(table, keys)

    return run(folder / "case.toml", change)


def row(problem: str, size: float, rule: str, result: Run, figure: str, value: float) -> dict[str, Any]:
    """One line of the table."""
    history = result.history
    work = history["boundary_work"][-1]
    return {
        "problem": problem,
        "h": size,
        "modulus": rule,
        "figure": figure,
        "value": value,
        "roughness_%": pressure_roughness(result.method.frame()),
        "newton_per_step": result.newton,
        "energy_error_%": 100.0 * float(history["energy_error"][-1]),
        "stabilisation_work_%": 100.0 * float(history["stabilisation_work"][-1] / work),
    }


def problems(rule: str) -> Iterator[dict[str, Any]]:
    """The short problems."""
    exact = taylor_hood("plastic.csv", steps="50", load_spread_over="initial length")[-1]
    for size in (3.0, 1.5):
        found = plastic(size, solver={"stabilisation_modulus": rule})
        error = 100.0 * (tip(found) / exact - 1.0)
        yield row("Cook, J2", size, rule, found, "tip below Taylor-Hood (%)", error)
    for size in (0.2, 0.1):
        found = varied(PUNCH, rule, {"mesh.refine.0.size": size})
        overshoot = 100.0 * float(mean_pressure(found).max() / LIMIT - 1.0)
        yield row("punch", size, rule, found, "overshoot (%)", overshoot)
    for size in (25.0, 12.5):
        found = varied(CYLINDER, rule, {"mesh.size": size})
        limit = figures(found, 1.0)["last_over_finite_strain_limit_%"]
        yield row("thick cylinder", size, rule, found, "over the finite-strain limit (%)", limit)
    zone = {"start": [0.0, 0.0], "end": [0.0, 6.413], "radius": 4.0, "growth": 0.1}
    curve = read_curve(NECKING / "reference_isothermal.csv")
    expected = float(np.interp(8.0, curve["elongation"], curve["force"]))
    for size in (1.6, 0.8):
        mesh = {"mesh.refine": [{**zone, "size": size}], "mesh.size": 2.0 * size, "mesh.remesh": True}
        material = {"body.0.material.taylor_quinney": 0.0}
        found = varied(NECKING, rule, {**mesh, **material, "time.step": 0.01, "time.end": 0.8})
        error = 100.0 * (2.0 * float(found.history["reaction_end_x"][-1]) / expected - 1.0)
        yield row("necking, 8 mm", size, rule, found, "force over F-bar (%)", error)


def cut(rule: str, directory: Path) -> dict[str, Any]:
    """The reduced cut."""
    table = read_toml(DEMO / "case.toml")
    set_keys(table, {"cutting.travel": 0.3, "solver": {"stabilisation_modulus": rule}})
    table["output"]["figures"] = False
    case, material = validated(table, DEMO)
    if not (directory / SUMMARY).exists():
        run_case(case, material, directory, resume=(directory / "checkpoint.h5").exists())
    summary = json.loads((directory / SUMMARY).read_text())
    with (directory / "history.csv").open(encoding="utf-8") as stream:
        history = list(csv.DictReader(stream))
    late = [each for each in history if float(each["travel"]) > 0.2]
    force, thrust, newton = (
        np.array([float(each[name]) for each in late])
        for name in ("cutting_force", "thrust_force", "newton_iterations")
    )
    frame = read_last_frame(directory)
    return {
        "problem": "cut, 0.2 to 0.3 mm",
        "h": 0.01,
        "modulus": rule,
        "figure": "cutting force (N/mm)",
        "value": float(force.mean()),
        "roughness_%": pressure_roughness(frame, (0.15, 0.15)),
        "newton_per_step": float(newton.mean()),
        "energy_error_%": 100.0 * summary["energy_error"]["value"],
        "stabilisation_work_%": 100.0
        * summary["ledgers"]["stabilisation_work"]
        / summary["ledgers"]["tool_work"],
        "thrust_force": float(thrust.mean()),
        "cutting_force_std": float(force.std()),
        "thrust_force_std": float(thrust.std()),
        "max_temperature": summary["max_temperature"]["mean"],
        "contact_length": summary["contact_length"]["mean"],
    }


def main() -> None:
    """All problems with both rules."""
    default = Path("out") / "verification" / "pressure_projection"
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    rows = []
    for rule in RULES:
        for found in (*problems(rule), cut(rule, root / rule)):
            print(found, flush=True)
            rows.append(found)
    rows.sort(key=lambda each: (each["problem"], -each["h"]))
    write_results(FOLDER, rows, {})


if __name__ == "__main__":
    main()
