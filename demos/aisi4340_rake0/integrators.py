"""IMPL-EX against the implicit integrator at the paper's time step, and IMPL-EX at longer steps.

    python demos/aisi4340_rake0/integrators.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block and coarse mesh of demos/aisi4340_demo. At the paper's step the two cutting forces must agree
within 3 %.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from pfemcut.validation.study import Outcome, Study, Variant, main, write_table
from pfemcut.whole_files import finite

STEP = 1.041e-7
LIMIT = 0.03
FIGURES = ("cutting_force", "thrust_force", "chip_thickness", "max_temperature")
REFERENCE = "implicit_1x"


def variant(integrator: str, factor: int) -> Variant:
    name = f"{integrator.replace('-', '')}_{factor}x"
    return Variant(
        name,
        (
            f'title="AISI 4340, {integrator}, {factor} x the paper\'s step"',
            f'time.integrator="{integrator}"',
            f"time.step={factor * STEP!r}",
            f"time.largest_step={factor * STEP!r}",
        ),
    )


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    by_name = {outcome.variant.name: outcome for outcome in outcomes}
    reference = by_name[REFERENCE]
    differences = {
        name: {figure: outcome.mean(figure) / reference.mean(figure) - 1.0 for figure in FIGURES}
        for name, outcome in by_name.items()
    }
    header = ["run", *(f"{figure}{part}" for figure in FIGURES for part in ("", "_std", "_difference"))]
    header += ["newton_iterations", "seconds_per_step", "energy_error"]
    rows: list[list[str | float]] = [
        [
            name,
            *(
                value
                for figure in FIGURES
                for value in (outcome.mean(figure), outcome.std(figure), differences[name][figure])
            ),
            float(outcome.history["newton_iterations"].mean()),
            float(outcome.summary["seconds_per_step"]["total"]),
            outcome.mean("energy_error"),
        ]
        for name, outcome in by_name.items()
    ]
    write_table(results / "integrators.csv", "Integrators", header, rows)
    draw(outcomes, results / "integrators.png")
    bias = differences["implex_1x"]["cutting_force"]
    content = {
        "reference": REFERENCE,
        "step": STEP,
        "differences": {
            name: {figure: finite(value) for figure, value in each.items()}
            for name, each in differences.items()
        },
        "means": {
            name: {figure: finite(outcome.mean(figure)) for figure in FIGURES}
            for name, outcome in by_name.items()
        },
        "stds": {
            name: {figure: finite(outcome.std(figure)) for figure in FIGURES}
            for name, outcome in by_name.items()
        },
        "cutting_force_difference": finite(bias),
        "limit": LIMIT,
    }
    return content, abs(bias) < LIMIT and all(outcome.summary["finished"] for outcome in outcomes)


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(8.0, 4.5), layout="constrained")
    for number, outcome in enumerate(outcomes):
        travel = outcome.history["travel"]
        for name, style in (("cutting_force", "-"), ("thrust_force", "--")):
            axes.plot(
                travel,
                outcome.history[name],
                style,
                color=f"C{number}",
                linewidth=0.8,
                label=outcome.variant.name.replace("_", " ") if style == "-" else None,
            )
    axes.set(
        xlabel="travel (mm)",
        ylabel="force on the tool (N/mm)",
        ylim=(0.0, None),
        title="Cutting (solid) and thrust force (dashed) by integrator and step",
    )
    axes.legend(fontsize="small")
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study(
    "integrators",
    Path(__file__).resolve().parent,
    (variant("implicit", 1), variant("impl-ex", 1), variant("impl-ex", 2), variant("impl-ex", 4)),
    conclude,
    travel=0.5,
)

if __name__ == "__main__":
    main(STUDY)
