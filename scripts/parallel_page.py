"""Fills the tables of docs/parallel.md from benchmarks/results/scaling.json.

python scripts/parallel_page.py [docs/parallel.md]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pfemcut.validation.marked_page import Marks
from pfemcut.whole_files import write_text

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "parallel.md"
MEASURED = ROOT / "benchmarks" / "results" / "scaling.json"
MARKS = Marks("scaling")

REPLICATED = ("particles", "transfer", "momentum", "plasticity", "ledger")
"""Phases that every rank goes through for all particles; the others work on each rank's share."""
WORK = {
    "particles": "removal, insertion, triangulation",
    "transfer": "of fields between meshes",
    "mesh": "shares of the ranks",
    "system": "sparsity, set-up of the solver",
    "assembly": "residual and tangent",
    "linear_solve": "MUMPS: analysis, factors, solutions",
    "momentum": "contact, kinematics, return mapping in Newton's method",
    "plasticity": "implicit update",
    "heat": "heat equation",
    "ledger": "energies",
}
RANKS = (2, 4, 8, 16)

Phases = Mapping[str, float]


def serial_share(one: float, two: float) -> float:
    """The part of a phase that two ranks do not share, from its times with one and two ranks: T2/T1 = s + (1 - s)/2."""
    return min(max(2.0 * two / one - 1.0, 0.0), 1.0)


def ideal_shares(one: Phases) -> dict[str, float]:
    """Serial shares if what is distributed scaled perfectly."""
    return {name: float(name in REPLICATED) for name in one}


def measured_shares(one: Phases, two: Phases) -> dict[str, float]:
    """Serial shares as measured on two ranks, at least those of :func:`ideal_shares`."""
    ideal = ideal_shares(one)
    return {name: max(serial_share(one[name], two[name]), ideal[name]) for name in one}


def speed_up(one: Phases, shares: Mapping[str, float], ranks: float) -> float:
    """Amdahl's bound: of a step whose phases take ``one`` (s) on one rank."""
    time = sum(seconds * (shares[name] + (1.0 - shares[name]) / ranks) for name, seconds in one.items())
    return sum(one.values()) / time


def phases_table(one: Phases, two: Phases) -> list[str]:
    """Each phase with one and two ranks, and its bounds."""
    shares = measured_shares(one, two)
    lines = [
        "| Phase | What | Ranks do | 1 rank, ms | 2 ranks, ms | Serial share | Bound for "
        + " | ".join(map(str, RANKS))
        + " |",
        "|---|---|---|---|---|---|" + "---|" * len(RANKS),
    ]
    for name in one:
        bounds = [speed_up({name: one[name]}, shares, ranks) for ranks in RANKS]
        does = "the same" if name in REPLICATED else "their share"
        # What costs nothing on one rank has no speed-up.
        known = one[name] > 1e-4
        cells = [
            f"`{name}`",
            WORK[name],
            does,
            f"{1e3 * one[name]:.1f}",
            f"{1e3 * two[name]:.1f}",
            f"{shares[name]:.2f}" if known else "–",
            *(f"{bound:.2f}" if known else "–" for bound in bounds),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    totals = [f"{1e3 * sum(phases.values()):.1f}" for phases in (one, two)]
    steps = [f"{speed_up(one, shares, ranks):.2f}" for ranks in RANKS]
    share = sum(shares[name] * seconds for name, seconds in one.items()) / sum(one.values())
    lines.append("| " + " | ".join(["**step**", "", "", *totals, f"{share:.2f}", *steps]) + " |")
    return lines


def bounds_table(one: Phases, two: Phases) -> list[str]:
    """Amdahl's bounds of the step under different assumptions."""
    ideal, measured = ideal_shares(one), measured_shares(one, two)
    solver = {**ideal, "linear_solve": measured["linear_solve"]}
    kernels = {**ideal, "momentum": 0.0, "plasticity": 0.0}
    both = {**measured, "momentum": 0.0, "plasticity": 0.0}
    lines = [
        "| Bound of the step for | " + " | ".join(f"{ranks} ranks" for ranks in RANKS) + " | ever more |",
        "|---|" + "---|" * (len(RANKS) + 1),
    ]
    for label, shares in (
        ("all phases as measured", measured),
        ("only the linear solve as measured, the rest that is distributed perfect", solver),
        ("all that is distributed perfect", ideal),
        ("as measured, `momentum` and `plasticity` distributed too", both),
        ("all that is distributed perfect, `momentum` and `plasticity` distributed too", kernels),
    ):
        bounds = [speed_up(one, shares, ranks) for ranks in (*RANKS, 1e12)]
        lines.append(f"| {label} | " + " | ".join(f"{bound:.2f}" for bound in bounds) + " |")
    return lines


def growth_table(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The replicated part of a step on one rank, by number of particles."""
    lines = ["| Particles | Step, ms | Replicated | Linear solve |", "|---|---|---|---|"]
    for row in rows:
        phases = row["phases"]
        total = sum(phases.values())
        replicated = sum(phases[name] for name in REPLICATED) / total
        lines.append(
            f"| {row['particles']} | {1e3 * row['step_seconds']:.0f} | {replicated:.0%} | "
            f"{phases['linear_solve'] / total:.0%} |"
        )
    return lines


def content(measured: Mapping[str, Any]) -> str:
    """All tables."""
    lines = []
    for row in measured["ranks"]:
        one, two = row["one"]["phases"], row["two"]["phases"]
        lines += [
            f"{row['one']['particles']} particles, {row['one']['newton_iterations']:g} Newton iterations a step; "
            f"two ranks are {row['ratio']:.2f} times as fast as one, their forces differ by "
            f"{row['force_difference']:.0e}:",
            "",
            *phases_table(one, two),
            "",
            *bounds_table(one, two),
            "",
        ]
    lines += ["One rank:", "", *growth_table(measured["growth"]), ""]
    machine = measured["machine"]
    lines.append(
        f"Measured with `{measured['command']}` on {measured['date'][:10]}, commit {measured['commit']}, "
        f"{machine['cores']} cores ({machine['processor']}), load {measured['load_average']}."
    )
    return "\n".join(lines)


def page(text: str) -> str:
    """The page ``text`` with the tables of what is recorded."""
    return MARKS.filled(text, content(json.loads(MEASURED.read_text(encoding="utf-8"))))


def main(arguments: Sequence[str]) -> None:
    """Fill the tables."""
    path = Path(arguments[0]) if arguments else PAGE
    write_text(path, page(path.read_text(encoding="utf-8")))


if __name__ == "__main__":
    main(sys.argv[1:])
