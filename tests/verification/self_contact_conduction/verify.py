"""Heat across a slit whose walls touch: perfect contact, and a conductance, on two meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.inputs import read_toml
from pfemcut.pfem.method import PfemMethod

from ...problems import with_fields
from ..common import Array, Table, save_picture, set_keys, write_results
from ..two_body_conduction.reference import interface_temperature, jump, profile

FOLDER = Path(__file__).parent
HOT, COLD, END = 800.0, 300.0, 1e-4
CONDUCTIVITY, CAPACITY = 50.0, 0.46e9 * 7.844e-9  # per volume
EFFUSIVITY = float(np.sqrt(CONDUCTIVITY * CAPACITY))
MIDDLE = (0.5, 0.8)
"""Where it is looked at: away from the root of the slit and from its open end (mm)."""
PERFECT = 1e6
HALF_WIDTH = 0.0025
"""Of the slit (mm)."""


def conducted(size: float = 0.02, steps: int = 40, conductance: float = PERFECT) -> tuple[PfemMethod, float]:
    """The block at the end, cold below the slit and hot above at the start, with the spacing ``size`` at the slit; and
    the change of its heat over the heat: nothing is supplied or lost."""
    table = read_toml(FOLDER / "case.toml")
    set_keys(
        table,
        {
            "mesh.refine.0.size": size,
            "time.step": END / steps,
            "contact.self.conductance": conductance,
        },
    )
    problem = problem_of(*validated(table, FOLDER), FOLDER)
    method = PfemMethod.start(problem)
    temperature = np.where(method.current.mesh.points[:, 1] > 0.5, HOT, COLD)
    method = with_fields(problem, method, temperature=temperature, momentum_temperature=temperature)
    start = method.own_measures()["heat_content"]
    while not method.finished:
        method.advance()
    return method, method.own_measures()["heat_content"] / start - 1.0


def middle(method: PfemMethod) -> tuple[Array, Array]:
    """Height above the slit's middle (mm) and temperature (K) of the particles between the ends of the slit."""
    points = method.current.mesh.points
    inside = (points[:, 0] > MIDDLE[0]) & (points[:, 0] < MIDDLE[1])
    return points[inside, 1] - 0.5, method.current.fields.temperature[inside]


def walls(method: PfemMethod) -> tuple[float, float]:
    """Mean temperatures (K) of the lower and of the upper wall between the ends of the slit."""
    height, temperature = middle(method)
    near = np.abs(height) < 0.003
    lower, upper = temperature[near & (height < 0.0)], temperature[near & (height > 0.0)]
    return float(lower.mean()), float(upper.mean())


def profile_error(method: PfemMethod) -> float:
    """Largest difference from the exact temperature of perfect contact, over the jump at the start."""
    height, temperature = middle(method)
    surface = interface_temperature(HOT, COLD, EFFUSIVITY, EFFUSIVITY)
    depth, diffusivity = np.abs(height) - HALF_WIDTH, CONDUCTIVITY / CAPACITY
    hot, cold = (profile(depth, END, surface, far, diffusivity) for far in (HOT, COLD))
    exact = np.where(height > 0.0, hot, cold)
    return float(np.abs(temperature - exact).max() / (HOT - COLD))


def main() -> None:
    """All runs, the table and the picture."""
    rows: list[dict[str, Any]] = []
    drifts = []
    for size in (0.02, 0.01):
        perfect, drift = conducted(size)
        lower, upper = walls(perfect)
        rows.append(
            {"case": "perfect contact", "quantity": "jump at the slit (K)", "size": size}
            | against(upper - lower, 0.0)
        )
        rows.append(
            {
                "case": "perfect contact",
                "quantity": "largest error of the temperature over 500 K",
                "size": size,
            }
            | against(profile_error(perfect), 0.0)
        )
        drifts.append(abs(drift))
    for conductance in (50.0, 200.0):
        for size in (0.02, 0.01):
            resisting, drift = conducted(size, conductance=conductance)
            lower, upper = walls(resisting)
            wanted = float(jump(np.array([END]), HOT - COLD, conductance, EFFUSIVITY, EFFUSIVITY)[0])
            rows.append(
                {"case": f"conductance {conductance:g}", "quantity": "jump at the slit (K)", "size": size}
                | against(upper - lower, wanted)
            )
            drifts.append(abs(drift))
    figures = {
        f"{row['case']}, {row['quantity']}, {row['size']}": row["computed"]
        if row["reference"] == 0.0
        else row["difference"]
        for row in rows
    }
    write_results(
        FOLDER, rows, {"figures": figures, "largest_heat_drift": {"value": max(drifts), "unit": "1"}}
    )
    picture(perfect, resisting)


def against(computed: float, reference: float) -> Table:
    """A figure beside its reference."""
    found: Table = {"computed": computed, "reference": reference}
    return found | ({"difference": computed / reference - 1.0} if reference else {})


def picture(perfect: PfemMethod, resisting: PfemMethod) -> None:
    """Temperature across the slit."""
    figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
    for method, name in ((perfect, "perfect contact"), (resisting, "conductance 200")):
        axes.plot(*middle(method), ".", ms=3, label=name)
    surface = interface_temperature(HOT, COLD, EFFUSIVITY, EFFUSIVITY)
    depth = np.linspace(0.0, 0.3, 200)
    for far, sign in ((HOT, 1.0), (COLD, -1.0)):
        axes.plot(
            sign * (depth + HALF_WIDTH),
            profile(depth, END, surface, far, CONDUCTIVITY / CAPACITY),
            "k-",
            lw=0.8,
        )
    axes.set(xlabel="above the slit (mm)", ylabel="temperature (K)", xlim=(-0.3, 0.3))
    axes.legend()
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
