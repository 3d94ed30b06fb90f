"""How the cut of the Voce steel depends on the softening coefficient w0 of its flow stress.

    python demos/voce_rake0/softening.py [-o DIR] [--resume | --overwrite] [--travel MM] [--only NAME]

On the reduced block and coarse mesh of demos/aisi4340_demo. The travel is 1.2 mm: a chip as thick as the paper's must
be that long before its thickness can be measured.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from pfemcut.results.published import load_published
from pfemcut.validation.study import Outcome, Study, Variant, main, write_table
from pfemcut.whole_files import finite

FOLDER = Path(__file__).resolve().parent
PRINTED = 0.001
COEFFICIENTS = (0.0, 0.00025, 0.0005, PRINTED)
FIGURES = {
    "cutting_force": "N/mm",
    "thrust_force": "N/mm",
    "chip_thickness": "mm",
    "contact_length": "mm",
    "shear_angle": "degree",
    "shear_angle_band": "degree",
    "max_temperature": "K",
}


def variant(coefficient: float) -> Variant:
    # Eq. 10 of the paper has one coefficient for initial yield stress and hardening.
    softening = f"flow_stress_softening = {coefficient!r}, hardening_softening = {coefficient!r}"
    material = f'{{base = "voce_steel", hardening = {{{softening}}}}}'
    return Variant(
        f"w0_{coefficient:g}",
        (f'title="Voce steel, w0 = {coefficient:g} 1/K"', f"workpiece.material={material}"),
    )


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    published = load_published(FOLDER / "published.toml")
    header = ["w0", *(f"{name}{part}" for name in FIGURES for part in ("", "_std")), "steady", "travel"]
    rows: list[list[str | float]] = [
        [
            coefficient,
            *(value for name in FIGURES for value in (outcome.mean(name), outcome.std(name))),
            "yes" if outcome.summary["steady"]["value"] else "no",
            float(outcome.summary["travel"]),
        ]
        for coefficient, outcome in zip(COEFFICIENTS, outcomes, strict=True)
    ]
    write_table(results / "softening.csv", "Softening of the flow stress", header, rows)
    draw(outcomes, results / "softening.png")
    content = {
        "w0": {
            f"{coefficient:g}": {name: finite(outcome.mean(name)) for name in FIGURES}
            for coefficient, outcome in zip(COEFFICIENTS, outcomes, strict=True)
        },
        "printed": PRINTED,
        "published": {name: figure.value for name, figure in published.items()},
    }
    return content, all(outcome.summary["finished"] for outcome in outcomes)


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    published = load_published(FOLDER / "published.toml")
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 6.5), layout="constrained")
    groups = (("cutting_force", "thrust_force"), ("chip_thickness", "contact_length"))
    for at, names in zip(axes.flat[:3], (*groups, ("shear_angle", "shear_angle_band")), strict=True):
        for name, colour in zip(names, ("tab:blue", "tab:red"), strict=True):
            at.errorbar(
                COEFFICIENTS,
                [outcome.mean(name) for outcome in outcomes],
                yerr=[outcome.std(name) for outcome in outcomes],
                color=colour,
                marker="o",
                capsize=3,
                label=name.replace("_", " "),
            )
            if name in published:
                at.axhline(published[name].value, color=colour, linestyle=":", linewidth=1.0)
        at.set(xlabel="w0 (1/K)", ylabel=FIGURES[names[0]])
        at.legend(fontsize="small")
        at.grid(alpha=0.3)
    for coefficient, outcome in zip(COEFFICIENTS, outcomes, strict=True):
        axes[1, 1].plot(
            outcome.history["travel"],
            outcome.history["cutting_force"],
            linewidth=0.8,
            label=f"w0 = {coefficient:g}",
        )
    axes[1, 1].set(xlabel="travel (mm)", ylabel="cutting force (N/mm)", ylim=(0.0, None))
    axes[1, 1].legend(fontsize="small")
    axes[1, 1].grid(alpha=0.3)
    figure.suptitle("Voce steel: softening coefficient (dotted: the paper; 0.001 is printed)")
    figure.savefig(path, dpi=90)
    plt.close(figure)


STUDY = Study("softening", FOLDER, tuple(variant(value) for value in COEFFICIENTS), conclude, travel=1.2)

if __name__ == "__main__":
    main(STUDY)
