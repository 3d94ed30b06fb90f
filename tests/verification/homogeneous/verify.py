"""Homogeneous tension and shear against the one-point integration, and a run seen from a rotating frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Array, Run, Table, orders, run, save_picture, write_results
from . import reference

FOLDER = Path(__file__).parent
STEPS = (25, 50, 100, 200, 400)
NEVER_WARM = 1e15  # heat capacity of an isothermal run


class Watch:
    """Mean stress (xx, yy, zz, xy), plastic strain and temperature after each step, and the stress's spread."""

    def __init__(self) -> None:
        self.rows: list[Array] = []
        self.spread = 0.0

    def __call__(self, method: PfemMethod, _: Table) -> None:
        frame = method.frame()
        stress = frame.cell_fields["cauchy_stress"]
        eqps = frame.cell_fields["equivalent_plastic_strain"].mean()
        self.rows.append(np.array([*stress.mean(axis=0), eqps, frame.point_fields["temperature"].mean()]))
        self.spread = max(self.spread, float(np.ptp(stress, axis=0).max()))

    @property
    def path(self) -> Array:
        return np.array(self.rows)


def homogeneous(name: str, steps: int, adiabatic: bool, integrator: str = "implicit") -> tuple[Run, Watch]:
    """A run of ``tension`` or ``shear``."""

    def change(table: Table) -> None:
        table["time"].update(step=1.0 / steps, integrator=integrator)
        if not adiabatic:
            table["body"][0]["material"]["capacity"] = NEVER_WARM

    watch = Watch()
    return run(FOLDER / f"{name}.toml", change, watch), watch


def path_of(point: reference.Point) -> Array:
    """The reference as rows like those of :class:`Watch`."""
    c = point.cauchy
    return np.column_stack([c[:, 0, 0], c[:, 1, 1], c[:, 2, 2], c[:, 0, 1], point.eqps, point.temperature])


def figures(name: str, steps: int, adiabatic: bool, integrator: str = "implicit") -> dict[str, Any]:
    """Differences from the one-point integration: the largest over the path, and that at the end."""
    found, watch = homogeneous(name, steps, adiabatic, integrator)
    times = found.history["time"]
    exact = path_of(getattr(reference, name)(times, adiabatic))
    error = np.abs(watch.path - exact)
    component = 0 if name == "tension" else 3  # the stress that drives
    scale = np.abs(exact[-1, component])
    heated = exact[-1, 5] - reference.THETA_0
    return {
        "problem": name,
        "heat": "adiabatic" if adiabatic else "isothermal",
        "integrator": integrator,
        "steps": steps,
        "stress_end": float(watch.path[-1, component]),
        "stress_end_reference": float(exact[-1, component]),
        "stress_end_%": 100.0 * float(error[-1, component] / scale),
        "stress_path_%": 100.0 * float(error[:, component].max() / scale),
        "other_stresses_end_MPa": float(np.delete(error[-1, :4], component).max()),
        "other_stresses_path_MPa": float(np.delete(error[:, :4], component, axis=1).max()),
        "eqps_end_%": 100.0 * float(error[-1, 4] / exact[-1, 4]),
        "warming_end_%": 100.0 * float(error[-1, 5] / heated) if adiabatic else np.nan,
        "spread_MPa": watch.spread,
        "energy_error": float(found.history["energy_error"][-1]),
    }


def rotated(turn: float, steps: int = 50, integrator: str = "implicit") -> tuple[Run, Array]:
    """A clamped block stretched by 20 % and sheared by 10 % while all turns by ``turn`` degrees, and the turn."""
    times = np.linspace(0.0, 1.0, steps + 1)
    angle = np.deg2rad(turn) * times
    rotation = np.moveaxis(np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]), 2, 0)
    stretch = np.tile(np.eye(2), (steps + 1, 1, 1))
    stretch[:, 0, 0] += 0.2 * times
    stretch[:, 1, 0] += 0.1 * times
    boundary = [
        {
            "part": part,
            "gradient": {
                f"{'xy'[i]}{'xy'[j]}": {
                    "time": times.tolist(),
                    "value": ((rotation @ stretch)[:, i, j] - np.eye(2)[i, j]).tolist(),
                }
                for i in range(2)
                for j in range(2)
            },
        }
        for part in ("left", "right")
    ]

    def change(table: Table) -> None:
        table["mesh"]["size"] = 0.2
        table["time"].update(step=1.0 / steps, integrator=integrator)
        table.update(solver={"tolerance": 1e-10}, boundary=boundary)

    return run(FOLDER / "tension.toml", change), rotation[-1]


