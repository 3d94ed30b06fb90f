"""The cut of run.py with other spacings, more frequent reference updates and less viscosity, beside the PFEM's.

    python demos/aisi4340_rake6_tlsph/spacing.py [-o DIR] [--resume | --overwrite] [--only NAME] [--conclude]

Concludes from the runs that are finished, run.py's recorded one and that of demos/aisi4340_rake6: results/spacing.csv
and spacing.json.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pfemcut.results.published import ALWAYS_SHOWN
from pfemcut.results.summary import figure_mean, figure_std
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, main, write_table

FOLDER = Path(__file__).resolve().parent
RECORDED = {"pfem": FOLDER.parent / "aisi4340_rake6", "spacing_0.01": FOLDER}
SHARES = ("viscous_work", "zero_energy_work", "kinetic_energy")
SCATTERING = ("cutting_force", "thrust_force")


def conclude(outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    """A table of all runs, the recorded ones first."""
    rows = [
        row(name, json.loads((folder / "results" / "summary.json").read_text(encoding="utf-8")))
        for name, folder in RECORDED.items()
    ]
    rows += [row(outcome.variant.name, outcome.summary) for outcome in outcomes]
    header = ("run", *ALWAYS_SHOWN, *(f"{name}_std" for name in SCATTERING), *SHARES, "wall_time")
    write_table(results / "spacing.csv", "Spacing, reference updates and viscosity", header, rows)
    finished = all(outcome.summary["finished"] for outcome in outcomes)
    return {"figures": finite_figures(header, rows)}, finished


def row(name: str, summary: Mapping[str, Any]) -> list[str | float]:
    """Means over the window and the forces' deviation; works and kinetic energy over the tool's work."""
    ledgers = summary["ledgers"]
    return [
        name,
        *(figure_mean(summary, figure) for figure in ALWAYS_SHOWN),
        *(figure_std(summary, figure) for figure in SCATTERING),
        *(abs(ledgers.get(share, float("nan"))) / ledgers["tool_work"] for share in SHARES),
        figure_mean(summary, "wall_time"),
    ]


STUDY = Study(
    "spacing",
    FOLDER,
    (
        Variant("spacing_0.01_update_0.25", ("particles.reference_update=0.25",)),
        Variant("spacing_0.01_viscosity_0.1", ("particles.alpha=0.1", "particles.beta=0.1")),
        Variant("spacing_0.0133", ("particles.spacing=0.013333",)),
        Variant("spacing_0.00667", ("particles.spacing=0.0066667",)),
    ),
    conclude,
    1.24,
    FOLDER / "case.toml",
    partial=True,
)

if __name__ == "__main__":
    main(STUDY)
