"""Run the mesh ladder of Prandtl's punch: overshoot over the limit load (2 + pi) k."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..common import Array, Run, Table, orders, run, save_picture, write_results

FOLDER = Path(__file__).parent
K = 100.0  # MPa
LIMIT = (2.0 + np.pi) * K  # Prandtl 1920: mean pressure under a smooth or rough punch
SIZES = (0.4, 0.2, 0.1, 0.05, 0.025)


def punch(size: float, rough: bool = False) -> Run:
    """A run with the spacing ``size`` (mm) under and beside the punch, which may hold the surface."""

    def change(table: Table) -> None:
        table["mesh"]["refine"][0]["size"] = size
        if rough:
            table["boundary"][3]["displacement"]["x"] = 0.0

    return run(FOLDER / "case.toml", change)


def mean_pressure(punch: Run) -> Array:
    """Force over the nominal half-width of 1 mm (MPa)."""
    return -punch.history["reaction_punch_y"]


def main() -> None:
    rows, runs = [], {}
    for rough, sizes in ((False, SIZES), (True, SIZES[:4])):
        block = []
        for size in sizes:
            found = runs[size, rough] = punch(size, rough)
            pressure = mean_pressure(found)
            row = {
                "surface": "rough" if rough else "smooth",
                "size_over_half_width": size,
                "nodes": found.nodes,
                "largest_mean_pressure": float(pressure.max()),
                "overshoot_%": 100.0 * float(pressure.max() / LIMIT - 1.0),
                "slope_at_end_%": 100.0 * float((pressure[-1] - pressure[-9]) / LIMIT),
                "newton_per_step": found.newton,
                "energy_error": float(found.history["energy_error"][-1]),
                "seconds": found.seconds,
            }
            block.append(row)
            print(row)
        for row, order in zip(block, orders(sizes, [r["overshoot_%"] for r in block]), strict=True):
            row["order"] = order
        rows += block
    smooth = {row["size_over_half_width"]: row["overshoot_%"] for row in rows if row["surface"] == "smooth"}
    rough_overshoot = {
        row["size_over_half_width"]: row["overshoot_%"] for row in rows if row["surface"] == "rough"
    }
    fine, finest = smooth[SIZES[-2]], smooth[SIZES[-1]]
    write_results(
        FOLDER,
        rows,
        {
            "reference": {"limit_mean_pressure": LIMIT},
            "overshoot_%_by_size_smooth": {str(key): value for key, value in smooth.items()},
            "overshoot_%_by_size_rough": {str(key): value for key, value in rough_overshoot.items()},
            "overshoot_%_extrapolated_linearly_to_zero_size": 2.0 * finest - fine,
        },
    )
    _draw(runs)


def _draw(runs: dict[tuple[float, bool], Run]) -> None:
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.5, 3.6), layout="constrained", width_ratios=(1, 1.25)
    )
    for (size, rough), found in runs.items():
        if not rough:
            depth = 5e-4 * found.history["time"]
            left.plot(1e5 * depth, mean_pressure(found) / K, label=f"h = {size} half-widths")
    left.axhline(LIMIT / K, color="k", ls=":", label="2 + π")
    left.set(xlabel="penetration / k × E  (half-widths)", ylabel="mean pressure / k")
    left.legend(fontsize=7)
    frame = runs[0.05, False].method.frame()
    rate = frame.cell_fields["equivalent_plastic_strain_rate"]
    drawn = right.tripcolor(
        *frame.points.T, frame.cells, rate / np.quantile(rate, 0.99), cmap="magma_r", vmin=0, vmax=1
    )
    figure.colorbar(drawn, label="plastic strain rate (scaled), h = 0.05")
    # The slip lines that bound Prandtl's and Hill's mechanisms of a smooth punch.
    right.set(xlim=(0, 3.5), ylim=(-1.8, 0.1), aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    angle = np.linspace(-0.75 * np.pi, -0.25 * np.pi, 40)
    for reach in (1.0, 2.0):
        fan = 1.0 + reach / np.sqrt(2.0) * np.cos(angle), reach / np.sqrt(2.0) * np.sin(angle)
        x = np.concatenate([[1.0 - reach], fan[0], [1.0 + reach]])
        right.plot(x, np.concatenate([[0.0], fan[1], [0.0]]), "C0-", lw=0.8)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
