"""How the forces, the contact length and the chip of 42CD4 depend on the friction law.

    python demos/42cd4/friction_laws.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

The case of case.toml with a coarser mesh and longer steps, changed in the friction law only. No constant is fitted to a
force: the coefficients are those of the paper's Table 5, a bound, or a round number; README.md says which. The study
must close its ledgers; how far each law is from the experiment is its result.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from pfemcut.results.published import load_published
from pfemcut.results.summary import LARGEST_ENERGY_ERROR, LARGEST_HEAT_ERROR
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

FOLDER = Path(__file__).resolve().parent
COMMON = (
    "mesh.tip_size=0.008",
    "mesh.shear_zone_size=0.016",
    "mesh.chip_size=0.024",
    "mesh.surface_size=0.024",
    "mesh.growth=0.08",
    "time.step=4.4e-8",
    "time.largest_step=1.76e-7",
)
COEFFICIENT = 0.23  # Table 5
NORTON_HOFF = 6.0e-5  # Table 5, whose unit is not given: taken as s/mm, linear in the speed
ROUND = 0.5
COMPARED = ("cutting_force", "thrust_force", "contact_length", "chip_thickness")
FIGURES = (*COMPARED, "apparent_friction", "max_temperature", "tool_max_temperature")


def variant(name: str, title: str, friction: str) -> Variant:
    return Variant(name, (f'title="42CD4, {title}"', f"contact.friction={friction}", *COMMON))


def limited(coefficient: float) -> str:
    return f'{{law = "sticking-sliding", coefficient = {coefficient}, shear_factor = 1.0}}'


VARIANTS = (
    variant("frictionless", "no friction", "0.0"),
    variant("coulomb_0.23", "Coulomb 0.23", str(COEFFICIENT)),
    variant("sticking_sliding_0.23", "sticking and sliding 0.23, m = 1", limited(COEFFICIENT)),
    variant("sticking_sliding_0.5", "sticking and sliding 0.5, m = 1", limited(ROUND)),
    variant("norton_hoff", "Norton-Hoff 6e-5", f'{{law = "norton-hoff", coefficient = {NORTON_HOFF}}}'),
    variant("sticking", "sticking everywhere, m = 1", '{law = "shear", shear_factor = 1.0}'),
)


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    published = load_published(FOLDER / "published.toml")
    experiment = {name: published[name].value for name in COMPARED}
    header = ["law", *(f"{name}{part}" for name in FIGURES for part in ("", "_std"))]
    header += [f"{name}_difference" for name in COMPARED]
    header += ["energy_error", "heat_error", "particles_at_end", "steady", "travel"]
    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            *(value for name in FIGURES for value in (outcome.mean(name), outcome.std(name))),
            *(outcome.mean(name) / experiment[name] - 1.0 for name in COMPARED),
            outcome.mean("energy_error"),
            outcome.mean("heat_error"),
            float(outcome.history["nodes"][-1]),
            "yes" if outcome.summary["steady"]["value"] else "no",
            float(outcome.summary["travel"]),
        ]
        for outcome in outcomes
    ]
    write_table(results / "friction_laws.csv", "Friction laws", header, rows)
    draw(outcomes, experiment, results / "friction_laws.png")
    content = finite_figures(header, rows)
    closed = all(
        outcome.summary["finished"]
        and abs(outcome.mean("energy_error")) < LARGEST_ENERGY_ERROR
        and abs(outcome.mean("heat_error")) < LARGEST_HEAT_ERROR
        for outcome in outcomes
    )
    return {"experiment": experiment, "laws": content}, closed


def draw(outcomes: Sequence[Outcome], experiment: dict[str, float], path: Path) -> None:
    figure, axes = plt.subplots(3, 1, figsize=(8.0, 9.0), layout="constrained", sharex=True)
    labels = ("cutting force (N/mm)", "feed force (N/mm)", "contact length (mm)")
    for panel, name, label in zip(axes, COMPARED, labels, strict=False):
        for outcome in outcomes:
            panel.plot(
                outcome.history["travel"],
                outcome.history[name],
                linewidth=0.8,
                label=outcome.variant.name.replace("_", " "),
            )
        panel.axhline(experiment[name], color="black", linestyle="--", label="experiment")
        panel.set(ylabel=label, ylim=(0.0, None))
        panel.grid(alpha=0.3)
    axes[0].set_title("Friction laws")
    axes[0].legend(fontsize="small")
    axes[-1].set_xlabel("travel (mm)")
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study("friction_laws", FOLDER, VARIANTS, conclude, travel=0.5, case=FOLDER / "case.toml")

if __name__ == "__main__":
    main(STUDY)
