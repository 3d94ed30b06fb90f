"""Predicts the orthogonal cuts of Ti6Al4V that Ducobu, Pantale and Lauwers measured; nothing is fitted.

    python demos/ti6al4v_ducobu/predict.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

One cut is repeated with a coarser mesh and with longer steps, from which the uncertainty of all follows. With that
coarser mesh it shows what each choice moves. It concludes from the runs that are there; README.md says what is assumed.
"""

from pathlib import Path

from pfemcut.validation.prediction import PlannedCut, cut_changes, planned
from pfemcut.validation.prediction_study import MESH_RATIO, CutAgain, PredictedSet
from pfemcut.validation.study import main

FOLDER = Path(__file__).resolve().parent
TIP_SIZE = 0.004  # mm
LIMIT = "shear_limit = 576.0"
# By cutting speed (m/min), of the paper: friction coefficient and heat fraction beta, read as the tool's share.
FRICTION = {5.0: 0.24, 7.5: 0.22, 10.0: 0.21, 20.0: 0.19, 30.0: 0.18, 40.0: 0.17}
TOOL_SHARE = {5.0: 1.00, 7.5: 0.89, 10.0: 0.80, 20.0: 0.63, 30.0: 0.55, 40.0: 0.50}


def slow(cut: PlannedCut) -> bool:
    """Whether the chip thickens for long before it is steady."""
    return cut.speed < 30.0


def travel(cut: PlannedCut) -> float:
    """20 depths if slow, else 8 with at least 0.16 mm of window (it begins after 0.2 mm)."""
    return 20.0 * cut.depth if slow(cut) else max(8.0 * cut.depth, 0.36)


BASE, SLOW = planned(60, 30.0), planned(60, 5.0)
CUTS = tuple(planned(depth, speed) for depth in (40, 60, 80) for speed in FRICTION)


def limited(coefficient: float, limit: str) -> str:
    return f'contact.friction={{law = "sticking-sliding", coefficient = {coefficient}, {limit}}}'


def changes(cut: PlannedCut, mesh_factor: float = 1.0, step_factor: float = 1.0) -> tuple[str, ...]:
    return (
        f'title="Ti6Al4V, {1000.0 * cut.depth:g} um, {cut.speed:g} m/min"',
        *cut_changes(cut, TIP_SIZE, mesh_factor, step_factor),
        *((f"workpiece.length={40.0 * cut.depth:.6g}",) if slow(cut) else ()),
        limited(FRICTION[cut.speed], LIMIT),
        f"contact.heat_partition={1.0 - TOOL_SHARE[cut.speed]:.6g}",
    )


FINE_TIP = f"mesh.tip_size={TIP_SIZE / MESH_RATIO:.6g}"
CHOICES = {
    "frictionless": ("contact.friction=0.0",),
    "coulomb": (f"contact.friction={FRICTION[30.0]}",),
    "friction_doubled": (limited(2.0 * FRICTION[30.0], LIMIT),),
    "limit_own_strength": (limited(FRICTION[30.0], "shear_factor = 1.0"),),
    "adiabatic_tool": ("contact.conductance=0.0", "contact.heat_partition=1.0"),
    "partition_only": ("contact.conductance=0.0",),
    "hot_tool": ("tool.temperature=600.0",),
    "fine_tip": (FINE_TIP,),
    "edge_10um": ("tool.tip_radius=0.01", FINE_TIP),
    "edge_30um": ("tool.tip_radius=0.03",),
    "clearance_7": ("tool.clearance=7.0",),
}
PREDICTED = PredictedSet(
    folder=FOLDER,
    material="Ti6Al4V",
    cuts=CUTS,
    base=BASE,
    changes=changes,
    travels={cut.name: travel(cut) for cut in CUTS},
    choices=CHOICES,
    again=(
        CutAgain("slow_hot_tool", SLOW, ("tool.temperature=600.0",), travel(SLOW)),
        CutAgain("slow_short", SLOW, (), 8.0 * SLOW.depth),
    ),
)
STUDY = PREDICTED.study()

if __name__ == "__main__":
    main(STUDY)
