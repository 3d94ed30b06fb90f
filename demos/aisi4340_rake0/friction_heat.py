"""Do the energy and heat ledgers close with friction 0.2 and its heat?

    python demos/aisi4340_rake0/friction_heat.py [-o DIR] [--resume | --overwrite] [--travel MM]

On the reduced block and coarse mesh of demos/aisi4340_demo. Half of the friction heat enters the workpiece; the heat
generated there must be chi times the plastic work plus that half, to round-off, and both ledgers must close.
"""

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.output.directory import INPUTS
from pfemcut.results.summary import LARGEST_ENERGY_ERROR, LARGEST_HEAT_ERROR
from pfemcut.validation.study import Outcome, Study, Variant, main, write_table

FRICTION = 0.2
PARTITION = 0.5
ROUND_OFF = 1e-9
ENERGIES = (
    "tool_work",
    "boundary_work",
    "plastic_work",
    "friction_work",
    "elastic_energy",
    "thermoelastic_work",
    "contact_energy",
    "remeshing_energy",
)
HEATS = ("heat_generated", "heat_supplied", "heat_content", "heat_remeshing")


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    (outcome,) = outcomes
    last = {name: float(column[-1]) for name, column in outcome.history.items()}
    inputs = tomllib.loads((outcome.directory / INPUTS).read_text(encoding="utf-8"))
    expected = inputs["workpiece"]["material"]["taylor_quinney"] * last["plastic_work"]
    expected += PARTITION * last["friction_work"]
    checks = {
        "energy_error": (abs(last["energy_error"]), LARGEST_ENERGY_ERROR),
        "heat_error": (abs(last["heat_error"]), LARGEST_HEAT_ERROR),
        "heat_source_error": (abs(last["heat_generated"] / expected - 1.0), ROUND_OFF),
    }
    rows: list[list[str | float]] = [[name, last[name]] for name in (*ENERGIES, *HEATS)]
    rows += [[name, value] for name, (value, _) in checks.items()]
    rows += [[name, outcome.mean(name)] for name in ("cutting_force", "thrust_force", "apparent_friction")]
    write_table(results / "friction_heat.csv", "Ledgers, mJ/mm", ["quantity", "value"], rows)
    draw(outcome, results / "friction_heat.png")
    content = {
        "friction": FRICTION,
        "heat_partition": PARTITION,
        "last": {name: last[name] for name in (*ENERGIES, *HEATS)},
        "share_of_friction": last["friction_work"] / last["tool_work"],
        "checks": {name: {"value": value, "limit": limit} for name, (value, limit) in checks.items()},
    }
    closed = all(value <= limit for value, limit in checks.values())
    return content, closed and bool(outcome.summary["finished"])


def draw(outcome: Outcome, path: Path) -> None:
    history = outcome.history
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 4.0), layout="constrained")
    for name in ("tool_work", "plastic_work", "friction_work", "elastic_energy", "heat_content"):
        left.plot(history["travel"], history[name], label=name.replace("_", " "))
    left.set(xlabel="travel (mm)", ylabel="mJ/mm", title="Ledgers")
    late = history["travel"] > 0.02
    for name, limit in (("energy_error", LARGEST_ENERGY_ERROR), ("heat_error", LARGEST_HEAT_ERROR)):
        (line,) = right.plot(
            history["travel"][late], 100.0 * np.abs(history[name][late]), label=name.replace("_", " ")
        )
        right.axhline(100.0 * limit, color=line.get_color(), linestyle=":")
    right.set(xlabel="travel (mm)", ylabel="size of the error (%)", title="Closure (dotted: limits)")
    right.set_ylim(0.0, 200.0 * LARGEST_ENERGY_ERROR)
    for axes in (left, right):
        axes.legend(fontsize="small")
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study(
    "friction_heat",
    Path(__file__).resolve().parent,
    (
        Variant(
            "friction_0.2",
            (
                'title="AISI 4340, friction 0.2"',
                f"contact.friction={FRICTION}",
                f"contact.heat_partition={PARTITION}",
            ),
        ),
    ),
    conclude,
    travel=0.5,
)

if __name__ == "__main__":
    main(STUDY)
