"""Predicts the orthogonal cuts of AISI 1045 that Klocke, Lung and Buchkremer measured; nothing is fitted.

    python demos/aisi1045_klocke/predict.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

One cut is repeated with a coarser mesh and with longer steps, from which the uncertainty of all follows. With that
coarser mesh it shows what each choice moves. It concludes from the runs that are there; README.md says what is assumed.
"""

from pathlib import Path

from pfemcut.validation.prediction import PlannedCut, cut_changes, planned
from pfemcut.validation.prediction_study import MESH_RATIO, CutAgain, PredictedSet
from pfemcut.validation.study import main

FOLDER = Path(__file__).resolve().parent
TIP_SIZE = 0.0075  # mm
# The paper's, by sliding speed (mm/s).
SPEEDS = [333.3, 666.7, 1000.0, 1333.3, 1666.7]
COEFFICIENTS = [0.421, 0.367, 0.316, 0.270, 0.244]


BASE = planned(200, 100.0)
CUTS = (BASE, planned(100, 100.0), planned(300, 100.0), planned(100, 50.0))


def travel(cut: PlannedCut) -> float:
    """10 depths, with at least 2 mm: shorter chips never were as long as their thickness is defined over."""
    return max(10.0 * cut.depth, 2.0)


def changes(cut: PlannedCut, mesh_factor: float = 1.0, step_factor: float = 1.0) -> tuple[str, ...]:
    return (
        f'title="AISI 1045, {cut.depth:g} mm, {cut.speed:g} m/min"',
        *cut_changes(cut, TIP_SIZE, mesh_factor, step_factor),
        *((f"workpiece.length={2.0 * travel(cut):.6g}",) if travel(cut) > 10.0 * cut.depth else ()),
    )


def material(different: str) -> str:
    """The workpiece's material with another constant of its hardening."""
    return f'workpiece.material={{base = "aisi1045_klocke", hardening = {{{different}}}}}'


def friction(other: str) -> str:
    """The paper's friction with another key of the law."""
    return f'contact.friction={{law = "table", {other}, coefficient = {{at = {SPEEDS}, value = {COEFFICIENTS}}}}}'


FINE_TIP = f"mesh.tip_size={TIP_SIZE / MESH_RATIO:.6g}"
CHOICES = {
    "frictionless": ("contact.friction=0.0",),
    "limit_own_strength": (friction("shear_factor = 1.0"),),
    "memory_20um": (friction("memory = 0.02"),),
    "coefficient_slowest": (f"contact.friction={COEFFICIENTS[0]}",),
    "coefficient_fastest": (f"contact.friction={COEFFICIENTS[-1]}",),
    "adiabatic_tool": ("contact.conductance=0.0", "contact.heat_partition=1.0"),
    "hot_tool": ("tool.temperature=600.0",),
    "fine_tip": (FINE_TIP,),
    "edge_15um": ("tool.tip_radius=0.015", FINE_TIP),
    "edge_60um": ("tool.tip_radius=0.06",),
    "reference_rate_low": (material("reference_rate = 0.001"),),
    "melts_at_1793": (material("melting_temperature = 1793.0"),),
}
PREDICTED = PredictedSet(
    folder=FOLDER,
    material="AISI 1045",
    cuts=CUTS,
    base=BASE,
    changes=changes,
    travels={cut.name: travel(cut) for cut in CUTS},
    choices=CHOICES,
    again=(CutAgain("no_memory", BASE, (friction("memory = 0.0"),), travel(BASE)),),
)
STUDY = PREDICTED.study()

if __name__ == "__main__":
    main(STUDY)
