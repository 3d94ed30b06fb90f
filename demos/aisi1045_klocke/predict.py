"""Predicts the orthogonal cuts of AISI 1045 that Klocke, Lung and Buchkremer measured; nothing is fitted.

    python demos/aisi1045_klocke/predict.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

One cut is repeated with a coarser mesh and with longer steps, from which the uncertainty of all follows. With that
coarser mesh it shows what each choice moves. It concludes from the runs that are there; README.md says what is assumed.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.validation.prediction import (
    PlannedCut,
    cut_changes,
    load_measurements,
    numerical_parts,
    predicted,
)
from pfemcut.validation.prediction_tables import write_predictions, write_sensitivities
from pfemcut.validation.study import Outcome, Study, Variant, finite, main

FOLDER = Path(__file__).resolve().parent
TIP_SIZE = 0.0075  # mm
RATIO = 2.0**0.5
STEP_RATIO = 2.0
# The paper's, by sliding speed (mm/s).
SPEEDS = [333.3, 666.7, 1000.0, 1333.3, 1666.7]
COEFFICIENTS = [0.421, 0.367, 0.316, 0.270, 0.244]
TRAVEL = 10.0  # depths of cut
# Of the tool in the nominal step, in tip sizes: see README.md.
ADVANCE = 0.2


def planned(micrometres: int, speed: float) -> PlannedCut:
    return PlannedCut(f"{micrometres}um_{speed:g}", micrometres / 1000.0, speed)


BASE = planned(200, 100.0)
CUTS = (BASE, planned(100, 100.0), planned(300, 100.0), planned(100, 50.0))


def changes(cut: PlannedCut, mesh_factor: float = 1.0, step_factor: float = 1.0) -> tuple[str, ...]:
    return (
        f'title="AISI 1045, {cut.depth:g} mm, {cut.speed:g} m/min"',
        *cut_changes(cut, TIP_SIZE, mesh_factor, step_factor, ADVANCE),
    )


def sensitivity(name: str, *different: str) -> Variant:
    return Variant(name, (*changes(BASE, mesh_factor=RATIO), *different), TRAVEL * BASE.depth)


COARSE = sensitivity("mesh_coarse")
LONG = Variant("step_long", changes(BASE, step_factor=STEP_RATIO), TRAVEL * BASE.depth)
LIMITED = f'{{law = "table", shear_factor = 1.0, coefficient = {{at = {SPEEDS}, value = {COEFFICIENTS}}}}}'
SENSITIVITIES = (
    sensitivity("frictionless", "contact.friction=0.0"),
    sensitivity("limit_own_strength", f"contact.friction={LIMITED}"),
    sensitivity("coefficient_slowest", f"contact.friction={COEFFICIENTS[0]}"),
    sensitivity("coefficient_fastest", f"contact.friction={COEFFICIENTS[-1]}"),
    sensitivity("adiabatic_tool", "contact.conductance=0.0", "contact.heat_partition=1.0"),
    sensitivity("hot_tool", "tool.temperature=600.0"),
    sensitivity("fine_tip", f"mesh.tip_size={TIP_SIZE / RATIO:.6g}"),
    sensitivity("edge_15um", "tool.tip_radius=0.015", f"mesh.tip_size={TIP_SIZE / RATIO:.6g}"),
    sensitivity("edge_60um", "tool.tip_radius=0.06"),
)


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    runs = {outcome.variant.name: outcome for outcome in outcomes}
    figures = {name: predicted(outcome, BASE.depth) for name, outcome in runs.items()}
    parts = {
        name: numerical_parts(figures.get(BASE.name), figures.get(other.name), ratio)
        for name, other, ratio in (("mesh", COARSE, RATIO), ("step", LONG, STEP_RATIO))
    }
    content = write_predictions(
        results / "predict.csv",
        "AISI 1045: predicted and measured",
        CUTS,
        runs,
        tuple(parts.values()),
        load_measurements(FOLDER / "measured.toml"),
    )
    content["relative_uncertainty"] = {
        name: {figure: finite(value) for figure, value in part.items()} for name, part in parts.items()
    }
    content |= write_sensitivities(
        results / "sensitivities.csv",
        "AISI 1045, 0.2 mm, 100 m/min: what moves it",
        COARSE.name,
        [BASE.name, LONG.name, *(variant.name for variant in SENSITIVITIES)],
        runs,
        BASE,
    )
    return content, not content["not_run"]


STUDY = Study(
    "predict",
    FOLDER,
    (
        *(Variant(cut.name, changes(cut), TRAVEL * cut.depth) for cut in CUTS),
        COARSE,
        LONG,
        *SENSITIVITIES,
    ),
    conclude,
    travel=TRAVEL * BASE.depth,
    case=FOLDER / "case.toml",
    partial=True,
)

if __name__ == "__main__":
    main(STUDY)
