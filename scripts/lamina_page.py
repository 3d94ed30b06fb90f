"""Fills the tables of docs/lamina.md from demos/lamina/results and benchmarks/results/lattice_speed.json.

python scripts/lamina_page.py
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pfemcut.validation.marked_page import Marks

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "lamina.md"
RUNS = ROOT / "demos" / "lamina" / "results" / "runs.json"
SPEED = ROOT / "benchmarks" / "results" / "lattice_speed.json"

Runs = Mapping[str, Mapping[str, Any]]


def main() -> int:
    """Write the page; the exit status."""
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


def page(text: str) -> str:
    """The page ``text`` with its tables written anew."""
    runs: Runs = json.loads(RUNS.read_text(encoding="utf-8"))
    speed = json.loads(SPEED.read_text(encoding="utf-8"))
    for name, content in (
        ("elastic", elastic_table(of_group(runs, "elastic"))),
        ("cases", crack_table({**of_group(runs, "cases"), **of_group(runs, "mixed mode")})),
        ("criteria", crack_table(of_group(runs, "criteria"))),
        ("spacing", spacing_table(runs)),
        ("speed", speed_table(speed)),
    ):
        text = Marks(name).filled(text, content)
    return text


def of_group(runs: Runs, group: str) -> Runs:
    """The runs of a group."""
    return {name: each for name, each in runs.items() if each["group"] == group}


def elastic_table(runs: Runs) -> str:
    """Moduli beside laminate theory, and the centre line's displacement beside the uniform strain's."""
    rows = [
        "| Fibre | Young's modulus (MPa) | Laminate theory | Difference "
        "| Centre line, largest difference / elongation |",
        "|---|---|---|---|---|",
    ]
    for name, each in runs.items():
        rows.append(
            f"| {name.rpartition('-')[2]}° | {each['young_modulus']:.0f} | {each['theory']:.0f} | {each['error']:+.1%} "
            f"| {each['centre_line_error']:.2%} |"
        )
    return "\n".join(rows)


def crack_table(runs: Runs) -> str:
    """Start and direction of the first two cracks, loads and parts."""
    rows = [
        "| Case | First crack starts at x, y (mm) | Angle, first and second crack "
        "| Load at the first break (N) | Peak load (N) | Parts |",
        "|---|---|---|---|---|---|",
    ]
    for name, each in runs.items():
        cracks = each["cracks"]
        start = ", ".join(f"{round(x, 2) + 0.0:.2f}" for x in cracks[0]["start"]) if cracks else "no crack"
        angles = ", ".join(f"{round(crack['angle'], 1) + 0.0:.1f}°" for crack in cracks) or "–"
        first = f"{each['load_at_first_break']:.0f}" if cracks else "–"
        rows.append(f"| {name} | {start} | {angles} | {first} | {each['peak_load']:.0f} | {each['parts']} |")
    return "\n".join(rows)


def spacing_table(runs: Runs) -> str:
    """What the lattice spacing changes."""
    rows = [
        "| Case | Spacing (mm) | Sites | First crack starts at x, y (mm) | Angle "
        "| Load at the first break (N) | LEFM (N) |",
        "|---|---|---|---|---|---|---|",
    ]
    for case in ("A-45", "B-90-90"):
        found = [each for name, each in runs.items() if name == case or name.startswith(f"{case} R")]
        for each in sorted(found, key=lambda each: -float(each["spacing"])):
            crack = each["cracks"][0]
            start = ", ".join(f"{round(x, 2) + 0.0:.2f}" for x in crack["start"])
            theory = f"{each['critical_load_by_lefm']:.0f}" if "critical_load_by_lefm" in each else "–"
            rows.append(
                f"| {case} | {each['spacing']:g} | {each['sites']} | {start} | {crack['angle']:.1f}° "
                f"| {each['load_at_first_break']:.0f} | {theory} |"
            )
    return "\n".join(rows)


def speed_table(speed: Mapping[str, Any]) -> str:
    """Bond-steps a second of the lattice and of LAMMPS."""
    rows = [
        "| Program | Bonds | Threads | Million bond-steps a second | The same a second of processor time |",
        "|---|---|---|---|---|",
    ]
    found = [("pfemcut, lattice", speed[f"threads_{threads}"], threads) for threads in (1, 2)]
    found += [
        (f"LAMMPS {each['version']}, peri/pmb, horizon {each['horizon']:g} spacings", each, 1)
        for each in speed.get("lammps_peri", ())
    ]
    for name, each, threads in found:
        rows.append(
            f"| {name} | {each['bonds']} | {threads} | {1e-6 * each['bond_steps_a_second']:.1f} "
            f"| {1e-6 * each['bond_steps_a_cpu_second']:.1f} |"
        )
    return "\n".join(rows)


if __name__ == "__main__":
    sys.exit(main())
