"""Where an element's volume ratio comes from at the start of a step: the rules side by side.

    python demos/aisi4340_rake0/volumetric_history.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block and coarse mesh of demos/aisi4340_demo. The table sets force scatter, plastic power over tool
power in the steady window, and Newton iterations beside each other; the default rule must keep its force scatter
below 3 % of the mean.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

RULES = ("increment", "pressure", "element", "mixed")
DEFAULT = "increment"
LIMIT = 0.03


def plastic_share(outcome: Outcome) -> float:
    """Plastic work over tool work in the steady window."""
    travel = outcome.history["travel"]
    begin, end = outcome.summary["window"]
    inside = (travel >= begin) & (travel <= end)
    plastic, tool = (outcome.history[name][inside] for name in ("plastic_work", "tool_work"))
    return float((plastic[-1] - plastic[0]) / (tool[-1] - tool[0]))


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    header = ["rule", "cutting_force", "cutting_force_std", "thrust_force", "thrust_force_std"]
    header += ["plastic_over_tool_power", "newton_iterations", "energy_error", "max_temperature", "travel"]
    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            outcome.mean("cutting_force"),
            outcome.std("cutting_force"),
            outcome.mean("thrust_force"),
            outcome.std("thrust_force"),
            plastic_share(outcome),
            float(outcome.history["newton_iterations"].mean()),
            outcome.mean("energy_error"),
            outcome.mean("max_temperature"),
            float(outcome.summary["travel"]),
        ]
        for outcome in outcomes
    ]
    write_table(results / "volumetric_history.csv", "Volumetric history", header, rows)
    content = finite_figures(header, rows)
    default = next(outcome for outcome in outcomes if outcome.variant.name == DEFAULT)
    scatter = default.std("cutting_force") / default.mean("cutting_force")
    return content, scatter < LIMIT


STUDY = Study(
    "volumetric_history",
    Path(__file__).resolve().parent,
    tuple(Variant(rule, (f'mesh.volumetric_history="{rule}"',)) for rule in RULES),
    conclude,
    travel=0.4,
)

if __name__ == "__main__":
    main(STUDY)
