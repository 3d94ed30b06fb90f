"""Run the mesh ladder of the thick-walled cylinder and compare it with the exact and the radial solutions."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..common import Array, Run, Table, orders, run, save_picture, set_keys, write_results
from . import reference as exact

FOLDER = Path(__file__).parent
SIZES = (50.0, 25.0, 12.5, 6.25, 3.125)
STIFF = 100.0  # factor on E, with the displacements divided by it: small strain at the same stresses


def cylinder(size: float, stiffness: float = 1.0, **keys: object) -> Run:
    """A run with the mesh ``size`` (mm), E times ``stiffness`` and the bore displacement divided by it."""

    def change(table: Table) -> None:
        set_keys(table, {"mesh.size": size, **keys})
        material, gradient = table["body"][0]["material"], table["boundary"][2]["gradient"]
        material["young_modulus"] *= stiffness
        for component in gradient.values():
            component["value"][1] /= stiffness

    return run(FOLDER / "case.toml", change)


def bore_pressure(cylinder: Run) -> Array:
    """Pressure (MPa) on the current surface of the bore, from the work of its support forces."""
    history = cylinder.history
    work = history["moment_bore_xx"] + history["moment_bore_yy"]  # = A int p dl over the quarter circle
    return work / (0.5 * np.pi * exact.A * (exact.A + history["bore_ux"]))


def figures(cylinder: Run, stiffness: float) -> dict[str, float]:
    """Differences from the references, in percent."""
    history, pressure = cylinder.history, bore_pressure(cylinder)
    bore, outer = stiffness * history["bore_ux"], stiffness * history["outer_ux"]
    radial_pressure, radial_outer = exact.radial_solution(bore)
    rigid = 2.0 * exact.K * np.log((exact.B + history["outer_ux"]) / (exact.A + history["bore_ux"]))
    rising = (radial_pressure > 110.0) & (radial_pressure < 180.0)
    hill = exact.outer_displacement_at(pressure[rising])
    return {
        "largest_pressure": float(pressure.max()),
        "limit_difference_%": 100.0 * (float(pressure.max()) / exact.LIMIT_PRESSURE - 1.0),
        "last_over_finite_strain_limit_%": 100.0 * float(pressure[-1] / rigid[-1] - 1.0),
        "pressure_from_radial_%": 100.0 * float(np.abs(pressure / radial_pressure - 1.0).max()),
        "outer_from_radial_%": 100.0 * float(np.abs(outer / radial_outer - 1.0).max()),
        "outer_from_hill_%": 100.0 * float(np.abs(outer[rising] / hill - 1.0).max()),
    }


def main() -> None:
    rows, runs = [], {}
    for stiffness in (1.0, STIFF):
        for size in SIZES:
            found = runs[size, stiffness] = cylinder(size, stiffness)
            row = {"size": size, "nodes": found.nodes, "young_modulus": 210e3 * stiffness}
            rows.append({**row, **figures(found, stiffness), "seconds": found.seconds})
            print(rows[-1])
        block = rows[-len(SIZES) :]
        for row, order in zip(
            block, orders(SIZES, [r["pressure_from_radial_%"] for r in block]), strict=True
        ):
            row["order_pressure"] = order
    remeshed = figures(cylinder(6.25, **{"mesh.remesh": True}), 1.0)
    write_results(
        FOLDER,
        rows,
        {
            "reference": {"limit_pressure": exact.LIMIT_PRESSURE},
            "finest": rows[len(SIZES) - 1],
            "finest_small_strain": rows[-1],
            "remeshed_every_step_size_6.25": remeshed,
        },
    )
    _draw(runs)


def _draw(runs: dict[tuple[float, float], Run]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    c = np.linspace(exact.A, exact.B, 200)
    left.plot(
        exact.outer_displacement(c), exact.pressure(c), "k-", lw=1, label="exact, incompressible (Hill)"
    )
    left.axhline(exact.LIMIT_PRESSURE, color="k", ls=":", lw=1, label="limit pressure 192.09 MPa")
    for size, marker in ((50.0, "^"), (12.5, "o")):
        found = runs[size, 1.0]
        left.plot(
            found.history["outer_ux"], bore_pressure(found), marker, ms=3, label=f"E = 210 GPa, h = {size} mm"
        )
    found = runs[3.125, STIFF]
    left.plot(
        STIFF * found.history["outer_ux"],
        bore_pressure(found),
        "C3-",
        lw=1,
        label="E = 21 TPa, h = 3.125 mm (displacement × 100)",
    )
    left.set(xlabel="displacement of the outer surface (mm)", ylabel="pressure (MPa)")
    left.legend(fontsize=7)
    frame = runs[3.125, 1.0].method.frame()
    middle = frame.points[frame.cells].mean(axis=1)
    radius, (x, y) = np.hypot(*middle.T), middle.T
    xx, yy, _, xy = frame.cell_fields["cauchy_stress"].T
    hoop = (xx * y**2 + yy * x**2 - 2.0 * xy * x * y) / radius**2
    radial = (xx * x**2 + yy * y**2 + 2.0 * xy * x * y) / radius**2
    right.plot(radius, hoop, "C0.", ms=1, label="hoop")
    right.plot(radius, radial, "C1.", ms=1, label="radial")
    r = np.linspace(exact.A, exact.B, 100)
    limit = 2.0 * exact.K * np.log(r / exact.B)
    right.plot(r, limit, "k-", lw=0.8, label="rigid plastic, initial radii")
    right.plot(r, limit + 2.0 * exact.K, "k-", lw=0.8)
    right.set(xlabel="current radius (mm)", ylabel="Cauchy stress at the end (MPa)")
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
