"""Cook's membrane: small strain, finite strain and J2 plasticity against Taylor-Hood elements, and the pressure."""

from __future__ import annotations

import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..common import Array, Run, orders, run, save_picture, set_keys, write_results

FOLDER = Path(__file__).parent
REFERENCE = FOLDER / "reference"
SIZES = (6.0, 3.0, 1.5, 0.75)
SMALL_STRAIN = 8.07e-3  # mm at 0.1 N/mm: the benchmark's value
SINGULAR = ((0.0, 44.0), (0.0, 0.0))
AWAY = 5.0  # mm from the clamped corners, where the pressure is singular


def elastic(size: float, force: float = 100.0, steps: int = 10, **keys: object) -> Run:
    """The rubber membrane under ``force`` (N/mm)."""
    load = {"y": {"time": [0.0, 1.0], "value": [0.0, force]}}
    keys = {"mesh.size": size, "time.step": 1.0 / steps, "boundary.1.force": load, **keys}
    return run(FOLDER / "case.toml", lambda table: set_keys(table, keys))


def plastic(size: float, steps: int = 50, **keys: object) -> Run:
    """The J2 membrane under 5 kN/mm."""
    keys = {"mesh.size": size, "time.step": 1.0 / steps, **keys}
    return run(FOLDER / "plastic.toml", lambda table: set_keys(table, keys))


def tip(run: Run) -> float:
    """Final u_y of the corner (48, 60) in mm."""
    return float(run.history["corner_uy"][-1])


def taylor_hood(file: str, **match: str) -> list[float]:
    """u_y of the committed Taylor-Hood runs that match, by increasing divisions, and their extrapolation."""
    with (REFERENCE / file).open(encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(stream) if all(row[k] == v for k, v in match.items())]
    found = [float(row["uy"]) for row in sorted(rows, key=lambda row: int(row["divisions"]))]
    a, b, c = found[-3:]
    return [
        *found,
        c + (c - b) ** 2 / ((b - a) - (c - b)),
    ]  # Aitken: the order is that of the corner singularity


def reference_pressure(points: Array) -> Array:
    """Taylor-Hood pressure (MPa) at initial positions (n, 2)."""
    from scipy.interpolate import RegularGridInterpolator

    grid = np.loadtxt(REFERENCE / "pressure.csv", delimiter=",")
    sides = np.linspace(0.0, 1.0, len(grid))
    s = points[:, 0] / 48.0
    t = (points[:, 1] - 44.0 * s) / (44.0 - 28.0 * s)
    return RegularGridInterpolator((sides, sides), grid)(np.clip(np.column_stack([s, t]), 0.0, 1.0))


