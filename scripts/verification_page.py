"""Writes docs/verification.md from the recorded results and the READMEs of tests/verification.

python scripts/verification_page.py [docs/verification.md]

A problem's headline figures are those that its headlines.toml names.
"""

from __future__ import annotations

import json
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "verification.md"
PROBLEMS = ROOT / "tests" / "verification"
INTRODUCTION = """\
# Verification

Problems whose solution is known, solved by the same program as a cut. Each has a folder in `tests/verification` with
its case file, its reference, `verify.py`, the recorded results, and a README with the whole tables and what was missed
and why; a coarse version is among the tests. The commands below repeat the runs from the root of the repository, and
`make validate` repeats all.

This page is written by `python scripts/verification_page.py`; the figures are those of each `results/summary.json`.
"""
GROUPS = {
    "Elasticity and plasticity": (
        "homogeneous",
        "thick_cylinder",
        "prandtl_punch",
        "cook_membrane",
        "necking",
        "quenched_layer",
    ),
    "Contact and friction": (
        "contact_patch",
        "hertz",
        "wedge_indentation",
        "sliding_block",
        "two_body_patch",
        "two_body_hertz",
        "self_contact",
    ),
    "Heat": (
        "heat_flux_half_space",
        "moving_line_source",
        "moving_band_source",
        "two_body_conduction",
        "two_body_heat",
    ),
    "Remeshing": ("transfer",),
    "Particles without a mesh (SPH)": (
        "sph_exactness",
        "sph_waves",
        "sph_plate",
        "sph_tension",
        "sph_point",
        "sph_heat",
        "sph_updates",
    ),
}
HEAD = "| Figure | Computed | Reference | Difference |\n|---|---|---|---|"


def main(arguments: Sequence[str]) -> int:
    """Write the page; the exit status."""
    path = Path(arguments[0]) if arguments else PAGE
    path.write_text(page(), encoding="utf-8")
    return 0


def page() -> str:
    """The whole page; problems that no group names come last."""
    recorded = [path.parent.name for path in sorted(PROBLEMS.glob("*/headlines.toml"))]
    grouped = {name for names in GROUPS.values() for name in names}
    groups = {**GROUPS, "Others": tuple(name for name in recorded if name not in grouped)}
    parts = [INTRODUCTION]
    for title, names in groups.items():
        if names:
            parts += [f"## {title}\n", *(section(PROBLEMS / name) for name in names)]
    return "\n".join(parts)


def section(folder: Path) -> str:
    """One problem: what it is and its reference by its README, its headline figures, its picture."""
    title, *paragraphs = (folder / "README.md").read_text(encoding="utf-8").strip().split("\n\n")
    words = [paragraphs[0], *(text for text in paragraphs[1:] if text.startswith("**Reference"))]
    summary = json.loads((folder / "results" / "summary.json").read_text(encoding="utf-8"))
    figures = tomllib.loads((folder / "headlines.toml").read_text(encoding="utf-8"))["figure"]
    where = f"../{folder.relative_to(ROOT)}"
    made = summary["date"] + (f", commit {summary['commit']}" if "commit" in summary else "")
    return "\n\n".join(
        [
            f"##{title}",
            *words,
            "\n".join([HEAD, *(row(figure, summary) for figure in figures)]),
            f"`python -m tests.verification.{folder.name}.verify` ({made}); more in the [README]({where}/README.md).",
            f"![{title.lstrip('# ')}]({where}/results/{folder.name}.png)\n",
        ]
    )


def row(figure: Mapping[str, Any], summary: Mapping[str, Any]) -> str:
    """One line of a table.

    ``computed``, ``reference`` and ``difference`` are paths in the summary, or text. Without ``difference`` it is that
    of the two; it is relative, or in percent if the figure says ``percent``, and has no sign if it says ``absolute``.
    """
    computed, reference, difference = (
        looked_up(figure.get(name), summary) for name in ("computed", "reference", "difference")
    )
    if isinstance(difference, float):
        difference *= 1.0 if figure.get("percent") else 100.0
    elif difference is None and isinstance(computed, float) and isinstance(reference, float):
        difference = 100.0 * (computed / reference - 1.0)
    shown = ""
    if isinstance(difference, float):
        shown = f"{difference:.2g} %" if figure.get("absolute") else f"{difference:+.2g} %"
    return f"| {figure['label']} | {number(computed)} | {number(reference)} | {shown} |"


def looked_up(path: Sequence[str] | str | None, summary: Any) -> Any:
    """What is at ``path``; text stands for itself."""
    if path is None or isinstance(path, str):
        return path
    for name in path:
        summary = summary[name]
    return summary


def number(value: Any) -> str:
    """Five digits, or two of what is nearly nothing."""
    if isinstance(value, float):
        return f"{value:.5g}" if abs(value) >= 1e-3 else f"{value:.2g}"
    return "" if value is None else str(value)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
