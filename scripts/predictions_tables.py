"""Fills the tables of predicted and measured cuts in the README and in the demos' pages from demos/*/results/predict.*.

python scripts/predictions_tables.py
"""

from __future__ import annotations

import csv
import json
import math
import re
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pfemcut.validation.marked_page import Marks
from pfemcut.whole_files import write_text

ROOT = Path(__file__).resolve().parent.parent
SETS = {"ti6al4v_ducobu": "Ti6Al4V", "aisi1045_klocke": "AISI 1045"}
FIGURES = {
    "cutting_force": ("Cutting force (N/mm)", 1),
    "thrust_force": ("Feed force (N/mm)", 1),
    "chip_ratio": ("Chip / uncut", 2),
}
"""Label and decimals of the compared figures."""
SHORT_CHIP = (
    "The chip was too short, in part of the window, for the whole range over which its thickness is defined."
)
# What a summary warns of; less than half a percent is the edge of the window.
_TOO_SHORT = re.compile(r"in [1-9]\d*% of the window the chip was too short")


@dataclass(frozen=True)
class Recorded:
    """What a set's ``predict.py`` recorded: rows of its tables, its JSON file; and the rake angle (degree)."""

    name: str
    rake: float
    cuts: Sequence[Mapping[str, str]]
    sensitivities: Sequence[Mapping[str, str]]
    content: Mapping[str, Any]


def main() -> int:
    """Fill all pages; the exit status."""
    for page, text in pages(ROOT).items():
        if page.read_text(encoding="utf-8") != text:
            write_text(page, text)
    return 0


def pages(root: Path) -> dict[Path, str]:
    """The pages with their tables as they should be."""
    found = [recorded(root, name) for name in SETS if (root / "demos" / name / "results").is_dir()]
    texts = {root / "README.md": {"predictions": overview(found)}}
    for each in found:
        texts[root / "demos" / each.name / "README.md"] = {
            section: table(each) for section, table in SECTIONS.items()
        }
    return {page: filled(page, sections) for page, sections in texts.items()}


def recorded(root: Path, name: str) -> Recorded:
    """Read what a set recorded."""
    results = root / "demos" / name / "results"
    case = tomllib.loads((root / "demos" / name / "case.toml").read_text(encoding="utf-8"))
    return Recorded(
        name,
        case["tool"]["rake"],
        _rows(results / "predict.csv"),
        _rows(results / "sensitivities.csv"),
        json.loads((results / "predict.json").read_text(encoding="utf-8")),
    )


def filled(page: Path, sections: Mapping[str, str]) -> str:
    """The page's text with each section between its marks."""
    text = page.read_text(encoding="utf-8")
    for section, content in sections.items():
        text = Marks(section).filled(text, content)
    return text


def overview(sets: Sequence[Recorded]) -> str:
    """The cuts whose measured figures are given, of all sets, and the mean errors."""
    lines = _head(["Cut", *_compared()])
    for each in sets:
        link = f"[{SETS[each.name]}](demos/{each.name}/README.md)"
        lines += [
            _line([f"{link}, {_cut(row)}", *_figures(row)])
            for row in each.cuts
            if row["cutting_force_measured"]
        ]
    for each in sets:
        errors = each.content["errors"]
        if errors:
            said = ", ".join(
                f"{FIGURES[name][0].split(' (')[0].lower()} {_share(errors[name]['mean'])}"
                for name in FIGURES
            )
            lines += ["", f"Mean error, {SETS[each.name]}: {said}."]
    return "\n".join(lines)


def predictions(each: Recorded) -> str:
    """All cuts beside the measured ones."""
    lines = _head(["Cut", *_compared()])
    for row in each.cuts:
        star = "" if row["chip_complete"] == "yes" else " *"
        unsteady = "" if row["steady"] == "yes" else " (not steady)"
        lines.append(_line([f"{_cut(row)}{star}{unsteady}", *_figures(row)]))
    missing = each.content["not_run"]
    if missing:
        lines += ["", f"Not predicted yet: {', '.join(missing)}."]
    return "\n".join(lines)


def errors(each: Recorded) -> str:
    """Mean and largest errors, and the numerical parts of the uncertainty."""
    lines = _head(["", *(label for label, _ in FIGURES.values())])
    found, parts = each.content["errors"], each.content["relative_uncertainty"]
    for title, kind in (("Mean error", "mean"), ("Largest error", "largest")):
        if found:
            lines.append(_line([title, *(_share(found[name][kind]) for name in FIGURES)]))
    for title, part in (("Uncertainty by the mesh", "mesh"), ("Uncertainty by the step", "step")):
        values = [parts[part][name] for name in FIGURES]
        lines.append(
            _line([title, *("–" if value is None else _share(value, decimals=1) for value in values)])
        )
    return "\n".join(lines)


