"""Writes docs/validation.md from the recorded results of the published and the measured cuts.

python scripts/validation_page.py [docs/validation.md]
"""

from __future__ import annotations

import csv
import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from results_table import table  # noqa: E402

PAGE = ROOT / "docs" / "validation.md"
DEMOS = ROOT / "demos"
INTRODUCTION = """\
# Validation

Cuts that others have computed or measured. [Verification](verification.md) is the other half: problems with known
solutions. Nothing was fitted to the forces; what was assumed, and why a figure misses, is on each case's page.

This page is written by `python scripts/validation_page.py` from `demos/*/results`.
"""
PUBLISHED = """\
## Published cases

The paper's cases; 42CD4 against the experiment that it cites. Means ± standard deviations over the steady window.
Pressing and cutting with SPH, and the Taylor bar's ladder of spacings: [particles](particles.md).
"""
PREDICTED = """\
## Predictions of measured cuts

Friction, material and tool as published, nothing adjusted. Behind ± stands the numerical uncertainty of a computed
figure (each case's page says of what), and the experimenters' scatter of a measured one.
"""
FIGURES = {"cutting_force": "cutting force", "thrust_force": "thrust force", "chip_ratio": "chip ratio"}
PICTURES = {"temperature": "Temperature", "forces": "Forces"}


def main(arguments: Sequence[str]) -> int:
    """Write the page; the exit status."""
    path = Path(arguments[0]) if arguments else PAGE
    path.write_text(page(), encoding="utf-8")
    return 0


def page() -> str:
    """The whole page."""
    recorded = [path.parent.parent for path in sorted(DEMOS.glob("*/results/comparison.json"))]
    published = table(DEMOS)
    for folder in recorded:
        published = published.replace(f"](demos/{folder.name})", f"](#{folder.name})")
    published = re.sub(r"\]\(demos/(\w+)\)", r"](../demos/\1/README.md)", published)
    parts = [INTRODUCTION, PUBLISHED, f"{published}\n"]
    parts += [published_case(folder) for folder in recorded]
    predicted = sorted(DEMOS.glob("*/results/predict.csv"))
    if predicted:
        parts += [PREDICTED, *(predicted_case(path.parent.parent) for path in predicted)]
    return "\n".join(parts)


def published_case(folder: Path) -> str:
    """A case with published figures: its pictures, and how it was made."""
    recorded = json.loads((folder / "results" / "comparison.json").read_text(encoding="utf-8"))["recorded"]
    lines = [
        f"### {folder.name}\n",
        f"{_title(folder)}. [Case, assumptions, discussion](../demos/{folder.name}/README.md).\n",
    ]
    for name, label in PICTURES.items():
        picture = folder / "results" / "figures" / f"{name}.png"
        if picture.is_file():
            lines.append(f"![{label}](../{picture.relative_to(ROOT)})\n")
    return "\n".join([*lines, f"{_made(recorded)}\n"])


def predicted_case(folder: Path) -> str:
    """A case with measured figures: computed beside measured, and the picture."""
    with (folder / "results" / "predict.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    known = [name for name in FIGURES if rows and f"{name}_measured" in rows[0]]
    heads = ["Depth (mm)", "Speed (m/min)"]
    heads += [f"{FIGURES[name].capitalize()}: computed | measured | difference" for name in known]
    head = " | ".join(heads)
    lines = [
        f"### {folder.name}\n",
        f"{_title(folder)}. [Experiment, assumptions, discussion](../demos/{folder.name}/README.md).\n",
        f"| {head} |",
        "|---" * (head.count("|") + 1) + "|",
        *(prediction(row, known) for row in rows),
        "",
    ]
    for picture in sorted((folder / "results").glob("predict*.png")):
        lines.append(f"![{folder.name}](../{picture.relative_to(ROOT)})\n")
    return "\n".join(lines)


def prediction(row: Mapping[str, str], names: Sequence[str]) -> str:
    """One line of a table of predictions; empty where nothing was measured."""
    cells = [_number(row.get("depth_mm", "")), _number(row.get("speed_m_min", ""))]
    for name in names:
        difference = row.get(f"{name}_difference", "")
        cells += [
            _with(row.get(name, ""), row.get(f"{name}_uncertainty", "")),
            _with(row.get(f"{name}_measured", ""), row.get(f"{name}_measured_scatter", "")),
            f"{100.0 * float(difference):+.0f} %" if difference else "",
        ]
    return "| " + " | ".join(cells) + " |"


def _with(value: str, spread: str) -> str:
    return f"{_number(value)} ± {float(spread):.2g}" if value and spread else _number(value)


def _number(text: str) -> str:
    return f"{float(text):.3g}" if text else ""


def _title(folder: Path) -> str:
    """The title of a case's page."""
    return (folder / "README.md").read_text(encoding="utf-8").splitlines()[0].lstrip("# ")


def _made(recorded: Mapping[str, object]) -> str:
    command = recorded.get("command")
    shown = " ".join(command) if isinstance(command, list) else command
    made = [f"`{shown}`" if shown else "", str(recorded.get("date", "")), f"commit {recorded.get('commit')}"]
    return "Made by " + ", ".join(each for each in made if each) + "."


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
