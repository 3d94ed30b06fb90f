"""How small must the speed be that regularises friction: the paper's 1 mm/s against 1 and 10 % of the cutting speed.

    python demos/aisi4340_friction/reference_speed.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

The case of case.toml with steps of up to four times its own. Figures are means over the second half of the travel. At
1 % the forces must be within 1 % of those at the paper's speed.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.validation.study import Outcome, Study, Variant, main, write_table

FOLDER = Path(__file__).resolve().parent
LIMIT = 0.01
FIGURES = ("cutting_force", "thrust_force", "contact_length", "max_temperature", "tool_max_temperature")


def variant(name: str, speed: float) -> Variant:
    return Variant(name, (f"contact.reference_speed={speed}", "time.largest_step=4.1708e-7"))


def mean(outcome: Outcome, name: str) -> float:
    """Of a history column over the second half of the travel."""
    history = outcome.history
    late = history["travel"] > 0.5 * history["travel"][-1]
    return float(np.average(history[name][late], weights=history["dt"][late]))


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    paper, chosen, *_ = outcomes
    header = ["run", *(f"{name}{part}" for name in FIGURES for part in ("", "_difference"))]
    header += [
        "steps",
        "step_cuts",
        "linear_solves",
        "largest_newton_iterations",
        "energy_error",
        "heat_error",
    ]
    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            *(
                value
                for name in FIGURES
                for value in (mean(outcome, name), mean(outcome, name) / mean(paper, name) - 1.0)
            ),
            float(len(outcome.history["step"])),
            float(outcome.history["step_cuts"][-1]),
            float(outcome.history["newton_iterations"].sum()),
            float(outcome.history["newton_iterations"].max()),
            outcome.mean("energy_error"),
            outcome.mean("heat_error"),
        ]
        for outcome in outcomes
    ]
    write_table(results / "reference_speed.csv", "Regularisation of friction", header, rows)
    moved = {name: mean(chosen, name) / mean(paper, name) - 1.0 for name in ("cutting_force", "thrust_force")}
    return {"moved": moved, "limit": LIMIT}, all(abs(each) < LIMIT for each in moved.values())


STUDY = Study(
    "reference_speed",
    FOLDER,
    (variant("1_mm_s", 1.0), variant("1_percent", 33.3), variant("10_percent", 333.0)),
    conclude,
    travel=0.1,
    case=FOLDER / "case.toml",
)

if __name__ == "__main__":
    main(STUDY)
