"""Sliding at cutting speed, sticking under a drag, driven beyond it, and coasting to a stop."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Array, Run, Table, run, save_picture, weights, write_results
from .reference import coasting_speed, creep_speed

FOLDER = Path(__file__).parent

PRESSURE, FRICTION, LENGTH, HEIGHT, SPEED, V_REF = 100.0, 0.3, 1.0, 0.2, 3330.0, 1.0
FLOW_STRESS = 1000.0
LIMIT = FRICTION * PRESSURE * LENGTH
MASS = 7.844e-9 * LENGTH * HEIGHT
# With inertia: so light a pressure that the block stops in many transits of sound, and comes on slowly enough.
LIGHT = 0.1
STOP = MASS * SPEED / (LIGHT * LIMIT)
RAMP = 0.3 * STOP


def sliding(size: float = 0.1, remesh: bool = True) -> Run:
    """The case as it is: the bottom moves at cutting speed."""
    return run(FOLDER / "case.toml", lambda table: table["mesh"].update(size=size, remesh=remesh))


def dragged(ratio: float, step: float = 1e-3, steps: int = 10, size: float = 0.1) -> Run:
    """Quasi-static, dragged by ``ratio`` of the friction limit."""

    return run(FOLDER / "case.toml", lambda table: drag(table, ratio, step, steps, size))


def drag(table: Table, ratio: float, step: float, steps: int, size: float) -> None:
    """Make the case one of the block dragged by ``ratio`` of mu N."""
    pull = {"time": [step, 2.0 * step], "value": [0.0, ratio * LIMIT / LENGTH]}
    table["boundary"][0] = {"part": "bottom", "pressure": PRESSURE, "traction": {"x": pull}}
    # Without inertia nothing but friction holds the block, so that there must be contact from the start.
    table["tool"]["centre"] = [-0.5, 0.3 - 1e-6]
    table["mesh"].update(size=size, remesh=False)
    table["time"].update(step=step, end=step * steps)
    table["probe"] = [{"name": "block", "point": [0.5, 0.15]}]


LAWS: Mapping[str, Mapping[str, Any]] = {
    "sticking-sliding, constant limit": {"law": "sticking-sliding", "coefficient": 1.0, "shear_limit": 20.0},
    "sticking-sliding, m k": {"law": "sticking-sliding", "coefficient": 1.0, "shear_factor": 0.04},
    "shear": {"law": "shear", "shear_factor": 0.05},
    "usui": {"law": "usui", "coefficient": 0.4, "shear_factor": 0.1},
    "norton-hoff": {"law": "norton-hoff", "coefficient": 1.5e-5},
    # Without memory, whose distance is not small against the block's way.
    "power": {
        "law": "power",
        "coefficient": 0.3,
        "speed_exponent": -0.2,
        "temperature_exponent": -0.5,
        "memory": 0.0,
    },
    "table": {"law": "table", "coefficient": {"at": [1000.0, 5000.0], "value": [0.3, 0.2]}, "memory": 0.0},
}


def tractions() -> dict[str, float]:
    """Shear traction (MPa) of each law at the block's pressure, flow stress and speed, and at room temperature."""
    k = FLOW_STRESS / np.sqrt(3.0)
    return {
        "sticking-sliding, constant limit": 20.0,
        "sticking-sliding, m k": 0.04 * k,
        "shear": 0.05 * k,
        "usui": 0.1 * k * (1.0 - np.exp(-0.4 * PRESSURE / (0.1 * k))),
        "norton-hoff": 1.5e-5 * k * SPEED,
        "power": 0.3 * (SPEED / 1000.0) ** -0.2 * PRESSURE,
        "table": (0.3 - 0.1 * (SPEED - 1000.0) / 4000.0) * PRESSURE,
    }


def by_law(change: Callable[[Table], None], law: str) -> Callable[[Table], None]:
    """``change``, and a thin block that may yield, with one of the ``LAWS``.

    Thin, because the moment of friction tilts the pressure, on which these laws do not depend linearly.
    """

    def changed(table: Table) -> None:
        change(table)
        table["contact"]["friction"] = dict(LAWS[law])
        table["body"][0]["outline"] = [[0.0, 0.15], [1.0, 0.15], [1.0, 0.2], [0.0, 0.2]]
        hardening = {"law": "voce", "yield_stress": FLOW_STRESS, "saturation_stress": FLOW_STRESS}
        hardening |= {"linear_hardening": 0.0, "exponent": 1.0}
        table["body"][0]["material"]["hardening"] = hardening

    return changed


def sliding_by_law(law: str, size: float = 0.05) -> Run:
    """At cutting speed; all heat goes to the tool, so that the block stays cold."""

    def change(table: Table) -> None:
        table["mesh"].update(size=size, remesh=False)
        table["contact"]["heat_partition"] = 0.0
        table["time"]["end"] = 0.3 * table["time"]["end"]

    return run(FOLDER / "case.toml", by_law(change, law))


def dragged_by_law(law: str, ratio: float, size: float = 0.05) -> Run:
    """Dragged by ``ratio`` of the law's own limit."""
    share = ratio * tractions()[law] / (LIMIT / LENGTH)
    return run(FOLDER / "case.toml", by_law(lambda table: drag(table, share, 1e-3, 10, size), law))


