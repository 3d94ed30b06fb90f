"""Perfect contact, contact resistance and frictional heat, on two meshes and with the heat shared out in two ways."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.pfem.method import PfemMethod

from ..common import Array, Run, Table, run, save_picture, write_results
from .reference import friction_rise, heat, interface_temperature, jump, profile

FOLDER = Path(__file__).parent

HOT, COLD, END = 800.0, 300.0, 1e-4
BLOCK, TOOL = (50.0, 0.46e9 * 7.844e-9), (100.0, 0.202e9 * 14.85e-9)  # conductivity, capacity per volume
B_BLOCK, B_TOOL = (float(np.sqrt(k * c)) for k, c in (BLOCK, TOOL))
FRICTION, SPEED = 0.3, 2000.0
# Away from the ends of the contact, where heat spreads sideways.
MIDDLE = (0.85, 1.1)


def conducted(
    size: float = 0.02,
    steps: int = 40,
    conductance: float = 1e6,
    partition: float = 0.5,
    slides: bool = False,
) -> Run:
    """Block and tool with the spacing ``size`` (mm) at their interface; sliding, both begin cold."""

    def change(table: Table) -> None:
        table["mesh"]["refine"][0]["size"] = table["tool"]["conduction"]["tip_size"] = size
        table["contact"].update(conductance=conductance, heat_partition=partition)
        table["time"]["step"] = END / steps
        if slides:
            table["body"][0]["temperature"] = COLD
            table["contact"]["friction"] = FRICTION
            table["boundary"][0]["displacement"]["y"] = {"time": [0.0, END], "value": [0.0, SPEED * END]}

    def each_step(method: PfemMethod, row: Table) -> None:
        row["block"], row["tool"] = surfaces(method)
        row["power"] = friction_power(method)

    return run(FOLDER / "case.toml", change, each_step)


def surfaces(method: PfemMethod) -> tuple[float, float]:
    """Mean temperature (K) of both surfaces in the middle of the contact."""
    frame = method.frame()
    shift = frame.points[:, 1].min() - 0.5
    means = []
    for points, temperature in (
        (frame.points, frame.point_fields["temperature"]),
        (frame.tool_blocks[0].points, frame.tool_blocks[0].point_fields["temperature"]),
    ):
        y = points[:, 1] - shift
        middle = (np.abs(points[:, 0]) < 1e-3) & (y > MIDDLE[0]) & (y < MIDDLE[1])
        means.append(float(np.mean(temperature[middle])))
    return means[0], means[1]


def friction_power(method: PfemMethod) -> float:
    """Power of friction in the middle of the contact (mW/mm²)."""
    frame = method.frame()
    y = frame.points[frame.contact.particles, 1] - (frame.points[:, 1].min() - 0.5)
    middle = (y > MIDDLE[0]) & (y < MIDDLE[1])
    return SPEED * float(np.mean(frame.contact.shear[middle]))


def main() -> None:
    """All runs, the table and the picture."""
    rows: list[dict[str, Any]] = []

    def add(
        case: str, what: str, size: float, steps: int, computed: float, reference: float, unit: str
    ) -> None:
        rows.append(
            {"case": case, "quantity": what, "size": size, "steps": steps, "computed": computed}
            | {"reference": reference, "unit": unit, "difference": computed / reference - 1.0}
        )

    end = np.array([END])
    perfect = interface_temperature(HOT, COLD, B_BLOCK, B_TOOL)
    for size, steps in ((0.02, 40), (0.01, 40)):
        result = conducted(size, steps)
        for name in ("block", "tool"):
            rise = float(result.history[name][-1]) - COLD
            add("perfect contact", f"{name} surface above the cold", size, steps, rise, perfect - COLD, "K")
    finest = result
    resistance = 50.0
    wanted = float(heat(end, HOT - COLD, resistance, B_BLOCK, B_TOOL)[0])
    for size, steps in ((0.02, 40), (0.01, 40)):
        result = conducted(size, steps, resistance)
        gap = float(result.history["block"][-1] - result.history["tool"][-1])
        reference = float(jump(end, HOT - COLD, resistance, B_BLOCK, B_TOOL)[0])
        add("conductance 50", "jump at the interface", size, steps, gap, reference, "K")
        add(
            "conductance 50",
            "heat through it",
            size,
            steps,
            float(result.history["heat_to_tool"][-1]),
            wanted,
            "mJ/mm",
        )
    ledgers = [
        abs(float(run_.history[name][-1]))
        for run_ in (finest, result)
        for name in ("heat_error", "tool_heat_error")
    ]
    shares = []
    for partition in (0.0, 1.0):
        result = conducted(0.01, 80, partition=partition, slides=True)
        shares.append(float(result.history["block"][-1]))
        # The normal traction is set by a displacement, so the power is the measured one; it is constant.
        power = float(result.history["power"].mean())
        rise = float(friction_rise(end, power, B_BLOCK, B_TOOL)[0])
        add(
            f"friction, partition {partition:g}",
            "rise of the block's surface",
            0.01,
            80,
            shares[-1] - COLD,
            rise,
            "K",
        )
        ledgers += [abs(float(result.history[name][-1])) for name in ("heat_error", "tool_heat_error")]
    figures: dict[str, Any] = {
        f"{row['case']}, {row['quantity']}, {row['size']}, {row['steps']}": row["difference"] for row in rows
    }
    write_results(
        FOLDER,
        rows,
        {
            "differences": figures,
            "largest_ledger_error": {"value": max(ledgers), "unit": "1"},
            "spread_over_partitions": {"value": max(shares) - min(shares), "unit": "K"},
        },
    )
    picture(finest, perfect)


def picture(result: Run, surface: float) -> None:
    """Temperature through block and tool in the middle of the contact."""
    figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
    frame = result.method.frame()
    for points, values, (k, c), far, sign in (
        (frame.points, frame.point_fields["temperature"], BLOCK, HOT, -1.0),
        (frame.tool_blocks[0].points, frame.tool_blocks[0].point_fields["temperature"], TOOL, COLD, 1.0),
    ):
        middle = (points[:, 1] > MIDDLE[0]) & (points[:, 1] < MIDDLE[1]) & (np.abs(points[:, 0]) < 0.3)
        axes.plot(points[middle, 0], np.asarray(values)[middle], ".", ms=3)
        depth: Array = np.linspace(0.0, 0.3, 200)
        axes.plot(sign * depth, profile(depth, END, surface, far, k / c), "k-", lw=0.8)
    axes.set(xlabel="x (mm): block left, tool right of the interface", ylabel="temperature (K)")
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