def objectivity(integrator: str = "implicit", steps: int = 50) -> dict[str, float]:
    """Largest differences between the run that turns by 90 degrees, turned back, and the one that does not."""
    (still, _), (turned, rotation) = rotated(0.0, steps, integrator), rotated(90.0, steps, integrator)
    a, b = still.method.frame(), turned.method.frame()

    def tensor(stress: Array) -> Array:
        return np.stack([stress[:, [0, 3]], stress[:, [3, 1]]], axis=1)

    stress = tensor(a.cell_fields["cauchy_stress"])
    back = rotation.T @ tensor(b.cell_fields["cauchy_stress"]) @ rotation
    eqps = "equivalent_plastic_strain"
    return {
        "position_mm": float(np.abs(b.points @ rotation - a.points).max()),
        "stress_MPa": float(np.abs(back - stress).max()),
        "eqps": float(np.abs(a.cell_fields[eqps] - b.cell_fields[eqps]).max()),
        "temperature_K": float(np.abs(a.point_fields["temperature"] - b.point_fields["temperature"]).max()),
        "step_cuts": float(turned.history["step_cuts"][-1]),
        "newton_per_step_still": still.newton,
        "newton_per_step_turned": turned.newton,
        "largest_eqps": float(a.cell_fields[eqps].max()),
        "largest_stress_MPa": float(np.abs(stress).max()),
    }


def main() -> None:
    rows = []
    for name in ("tension", "shear"):
        for adiabatic in (False, True):
            for integrator in ("implicit", "impl-ex"):
                steps = STEPS if integrator == "implicit" else (100, 200, 400)
                block = [figures(name, n, adiabatic, integrator) for n in steps]
                sizes = [1.0 / n for n in steps]
                for key in ("stress_end_%", "stress_path_%", "warming_end_%"):
                    for row, order in zip(block, orders(sizes, [r[key] for r in block]), strict=True):
                        row[f"order_{key[:-2]}"] = order
                rows += block
                print(*block, sep="\n")
    last = {f"{r['problem']}, {r['heat']}, {r['integrator']}": r for r in rows if r["steps"] == 400}
    write_results(
        FOLDER,
        rows,
        {
            "with_400_steps": last,
            "objectivity_90_degrees": objectivity(),
            "objectivity_90_degrees_impl-ex": objectivity("impl-ex"),
        },
    )
    _draw()


def _draw() -> None:
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    times = np.linspace(0.002, 1.0, 500)
    for axis, name, labels in (
        (axes[0], "tension", ((0, "σxx"), (2, "σzz"))),
        (axes[1], "shear", ((3, "σxy"), (1, "σyy"))),
    ):
        for adiabatic, colour in ((False, "C0"), (True, "C3")):
            exact = path_of(getattr(reference, name)(times, adiabatic))
            found, watch = homogeneous(name, 50, adiabatic)
            for (component, label), style in zip(labels, ("o", "^"), strict=True):
                axis.plot(times, exact[:, component], colour, lw=0.9)
                heat = "adiabatic" if adiabatic else "isothermal"
                axis.plot(
                    found.history["time"][::2],
                    watch.path[::2, component],
                    colour + style,
                    ms=3,
                    label=f"{label}, {heat}",
                )
        axis.set(
            xlabel="2 × elongation" if name == "tension" else "shear",
            ylabel="Cauchy stress (MPa)",
            title=name,
        )
        axis.legend(fontsize=7)
    figure.suptitle("lines: one-point integration; marks: pfemcut, 50 steps", fontsize=9)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
