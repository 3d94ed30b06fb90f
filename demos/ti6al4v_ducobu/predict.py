"""Predicts the orthogonal cuts of Ti6Al4V that Ducobu, Pantale and Lauwers measured; nothing is fitted.

    python demos/ti6al4v_ducobu/predict.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

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
TIP_SIZE = 0.004  # mm
RATIO = 2.0**0.5
STEP_RATIO = 2.0
SHEAR_LIMIT = 576.0
# By cutting speed (m/min), of the paper: friction coefficient and heat fraction beta, read as the tool's share.
FRICTION = {5.0: 0.24, 7.5: 0.22, 10.0: 0.21, 20.0: 0.19, 30.0: 0.18, 40.0: 0.17}
TOOL_SHARE = {5.0: 1.00, 7.5: 0.89, 10.0: 0.80, 20.0: 0.63, 30.0: 0.55, 40.0: 0.50}


def planned(micrometres: int, speed: float) -> PlannedCut:
    return PlannedCut(f"{micrometres}um_{speed:g}", micrometres / 1000.0, speed)


def travel(cut: PlannedCut) -> float:
    """8 depths, with at least 0.16 mm of window (it begins after 0.2 mm)."""
    return max(8.0 * cut.depth, 0.36)


BASE = planned(60, 30.0)
FIRST = tuple(planned(depth, speed) for depth in (60, 40, 80) for speed in (5.0, 10.0, 30.0))
REST = tuple(planned(depth, speed) for depth in (60, 40, 80) for speed in (7.5, 20.0, 40.0))
CUTS = FIRST + REST


def limited(coefficient: float, limit: str) -> str:
    return f'contact.friction={{law = "sticking-sliding", coefficient = {coefficient}, {limit}}}'


def changes(cut: PlannedCut, mesh_factor: float = 1.0, step_factor: float = 1.0) -> tuple[str, ...]:
    return (
        f'title="Ti6Al4V, {1000.0 * cut.depth:g} um, {cut.speed:g} m/min"',
        *cut_changes(cut, TIP_SIZE, mesh_factor, step_factor),
        limited(FRICTION[cut.speed], f"shear_limit = {SHEAR_LIMIT}"),
        f"contact.heat_partition={1.0 - TOOL_SHARE[cut.speed]:.6g}",
    )


def sensitivity(name: str, *different: str) -> Variant:
    return Variant(name, (*changes(BASE, mesh_factor=RATIO), *different), travel(BASE))


COARSE = sensitivity("mesh_coarse")
LONG = Variant("step_long", changes(BASE, step_factor=STEP_RATIO), travel(BASE))
SENSITIVITIES = (
    sensitivity("frictionless", "contact.friction=0.0"),
    sensitivity("coulomb", f"contact.friction={FRICTION[30.0]}"),
    sensitivity("friction_doubled", limited(2.0 * FRICTION[30.0], f"shear_limit = {SHEAR_LIMIT}")),
    sensitivity("limit_own_strength", limited(FRICTION[30.0], "shear_factor = 1.0")),
    sensitivity("adiabatic_tool", "contact.conductance=0.0", "contact.heat_partition=1.0"),
    sensitivity("partition_only", "contact.conductance=0.0"),
    sensitivity("hot_tool", "tool.temperature=600.0"),
    sensitivity("fine_tip", f"mesh.tip_size={TIP_SIZE / RATIO:.6g}"),
    sensitivity("edge_10um", "tool.tip_radius=0.01", f"mesh.tip_size={TIP_SIZE / RATIO:.6g}"),
    sensitivity("edge_30um", "tool.tip_radius=0.03"),
    sensitivity("clearance_7", "tool.clearance=7.0"),
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
        "Ti6Al4V: predicted and measured",
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
        "Ti6Al4V, 60 um, 30 m/min: what moves it",
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
        *(Variant(cut.name, changes(cut), travel(cut)) for cut in FIRST[:3]),
        COARSE,
        LONG,
        *(Variant(cut.name, changes(cut), travel(cut)) for cut in FIRST[3:]),
        *SENSITIVITIES,
        *(Variant(cut.name, changes(cut), travel(cut)) for cut in REST),
    ),
    conclude,
    travel=travel(BASE),
    case=FOLDER / "case.toml",
    partial=True,
)

if __name__ == "__main__":
    main(STUDY)
