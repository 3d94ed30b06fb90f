"""Is a stiff tool the rigid one, and what does the elasticity of a steel tool change?

    python demos/aisi4340_deformable/stiffness.py [-o DIR] [--resume | --overwrite] [--travel MM]

On the reduced block and coarse mesh of demos/aisi4340_demo, without friction. The forces with a tool a hundred times
stiffer than steel must be those with the rigid tool within the scatter of a cut; those with a steel tool within a few
per cent.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.validation.study import Outcome, Study, Variant, main, write_table

FIGURES = (
    "cutting_force",
    "thrust_force",
    "contact_length",
    "max_temperature",
    "shear_angle_band",
    "energy_error",
)
TOOL = (
    "tool_max_von_mises",
    "tool_von_mises_along_rake",
    "tool_von_mises_depth",
    "tool_max_principal",
    "tool_min_principal",
    "tool_tip_deflection_x",
    "tool_tip_deflection_y",
)
STIFF_LIMIT = {"cutting_force": 0.01, "thrust_force": 0.02}
STEEL_LIMIT = {"cutting_force": 0.04, "thrust_force": 0.08}


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    by_name = {outcome.variant.name: outcome for outcome in outcomes}
    rigid = by_name["rigid"]

    def relative(name: str, figure: str) -> float:
        return by_name[name].mean(figure) / rigid.mean(figure) - 1.0

    rows: list[list[str | float]] = [
        [
            outcome.variant.name,
            *(outcome.mean(name) for name in FIGURES),
            *(relative(outcome.variant.name, name) for name in STEEL_LIMIT),
            *(outcome.mean(name) for name in TOOL),
        ]
        for outcome in outcomes
    ]
    header = ["tool", *FIGURES, *(f"{name}_difference" for name in STEEL_LIMIT), *TOOL]
    write_table(results / "stiffness.csv", "Rigid and deformable tools", header, rows)
    checks = {
        f"{variant}_{figure}": (abs(relative(variant, figure)), limit)
        for variant, limits in (("stiff", STIFF_LIMIT), ("steel", STEEL_LIMIT))
        for figure, limit in limits.items()
    }
    content = {"checks": {name: {"value": value, "limit": limit} for name, (value, limit) in checks.items()}}
    shown = all(value <= limit for value, limit in checks.values())
    return content, shown and all(bool(outcome.summary["finished"]) for outcome in outcomes)


def deformable(name: str, modulus: float) -> Variant:
    material = f'{{ base = "aisi4340", young_modulus = {modulus}, hardening = {{ law = "elastic" }} }}'
    body = f"tool.body={{ material = {material}, tip_size = 0.004, face_size = 0.015 }}"
    title = f'title="AISI 4340, deformable tool ({name})"'
    return Variant(name, (title, 'tool.model="deformable"', body))


STUDY = Study(
    "stiffness",
    Path(__file__).resolve().parent,
    (
        Variant("rigid"),
        deformable("stiff", 2.0e7),
        deformable("steel", 200.5e3),
    ),
    conclude,
    travel=0.4,
)

if __name__ == "__main__":
    main(STUDY)