def free(start: float, ratio: float, steps: int, end: float, size: float = 0.1) -> Run:
    """With inertia, from the speed ``start`` (mm/s), driven by ``ratio`` of the friction limit."""

    def ramp(value: float) -> dict[str, list[float]]:
        return {"time": [0.0, RAMP], "value": [0.0, LIGHT * value]}

    def change(table: Table) -> None:
        table["body"][0]["velocity"] = [start, 0.0]
        table["boundary"][0] = {"part": "bottom", "pressure": ramp(PRESSURE)}
        table["boundary"][0]["traction"] = {"x": ramp(ratio * LIMIT / LENGTH)}
        table["mesh"].update(size=size, remesh=False)
        table["time"].update(step=STOP / steps, end=end, inertia=True)

    def each_step(method: PfemMethod, row: Table) -> None:
        state = method.current
        mesh, fields = state.mesh, state.fields
        area = weights(mesh)
        row["travelled"] = float(area @ fields.displacement[:, 0] / area.sum())
        row["speed"] = float(area @ fields.last_displacement[:, 0] / area.sum() / state.clock.last_dt)

    return run(FOLDER / "case.toml", change, each_step)


def rigid_speed(time: Array, start: float, ratio: float) -> Array:
    """Speed (mm/s) of the rigid block with the ramped loads (V_ref is small against the speeds)."""
    impulse = LIGHT * LIMIT * np.where(time < RAMP, 0.5 * time**2 / RAMP, time - 0.5 * RAMP)
    if ratio > 1.0:
        return start + (ratio - 1.0) * impulse / MASS
    return coasting_speed(impulse / (LIGHT * LIMIT), start, LIGHT * LIMIT / MASS, V_REF)


def main() -> None:
    """All runs, the table and the picture."""
    rows: list[dict[str, Any]] = []

    def add(case: str, what: str, size: float, computed: float, reference: float, unit: str) -> None:
        difference = computed / reference - 1.0
        rows.append(
            {"case": case, "quantity": what, "size": size, "computed": computed, "reference": reference}
            | {"unit": unit, "difference": difference}
        )

    for size in (0.2, 0.1, 0.05):
        history = sliding(size).history
        time = history["time"]
        add("slides", "friction force", size, history["cutting_force"][-1], LIMIT, "N/mm")
        add("slides", "normal force", size, history["thrust_force"][-1], PRESSURE * LENGTH, "N/mm")
        add("slides", "friction work", size, history["friction_work"][-1], LIMIT * SPEED * time[-1], "mJ/mm")
        # Before it slides the block is sheared elastically, which takes friction work from the first steps.
        half = len(time) // 2
        late = LIMIT * SPEED * (time[-1] - time[half])
        for what, name, share in (
            ("friction work, second half", "friction_work", 1.0),
            ("heat generated in block, second half", "heat_generated", 0.5),
            ("heat content of block, second half", "heat_content", 0.5),
        ):
            add("slides", what, size, history[name][-1] - history[name][half], share * late, "mJ/mm")
    for ratio in (0.1, 0.5, 0.9, 0.99):
        history = dragged(ratio).history
        speed = np.diff(history["block_ux"][-2:])[0] / history["dt"][-1]
        add(f"sticks at {ratio:g} mu N", "creep", 0.1, speed, creep_speed(ratio, V_REF), "mm/s")
        add(
            f"sticks at {ratio:g} mu N",
            "friction force",
            0.1,
            history["cutting_force"][-1],
            ratio * LIMIT,
            "N/mm",
        )
    end = 1.3 * STOP
    time = np.linspace(0.0, end, 200001)
    path = float(np.mean(rigid_speed(time, SPEED, 0.0)) * end)
    coasts = []
    for parts in (50, 100, 200):
        result = free(SPEED, 0.0, parts, end)
        coasts.append(result)
        history = result.history
        case = f"coasts, {parts} steps"
        add(case, "stopping distance", 0.1, history["travelled"][-1], path, "mm")
        add(case, "friction work", 0.1, history["friction_work"][-1], 0.5 * MASS * SPEED**2, "mJ/mm")
    pushed = free(0.0, 1.5, 100, end).history
    reference = float(rigid_speed(np.array([end]), 0.0, 1.5)[0])
    add("driven at 1.5 mu N", "speed", 0.1, pushed["speed"][-1], reference, "mm/s")
    for law, traction in tractions().items():
        history = sliding_by_law(law).history
        add(f"slides, {law}", "friction force", 0.05, history["cutting_force"][-1], traction * LENGTH, "N/mm")
    law = "sticking-sliding, m k"
    history = dragged_by_law(law, 0.9).history
    speed = np.diff(history["block_ux"][-2:])[0] / history["dt"][-1]
    add(f"sticks at 0.9 of the limit, {law}", "creep", 0.05, speed, creep_speed(0.9, V_REF), "mm/s")
    figures = {f"{row['case']}, {row['quantity']}, {row['size']}": row["difference"] for row in rows}
    write_results(FOLDER, rows, {"differences": figures})
    picture(coasts)


def picture(coasts: list[Run]) -> None:
    """Speed while it coasts to a stop, and the force of friction."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    time = np.linspace(0.0, 1.3 * STOP, 400)
    left.plot(time * 1e6, rigid_speed(time, SPEED, 0.0), "k-", lw=0.8, label="rigid block")
    for result, name in zip(coasts, ("50 steps", "100 steps", "200 steps"), strict=True):
        history = result.history
        left.plot(history["time"] * 1e6, history["speed"], ".", ms=3, label=name)
        right.plot(history["time"] * 1e6, history["cutting_force"], ".-", lw=0.5, ms=3, label=name)
    right.axhline(LIGHT * LIMIT, color="k", lw=0.8, label="µN")
    left.set(xlabel="time (µs)", ylabel="mean speed (mm/s)")
    right.set(xlabel="time (µs)", ylabel="friction force (N/mm)")
    left.legend(fontsize=7)
    right.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