def roughness(points: Array, cells: Array, values: Array, use: Array) -> float:
    """RMS over the particles ``use`` of the distance from the plane fitted through the neighbours."""
    pairs = np.unique(np.vstack([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=0)
    pairs = np.unique(np.vstack([pairs, pairs[:, ::-1]]), axis=0)
    off = []
    for i in np.flatnonzero(use):
        ring = pairs[pairs[:, 0] == i, 1]
        plane = np.column_stack([np.ones(len(ring)), points[ring] - points[i]])
        off.append(values[i] - np.linalg.lstsq(plane, values[ring], rcond=None)[0][0])
    return float(np.sqrt(np.mean(np.square(off))))


def pressure_figures(run: Run, against_reference: bool = True) -> dict[str, float]:
    """Roughness of the pressure field, and its error and the roughness of the reference at the same particles."""
    frame = run.method.frame()
    pressure = np.asarray(frame.point_fields["pressure"], dtype=float)
    initial = frame.points - np.asarray(frame.point_fields["displacement"], dtype=float)
    use = np.all([np.hypot(*(initial - corner).T) > AWAY for corner in SINGULAR], axis=0)
    inside = use.copy()
    inside[np.concatenate(frame.loops)] = False
    scale = 0.01 * float(np.sqrt(np.mean(pressure[use] ** 2)))
    figures = {
        "roughness_%": roughness(initial, frame.cells, pressure, inside) / scale,
        "roughness_of_reference_%": np.nan,
        "pressure_error_%": np.nan,
    }
    if against_reference:
        exact = reference_pressure(initial)
        figures["roughness_of_reference_%"] = roughness(initial, frame.cells, exact, inside) / scale
        figures["pressure_error_%"] = float(np.sqrt(np.mean((pressure - exact)[use] ** 2))) / scale
    return figures


def main() -> None:
    small = taylor_hood("neo_hookean.csv", force="0.1")
    finite = taylor_hood("neo_hookean.csv", force="100.0")
    metal = taylor_hood("plastic.csv", steps="50", load_spread_over="initial length")
    rows: list[dict[str, object]] = []
    runs = {}
    for case, exact, solve in (
        ("small strain", small[-1], lambda size: elastic(size, 0.1, 1)),
        ("finite strain", finite[-1], elastic),
        ("J2", metal[-1], plastic),
    ):
        block = []
        for size in SIZES:
            found = runs[case, size] = solve(size)
            error = 100.0 * (tip(found) / exact - 1.0)
            row = {
                "case": case,
                "size": size,
                "nodes": found.nodes,
                "tip_uy": tip(found),
                "taylor_hood_extrapolated": exact,
                "difference_%": error,
                "newton_per_step": found.newton,
                "energy_error": float(found.history["energy_error"][-1]),
                "seconds": found.seconds,
            }
            block.append({**row, **pressure_figures(found, case == "finite strain")})
            print(block[-1], flush=True)
        for row, order in zip(block, orders(SIZES, [r["difference_%"] for r in block]), strict=True):
            row["order"] = order
        rows += block
    unstabilised = {
        f"h = {size}": pressure_figures(elastic(size, solver={"stabilisation": 1e-5})) for size in (3.0, 1.5)
    }
    stabilised = {}
    for factor in (1.0, 10.0, 100.0):
        found = plastic(1.5, solver={"stabilisation": factor})
        stabilised[f"alpha_s = {factor}"] = {
            "difference_%": 100.0 * (tip(found) / metal[-1] - 1.0),
            **pressure_figures(found, against_reference=False),
        }
    remeshed = {}
    for history in ("pressure", "element", "mixed"):
        for size in (3.0, 1.5):
            keys = {"mesh.remesh": True, "mesh.volumetric_history": history}
            for case, solve in (("finite strain", elastic), ("J2", plastic)):
                try:
                    change = 100.0 * (tip(solve(size, **keys)) / tip(runs[case, size]) - 1.0)
                except Exception as failure:  # a figure too
                    remeshed[f"{case}, {history}, h = {size}"] = f"failed: {failure}"
                else:
                    remeshed[f"{case}, {history}, h = {size}"] = change
                print(history, size, case, remeshed[f"{case}, {history}, h = {size}"], flush=True)
    finest = {row["case"]: row for row in rows if row["size"] == SIZES[-1]}
    write_results(
        FOLDER,
        rows,
        {
            "reference": {
                "small_strain_published": SMALL_STRAIN,
                "small_strain_taylor_hood": small,
                "finite_strain_taylor_hood": finite,
                "J2_taylor_hood": metal,
                "last_entry": "extrapolated (Aitken)",
            },
            "finest": finest,
            "finite_strain_pressure_without_stabilisation": unstabilised,
            "J2_by_stabilisation_size_1.5": stabilised,
            "tip_changed_by_remeshing_every_step_%": remeshed,
        },
    )
    _draw(runs[("finite strain", 1.5)], runs[("J2", 1.5)], rows)


def _draw(rubber: Run, metal: Run, rows: list[dict[str, object]]) -> None:
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.7), layout="constrained")
    for axis, shown, title, limit in (
        (axes[0], rubber, "rubber, 100 N/mm", 12.0),
        (axes[1], metal, "J2, 5 kN/mm", 600.0),
    ):
        frame = shown.method.frame()
        pressure = frame.point_fields["pressure"]
        drawn = axis.tripcolor(
            *frame.points.T, frame.cells, pressure, shading="gouraud", cmap="RdBu_r", vmin=-limit, vmax=limit
        )
        figure.colorbar(drawn, label="pressure, tension positive (MPa)", shrink=0.8)
        axis.set(aspect="equal", title=f"{title}, h = 1.5 mm")
    frame = metal.method.frame()
    eqps = frame.cell_fields["equivalent_plastic_strain"]
    drawn = axes[2].tripcolor(*frame.points.T, frame.cells, eqps, cmap="magma_r", vmin=0, vmax=0.12)
    figure.colorbar(drawn, label="equivalent plastic strain", shrink=0.8)
    axes[2].set(aspect="equal", title="J2, h = 1.5 mm")
    for case, marker in (("small strain", "s"), ("finite strain", "o"), ("J2", "^")):
        errors = [-float(str(row["difference_%"])) for row in rows if row["case"] == case]
        axes[3].loglog(SIZES, errors, marker + "-", ms=4, label=case)
    axes[3].set_xticks(SIZES, [str(size) for size in SIZES])
    axes[3].minorticks_off()
    axes[3].set(xlabel="h (mm)", ylabel="tip below Taylor-Hood (%)")
    axes[3].legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
