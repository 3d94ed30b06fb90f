"""Removal of particles by error estimators: node count, forces, temperature and chip with and without it.

    python demos/aisi4340_rake0/coarsening.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block and coarse mesh of demos/aisi4340_demo. At the default tolerance, the estimator on plastic strain
must not move the steady forces and the maximum temperature by more than 1 %, the heat ledger must close to 1 %, and the
particles gained per mm over the last half of the cut must be less than a tenth of those without it.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

LIMIT = 0.01
GROWTH = 0.1
HELD = ("cutting_force", "thrust_force", "max_temperature")
FIGURES = (*HELD, "contact_end_temperature", "contact_length", "chip_thickness", "chip_curvature")


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    reference, coarsened, *_ = outcomes
    header = ["estimator", *(f"{name}{part}" for name in FIGURES for part in ("", "_std", "_difference"))]
    header += ["particles_at_end", "particles_a_mm", "inserted_a_step", "removed_a_step"]
    header += ["energy_error", "heat_error", "seconds_per_step", "travel"]
    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            *(
                value
                for name in FIGURES
                for value in (outcome.mean(name), outcome.std(name), moved(outcome, reference, name))
            ),
            float(outcome.history["nodes"][-1]),
            late_growth(outcome),
            late_mean(outcome, "inserted"),
            late_mean(outcome, "removed"),
            outcome.mean("energy_error"),
            outcome.mean("heat_error"),
            float(outcome.summary["seconds_per_step"]["total"]),
            float(outcome.summary["travel"]),
        ]
        for outcome in outcomes
    ]
    write_table(results / "coarsening.csv", "Coarsening by error estimators", header, rows)
    draw(outcomes, results / "coarsening.png")
    content = finite_figures(header, rows)
    checks = {
        **{name: abs(moved(coarsened, reference, name)) < LIMIT for name in HELD},
        "heat_error": abs(coarsened.mean("heat_error")) < LIMIT,
        "particles_a_mm": late_growth(coarsened) < GROWTH * late_growth(reference),
    }
    limits = {
        "limit": LIMIT,
        "growth_limit": GROWTH,
        "growth": late_growth(coarsened) / late_growth(reference),
    }
    return {**content, **limits, "checks": checks}, all(checks.values())


def moved(outcome: Outcome, reference: Outcome, name: str) -> float:
    """Relative difference of a figure."""
    return outcome.mean(name) / reference.mean(name) - 1.0


def late_growth(outcome: Outcome) -> float:
    """Particles gained per mm of travel over the last half of the cut."""
    travel, nodes = outcome.history["travel"], outcome.history["nodes"]
    late = travel > 0.5 * travel[-1]
    return float((nodes[late][-1] - nodes[late][0]) / (travel[late][-1] - travel[late][0]))


def late_mean(outcome: Outcome, column: str) -> float:
    """Mean of a history column over the last half of the cut."""
    travel = outcome.history["travel"]
    return float(outcome.history[column][travel > 0.5 * travel[-1]].mean())


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    figure, (above, below) = plt.subplots(2, 1, figsize=(8.0, 6.0), layout="constrained", sharex=True)
    for outcome in outcomes:
        travel = outcome.history["travel"]
        above.plot(travel, outcome.history["nodes"], label=outcome.variant.name)
        below.plot(travel, outcome.history["cutting_force"], linewidth=0.7)
    above.set(ylabel="particles", title="Coarsening by error estimators", ylim=(0.0, None))
    above.legend(fontsize="small")
    below.set(xlabel="travel (mm)", ylabel="cutting force (N/mm)", ylim=(0.0, None))
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study(
    "coarsening",
    Path(__file__).resolve().parent,
    (
        Variant("none"),
        Variant("plastic-strain", ('mesh.coarsening="plastic-strain"',)),
        Variant("plastic-strain_0.1", ('mesh.coarsening="plastic-strain"', "mesh.coarsening_tolerance=0.1")),
    ),
    conclude,
    travel=0.9,
)

if __name__ == "__main__":
    main(STUDY)
