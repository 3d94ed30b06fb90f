"""How far the tolerance of the momentum residual moves the figures, and what a step costs with it.

    python demos/aisi4340_rake0/newton_tolerance.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block and coarse mesh of demos/aisi4340_demo at the paper's step. Two runs that differ by anything part
sooner or later, because one of them inserts a particle a step earlier: then the means over the steady window differ by
chance. So what must agree within 0.05 %, with the default tolerance and the tightest one, is the tool's work over the
first 100 steps.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

STEP = 1.041e-7
LIMIT = 5e-4
REFERENCE, DEFAULT = "1e-6", "1e-3"
EARLY = 100  # steps
FIGURES = ("cutting_force", "thrust_force", "chip_thickness", "contact_length", "max_temperature")


def variant(tolerance: str) -> Variant:
    return Variant(
        tolerance,
        (
            f'title="AISI 4340, momentum residual to {tolerance}"',
            f"solver.tolerance={tolerance}",
            f"time.step={STEP!r}",
            f"time.largest_step={STEP!r}",
        ),
    )


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    reference = next(outcome for outcome in outcomes if outcome.variant.name == REFERENCE)
    header = ["tolerance", *(part for figure in FIGURES for part in (figure, f"{figure}_difference"))]
    header += [
        "early_work_difference",
        "cutting_force_std",
        "energy_error",
        "heat_error",
        "newton_iterations",
        "seconds_per_step",
    ]
    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            *(
                value
                for figure in FIGURES
                for value in (outcome.mean(figure), outcome.mean(figure) / reference.mean(figure) - 1.0)
            ),
            float(outcome.history["tool_work"][EARLY] / reference.history["tool_work"][EARLY] - 1.0),
            outcome.std("cutting_force"),
            outcome.mean("energy_error"),
            outcome.mean("heat_error"),
            float(outcome.history["newton_iterations"].mean()),
            float(outcome.summary["seconds_per_step"]["total"]),
        ]
        for outcome in outcomes
    ]
    write_table(results / "newton_tolerance.csv", "Tolerance of the momentum residual", header, rows)
    content = finite_figures(header, rows)
    (early,) = (row[header.index("early_work_difference")] for row in rows if row[0] == DEFAULT)
    return content, abs(float(early)) < LIMIT and all(outcome.summary["finished"] for outcome in outcomes)


STUDY = Study(
    "newton_tolerance",
    Path(__file__).resolve().parent,
    tuple(map(variant, (REFERENCE, "1e-4", DEFAULT, "1e-2"))),
    conclude,
    travel=0.4,
)

if __name__ == "__main__":
    main(STUDY)
