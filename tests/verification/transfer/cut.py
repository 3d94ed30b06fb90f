"""A short coarse cut of AISI 4340 with each transfer rule: forces, dissipation, ledgers and cost.

    python -m tests.verification.transfer.cut

takes four minutes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import ElementTransfer
from tests.problems import cut_problem

from ..common import write_table

TRAVEL, SPEED = 0.4, 3330.0


def row(rule: ElementTransfer) -> dict[str, float | str]:
    """Means over the travel beyond 0.25 mm, and ledgers at the end."""
    problem = cut_problem(mesh={"transfer": rule.value}, cutting={"travel": TRAVEL, "speed": SPEED})
    method = PfemMethod.start(problem)
    steps = []
    while not method.finished:
        method.advance()
        own = method.own_measures()
        core = vars(method.measure())
        steps.append({**core, **own, "transfer_ms": 1e3 * method.timing()["transfer"]})
    columns = {name: np.array([step[name] for step in steps]) for name in steps[0]}
    window = columns["travel"] > 0.25
    force, thrust = columns["cutting_force"][window], columns["thrust_force"][window]
    return {
        "rule": rule.value,
        "cutting_force": float(force.mean()),
        "cutting_force_std": float(force.std()),
        "cutting_force_jump": float(np.abs(np.diff(force)).mean()),
        "thrust_force": float(thrust.mean()),
        "thrust_force_std": float(thrust.std()),
        "plastic_power_over_work": float((columns["plastic_power"][window] / (force * SPEED)).mean()),
        "newton_iterations": float(columns["newton_iterations"].mean()),
        "max_eqps": float(columns["max_eqps"][window].mean()),
        "max_eqps_std": float(columns["max_eqps"][window].std()),
        "energy_error": float(columns["energy_error"][-1]),
        "heat_error": float(columns["heat_error"][-1]),
        "heat_remeshing_over_content": float(columns["heat_remeshing"][-1] / columns["heat_content"][-1]),
        "remeshing_over_work": float(columns["remeshing_energy"][-1] / columns["tool_work"][-1]),
        "changed_elements": float(columns["changed_elements"].mean()),
        "elements": float(columns["elements"][-1]),
        "transfer_ms": float(np.median(columns["transfer_ms"])),
        "steps": len(steps),
    }


if __name__ == "__main__":
    write_table(Path(__file__).parent / "results" / "cut.csv", [row(rule) for rule in ElementTransfer])
