"""What the force of the perfectly plastic cut depends on: its run goes on for 0.02 mm with one setting changed.

    python -m tests.verification.cutting_limits.variants DIR

DIR holds the finished run of ``slip_line.toml`` (``out/verification/slip_line``). The last third counts, so that the
force is that of the new setting, though the chip is not yet renewed. With another modulus stresses and pressures are
kept. Three minutes.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from meshing.mesh import signed_areas
from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.materials.return_mapping import elastic_strain
from pfemcut.method import Frame
from pfemcut.pfem.method import PfemMethod
from pfemcut.results.checkpoint import read_checkpoint

from ..common import set_keys, write_table

FOLDER = Path(__file__).parent
FURTHER = 0.02  # mm
SPEED = 3330.0
VARIANTS: dict[str, dict[str, Any]] = {
    "base": {},
    "implicit": {"time.integrator": "implicit"},
    "half the tip radius and its spacing": {"tool.tip_radius": 0.0025, "mesh.tip_size": 0.00075},
    "finer shear zone (0.005) and chip (0.01)": {"mesh.shear_zone_size": 0.005, "mesh.chip_size": 0.01},
    "implicit, four times E": {"workpiece.material.young_modulus": 8e5, "time.integrator": "implicit"},
    "elastic modulus in the projection": {"solver": {"stabilisation_modulus": "elastic"}},
}


def go_on(directory: Path, keys: dict[str, Any]) -> dict[str, float]:
    """Means over the last third of the way."""
    table = read_toml(FOLDER / "slip_line.toml")
    travel, modulus = table["cutting"]["travel"], table["workpiece"]["material"]["young_modulus"]
    set_keys(table, {**keys, "cutting.travel": travel + FURTHER})
    stiffer = table["workpiece"]["material"]["young_modulus"] / modulus
    case, material = validated(table, FOLDER)
    problem = problem_of(case, material, FOLDER)
    arrays = dict(read_checkpoint(directory).state)
    deviator = np.array(arrays["fields/b_elastic"], dtype=np.float64)
    if stiffer != 1.0:
        deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
        arrays["fields/b_elastic"] = elastic_strain(deviator / stiffer, 1.0)
    arrays["clock/next_dt"] = np.asarray(0.25 * problem.time.step)
    method = PfemMethod.restore(problem, arrays)
    rows = []
    while not method.finished:
        method.advance()
        force, newton = method.record.tool_force, method.record.newton_iterations
        frame = method.frame()
        tool = frame.tool[0]
        below = frame.points[frame.cells].mean(axis=1)[:, 1] < tool.centre[1] - tool.tip_radius
        power = frame.cell_fields["plastic_power"] * signed_areas(frame.points, frame.cells) / SPEED
        loaded = frame.contact.arc_length.max() + tool.tip_radius
        row = (frame.travel, *force, power.sum(), power[below].sum(), loaded, newton)
        rows.append(row)
    history = np.array(rows)
    late = history[history[:, 0] > travel + 2.0 / 3.0 * FURTHER]
    names = (
        "cutting_force",
        "thrust_force",
        "plastic_power_over_speed",
        "plastic_power_below_the_cut_over_speed",
        "contact_above_tip",
        "newton",
    )
    means = dict(zip(names, map(float, late[:, 1:].mean(axis=0)), strict=True))
    return {**means, "cutting_force_std": float(late[:, 1].std())}


def budget(frame: Frame, strength: float) -> dict[str, float]:
    """Plastic work (N/mm: per length of cut and width) in the machined layer, and the mean shear strain of the chip.

    The layer is measured from 0.03 to 0.15 mm behind the tip; the chip from 0.3 to 1 depth above the uncut surface,
    in the 0.04 mm next to the rake and in the rest.
    """
    tool = frame.tool[0]
    areas = signed_areas(frame.points, frame.cells)
    work = frame.cell_fields["equivalent_plastic_strain"] * areas * np.sqrt(3.0) * strength
    x, height = (frame.points[frame.cells].mean(axis=1) - tool.centre).T
    height = height + tool.tip_radius
    layer = (x > 0.03) & (x < 0.15) & (height < tool.tip_radius)
    chip = (height > 0.13) & (height < 0.2) & (x < 0.0)
    near = chip & (tool.closest(frame.points[frame.cells].mean(axis=1)).gap < 0.04)
    strains = {
        name: float(work[where].sum() / (strength * areas[where].sum()))
        for name, where in (("chip_shear_strain_near_rake", near), ("chip_shear_strain", chip & ~near))
    }
    return {"machined_layer_work": float(work[layer].sum()) / 0.12, **strains}


def main() -> None:
    """All variants."""
    directory = Path(sys.argv[1])
    rows = []
    for name, keys in VARIANTS.items():
        rows.append({"variant": name, **go_on(directory, keys)})
        print(rows[-1], flush=True)
        write_table(FOLDER / "results" / "variants.csv", rows)


if __name__ == "__main__":
    main()
