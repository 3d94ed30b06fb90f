"""Heat conduction between particles: a cosine that dies away in a rod, and a bar of two materials."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.heat import Conduction, heat_content, pair_flow
from pfemcut.particles.integrate import initial_state
from pfemcut.particles.lattice import box_lattice
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from tests.particle_problems import ELASTIC, block

from ..common import Array, orders, save_picture, write_results

FOLDER = Path(__file__).parent
DIFFUSIVITY = 50.0 / (7.8e-9 * 470e6)
TIME = 1.0 / (DIFFUSIVITY * np.pi**2)
COUNTS = (10, 20, 40, 80)


def rod(count: int, dimension: int, disorder: float, method: str = "tlsph") -> dict[str, float]:
    """A rod of 1 mm, 0.2 mm across; its cosine after the time in which it falls to 1/e."""
    spacing = 1.0 / count
    problem = block((1.0, *[0.2] * (dimension - 1)), method=method, material=ELASTIC, spacing=spacing)
    model: Any = (TotalLagrangian if method == "tlsph" else Eulerian)(problem)
    state: Any = initial_state(model)
    random = np.random.default_rng(1)
    moved = problem.points + disorder * spacing * random.normal(size=problem.points.shape)
    mode = np.cos(np.pi * moved[:, 0])
    state = replace(state, positions=moved, material=state.material.heated(100.0 * mode))
    before = heat_content(problem, state.material.temperature)
    state = Conduction(problem).conducted(state, TIME)
    after = heat_content(problem, state.material.temperature)
    excess = state.material.temperature - 293.0
    rate = -np.log(float(mode @ excess / (100.0 * mode @ mode)))
    scale = float(problem.mass.sum()) * 470e6 * 100.0
    return {"rate_error_%": 100.0 * (rate - 1.0), "heat_lost": abs(after - before) / scale}


def two_materials(count: int) -> tuple[Array, Array, Array, float]:
    """A bar of conductivities 10 and 90 between fixed ends: x, steady temperatures, exact ones, error of the flux."""
    spacing, length = 2.0 / count, 2.0
    points, volume = box_lattice(np.zeros(2), np.array([length, 0.4]), spacing)
    left, fixed = points[:, 0] < 1.0, (points[:, 0] < 0.2) | (points[:, 0] > 1.8)
    conductivity = np.where(left, 10.0, 90.0)
    exact = np.where(left, 90.0 * points[:, 0], 90.0 + 10.0 * (points[:, 0] - 1.0))
    neighbours = NeighbourList(3.0 * spacing)
    neighbours.follow(points)
    rest = (np.zeros(len(points), dtype=np.int64), points, np.full(len(points), volume), conductivity)

    def power(temperature: Array) -> Array:
        return pair_flow(neighbours, *rest, temperature, 1.5 * spacing).power

    matrix = np.column_stack([power(unit) for unit in np.eye(len(points))])
    found = exact.copy()
    free = ~fixed
    found[free] = np.linalg.solve(matrix[np.ix_(free, free)], -matrix[np.ix_(free, fixed)] @ exact[fixed])
    flux = float(power(found)[points[:, 0] > 1.8].sum()) / 0.4
    return points[:, 0], found, exact, abs(flux) / 900.0 - 1.0


def main() -> None:
    rows: list[dict[str, Any]] = []
    for dimension, disorder, method in (
        (2, 0.0, "tlsph"),
        (2, 0.1, "tlsph"),
        (3, 0.0, "tlsph"),
        (2, 0.0, "esph"),
    ):
        counts = COUNTS if dimension == 2 else COUNTS[:3]
        found = [rod(count, dimension, disorder, method) for count in counts]
        order = orders([1.0 / count for count in counts], [each["rate_error_%"] for each in found])
        for count, each, at in zip(counts, found, order, strict=True):
            rows.append(
                {
                    "problem": f"rod, {dimension}D, {method}",
                    "disorder": disorder,
                    "particles_along": count,
                    **each,
                    "order": at,
                }
            )
            print(rows[-1])
    figure, axes = plt.subplots(1, 2, figsize=(8.4, 3.3), layout="constrained")
    for name, disorder in (("rod, 2D, tlsph", 0.0), ("rod, 2D, tlsph", 0.1), ("rod, 3D, tlsph", 0.0)):
        part = [row for row in rows if row["problem"] == name and row["disorder"] == disorder]
        label = name + (", disturbed" if disorder else "")
        axes[0].loglog(
            [row["particles_along"] for row in part],
            [abs(row["rate_error_%"]) for row in part],
            "o-",
            label=label,
        )
    axes[0].set(xlabel="particles along the rod", ylabel="error of the rate of decay (%)")
    axes[0].set_xticks(COUNTS, [str(count) for count in COUNTS])
    axes[0].minorticks_off()
    axes[0].legend(fontsize=7)
    errors = []
    for count in (20, 40, 80):
        x, found, exact, flux = two_materials(count)
        errors.append(100.0 * float(np.abs(found - exact).max()) / 100.0)
        rows.append(
            {
                "problem": "two materials",
                "particles_along": count,
                "temperature_error_%": errors[-1],
                "flux_error_%": 100.0 * flux,
            }
        )
        print(rows[-1])
        if count == 40:
            axes[1].plot(np.sort(x), np.sort(exact), "k-", lw=0.8, label="exact")
            axes[1].plot(x, found, "C3.", ms=3, label="40 particles along")
    axes[1].set(xlabel="x (mm)", ylabel="temperature", title="conductivities 10 and 90")
    axes[1].legend(fontsize=7)
    save_picture(FOLDER, figure)
    chosen = {
        f"{row['problem']}{', disturbed' if row.get('disorder') else ''}": row
        for row in rows
        if row["particles_along"] == 40
    }
    write_results(FOLDER, rows, {"with_40": chosen})


if __name__ == "__main__":
    main()
