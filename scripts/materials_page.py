"""Writes docs/materials.md, the list of materials and hardening laws, from the library.

python scripts/materials_page.py [docs/materials.md]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.materials.describe import source_of
from pfemcut.materials.hardening import LAWS
from pfemcut.materials.load import VALUES, library_names, load_material, material_table
from pfemcut.materials.material import Material

PAGE = Path(__file__).resolve().parent.parent / "docs" / "materials.md"
ROOM = np.array([293.15])
INTRODUCTION = """\
# Materials and hardening laws

`pfemcut materials` lists the names, `pfemcut materials NAME` prints one as a material file. In a case file a material
is a name, a path to a material file, or a table that changes some constants of a `base` (see
[case_file.md](case_file.md)). Units are mm, tonne, s and K: moduli and stresses in MPa, density in tonne/mm³
(7.8e-9 for steel), specific heat in mm²/(s² K) (1e6 times J/(kg K)), conductivity in N/(s K) (the same number as
W/(m K)), expansion in 1/K.

Every value has a source in the file itself; "ours" means that no source gave one. Hardening constants of machining
are often reprinted and seldom with their reference strain rate: [how they were checked](#how-they-were-checked) says
against what, and which could not be. None of the values was fitted to cutting forces by us. Constants were mostly found
at strains below 0.5, rates below 1e4 /s and heating rates far below those of cutting, which extrapolates.

A property given as `temperature: value` pairs is interpolated linearly and constant beyond its ends. The expansion is
the *secant* value from the reference temperature: the thermal strain is α(θ) (θ − θ0). Specific heat enters the heat
equation so that the heat content is its integral over temperature in every step. Elastic moduli do not depend on
temperature. "The paper" is Rodríguez, Carbonell, Cante, Oliver 2017 (see the README).

This page is written by `python scripts/materials_page.py` from `pfemcut/materials/library`.
"""
CHECKS = """
## How they were checked

*Unconfirmed* values are given as the cutting literature has them, but were found in no copy of their source and in no
reprint that names it. *Agrees* means equal to the digits of the reprint. Most originals are behind paywalls: a reprint
shows that others use a value, not that it was printed so. mfree_iwf is the published program of ETH Zurich's meshfree
cutting (`iwf-inspire/mfree_iwf-ul-cut-refine`).
"""


def main(arguments: Sequence[str]) -> int:
    """Write the page; the exit status."""
    path = Path(arguments[0]) if arguments else PAGE
    path.write_text(page(), encoding="utf-8")
    return 0


def page() -> str:
    """The whole page."""
    materials = {name: load_material(name, None) for name in library_names()}
    parts = [INTRODUCTION, "## Overview\n", _overview(materials), CHECKS, _checks(materials)]
    parts.append("\n## Hardening laws\n")
    for name, law in LAWS.items():
        lines = (law.__doc__ or "").strip().splitlines()
        parts.append(f"### `{name}`\n\n{lines[0]} Its equations are in `{_module(law)}`.\n")
        parts.append(_table(("Key", "Meaning"), _constants(law)) + "\n")
    parts.append("## The library")
    parts += [_section(name, material) for name, material in materials.items()]
    return "\n".join(parts) + "\n"


def _module(law: type) -> str:
    return law.__module__.replace(".", "/") + ".py"


def _constants(law: Any) -> list[tuple[str, ...]]:
    return [(f"`{key}`", field.description) for key, field in law.model_fields.items() if key != "law"]


def _overview(materials: dict[str, Material]) -> str:
    rows = []
    for name, each in materials.items():
        table = material_table(each)
        rows.append(
            (
                f"[`{name}`](#{name})",
                table["hardening"]["law"],
                f"{each.young_modulus / 1e3:g}",
                f"{each.density * 1e12:g}",
                f"{each.capacity(ROOM)[0] / 1e6:.3g}",
                f"{each.conductivity(ROOM)[0]:.3g}",
                _melting(table["hardening"]),
            )
        )
    return _table(
        ("Name", "Law", "E (GPa)", "ρ (kg/m³)", "c at 20 °C (J/(kg K))", "k at 20 °C (W/(m K))", "Melts (K)"),
        rows,
    )


def _checks(materials: dict[str, Material]) -> str:
    rows = [
        (f"[`{name}`](#{name})", source_of(each, "hardening"), each.checked)
        for name, each in materials.items()
    ]
    return _table(("Name", "Source of the hardening constants", "How checked"), rows)


def _melting(hardening: dict[str, Any]) -> str:
    return _shown(hardening["melting_temperature"]) if "melting_temperature" in hardening else "–"


def _section(name: str, material: Material) -> str:
    table = material_table(material)
    law = table["hardening"]
    rows = [(f"`{key}`", _shown(table[key]), source_of(material, key)) for key in VALUES]
    rows.append(("`hardening.law`", f"`{law['law']}`", source_of(material, "hardening")))
    rows += [
        (f"`{key}`", _shown(value), source_of(material, f"hardening.{key}"))
        for key, value in law.items()
        if key != "law"
    ]
    notes = "".join(f"- {note}\n" for note in material.notes)
    return f"\n### {name}\n\n{material.name}. {material.source}.\n\n{notes}\n" + _table(
        ("Key", "Value", "Source"), rows
    )


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        pairs = zip(value["temperature"], value["value"], strict=True)
        return "<br>".join(f"{temperature:g} K: {each:g}" for temperature, each in pairs)
    return f"{value:g}"


def _table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    if not rows:
        return "It has no constants."
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