def shares(each: Recorded) -> str:
    """Forces on the parts of the tool."""
    lines = _head(
        ["Cut", "Rake face (N/mm)", "Edge", "Flank", "Rake face's friction", "Measured forces would need"]
    )
    for row in each.cuts:
        borne = {name: _pair(row, name) for name in ("rake", "tip", "flank")}
        pairs = [f"{cutting:.1f} / {feed:.1f}".replace("-", "−") for cutting, feed in borne.values()]
        rest = [
            _number(row, f"{force}_measured") - borne["tip"][i] - borne["flank"][i]
            for i, force in enumerate(("cutting_force", "thrust_force"))
        ]
        needed = _friction(rest, each)
        lines.append(
            _line(
                [
                    _cut(row),
                    *pairs,
                    f"{_friction(borne['rake'], each):.2f}",
                    "" if math.isnan(needed) else f"{needed:.2f}",
                ]
            )
        )
    return "\n".join(lines)


def sensitivities(each: Recorded) -> str:
    """What each choice moves."""
    lines = _head(["Run", "Beside", *(label.split(" (")[0] for label, _ in FIGURES.values()), "Hottest (K)"])
    for row in each.sensitivities:
        changes = [_percent(_number(row, f"{name}_change"), decimals=1) for name in FIGURES]
        lines.append(
            _line(
                [
                    f"`{row['run']}`{_star(each, row['run'])}",
                    f"`{row['relative_to']}`{_star(each, row['relative_to'])}",
                    *changes,
                    f"{_number(row, 'max_temperature'):.0f}",
                ]
            )
        )
    if any(" *" in line for line in lines):
        lines += ["", f"\\* {SHORT_CHIP}"]
    return "\n".join(lines)


def _star(each: Recorded, run: str) -> str:
    """A mark if the chip of a run was not complete all over the window; by a table, else by its recorded warnings."""
    told = {row["cut"]: row["chip_complete"] for row in each.cuts}
    told |= {row["run"]: row["chip_complete"] for row in each.sensitivities if "chip_complete" in row}
    if run in told:
        return "" if told[run] == "yes" else " *"
    warned = each.content.get("runs", {}).get(run, {}).get("warnings", ())
    return " *" if any(_TOO_SHORT.match(text) for text in warned) else ""


SECTIONS: Mapping[str, Callable[[Recorded], str]] = {
    "predictions": predictions,
    "errors": errors,
    "shares": shares,
    "sensitivities": sensitivities,
}


def _friction(force: Sequence[float], each: Recorded) -> float:
    """Friction over normal force on the rake face of the cutting and feed force on it."""
    return math.tan(math.radians(each.rake) + math.atan2(force[1], force[0]))


def _compared() -> list[str]:
    return [word for label, _ in FIGURES.values() for word in (label, "Measured", "Difference")]


def _figures(row: Mapping[str, str]) -> list[str]:
    cells = []
    for name, (_, decimals) in FIGURES.items():
        value, width = _number(row, name), _number(row, f"{name}_uncertainty")
        cells.append("–" if math.isnan(value) else f"{value:.{decimals}f} ± {width:.{decimals}f}")
        given, scatter = _number(row, f"{name}_measured"), _number(row, f"{name}_measured_scatter")
        known = not math.isnan(given)
        cells.append(f"{given:.{decimals}f} ± {scatter:.{decimals}f}" if known else "")
        cells.append(_percent(_number(row, f"{name}_difference")) if known else "")
    return cells


def _percent(value: float, decimals: int = 0) -> str:
    return f"{value:+.{decimals}%}".replace("%", " %").replace("-", "−")


def _share(value: float, decimals: int = 0) -> str:
    return f"{value:.{decimals}%}".replace("%", " %")


def _cut(row: Mapping[str, str]) -> str:
    return f"{1000.0 * float(row['depth_mm']):g} µm, {float(row['speed_m_min']):g} m/min"


def _pair(row: Mapping[str, str], part: str) -> tuple[float, float]:
    return _number(row, f"cutting_on_{part}"), _number(row, f"thrust_on_{part}")


def _number(row: Mapping[str, str], name: str) -> float:
    return float(row[name]) if row[name] else math.nan


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _head(titles: Sequence[str]) -> list[str]:
    return [_line(titles), "|" + "---|" * len(titles)]


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    sys.exit(main())
