"""Fills the table of docs/tool_profiles.md from docs/tool_profiles.json.

python scripts/tool_profiles_page.py                fills the page
python scripts/tool_profiles_page.py record DIR ... measures runs into the JSON file first, and takes the pictures of
                                                    the first two
"""

from __future__ import annotations

import json
import shutil
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.output.directory import CONTACT, FIGURES, HISTORY, INPUTS
from pfemcut.output.profile_figure import NAME
from pfemcut.output.tool_profiles import cut_profiles
from pfemcut.results.derived.profile_figures import profile_figures
from pfemcut.results.derived.steady_window import steady_window
from pfemcut.results.derived.tool_profiles import force_of_profiles
from pfemcut.results.history import read_table
from pfemcut.validation.marked_page import Marks
from pfemcut.validation.provenance import provenance
from pfemcut.whole_files import write_json

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "tool_profiles.md"
MEASURED = ROOT / "docs" / "tool_profiles.json"
PICTURES = tuple(
    ROOT / "docs" / "pictures" / f"{name}.png" for name in ("tool_profiles", "tool_profiles_conducting")
)
MARKS = Marks("measured")
FORCES = ("cutting", "thrust")
MICROMETRES_PER_MINUTE = 6e4


def main(arguments: Sequence[str]) -> int:
    """Measure runs if asked to, and fill the page; the exit status."""
    if arguments and arguments[0] == "record":
        folders = [Path(each) for each in arguments[1:]]
        content = {**provenance(), "runs": [measured(each) for each in folders]}
        write_json(MEASURED, content)
        for folder, picture in zip(folders, PICTURES, strict=False):
            shutil.copyfile(folder / FIGURES / NAME, picture)
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


def measured(folder: Path) -> dict[str, Any]:
    """What the profiles of a run add up to, beside its history, and its wear rates."""
    (found,) = cut_profiles(folder)
    profiles = found.profiles
    history = read_table(folder / HISTORY)
    window = steady_window(history["travel"], history["cutting_force"])
    integral = force_of_profiles(profiles, found.inputs.tool)
    force = {
        name: {
            "history": window.mean(history[f"{name}_force"]),
            "instants": float(profiles.forces[:, i].mean()),
            "integral": float(integral[i]),
        }
        for i, name in enumerate(FORCES)
    }
    figures = profile_figures(profiles)
    return {
        "title": tomllib.loads((folder / INPUTS).read_text(encoding="utf-8"))["title"],
        "source": "contact records" if (folder / CONTACT).exists() else "frames",
        "instants": profiles.instants,
        "travel": list(found.travel),
        "force": force,
        "wear": {name: figure for name, figure in figures.items() if "wear" in name},
        "hottest": float(np.nanmax(profiles.quantities["temperature"].mean)),
        "tool_hottest": [
            float(np.nanmax(profiles.quantities[name].mean))
            for name in ("tool_temperature",)
            if name in profiles.quantities
        ],
        "constants": [each.name for each in found.inputs.wear],
    }


def page(text: str) -> str:
    """``text`` of the page with its tables filled."""
    content = json.loads(MEASURED.read_text(encoding="utf-8"))
    return MARKS.filled(text, "\n".join([*_forces(content), "", *_wear(content)]))


def _forces(content: Mapping[str, Any]) -> list[str]:
    lines = [
        "| Run | Instants | Force | History, window | Particles, instants | Integral of profile | Against history |",
        "|---|---|---|---|---|---|---|",
    ]
    for run in content["runs"]:
        for name in FORCES:
            force = run["force"][name]
            difference = force["integral"] / force["history"] - 1.0
            lines.append(
                f"| {run['title']} | {run['instants']} {run['source']} | {name} | {force['history']:.2f} | "
                f"{force['instants']:.2f} | {force['integral']:.2f} | {difference:+.2%} |"
            )
    date, commit = content["date"][:10], content["commit"]
    return [*lines, "", f"N/mm. `{content['command']}`, {date}, commit {commit}."]


def _wear(content: Mapping[str, Any]) -> list[str]:
    lines = [
        "| Run | Constants | Crater, largest | Where | Edge, largest | Flank, mean | Hottest workpiece in contact | "
        "Hottest tool |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for run in content["runs"]:
        if run["wear"]:
            wear = run["wear"]
            rates = [
                _rate(wear[name]) if name in wear else "–"
                for name in ("crater_wear_rate", "edge_wear_rate", "flank_wear_rate")
            ]
            where = f"{wear['crater_wear_position']['value']:.3f} mm"
            tool = "; ".join(f"{each:.0f} K" for each in run["tool_hottest"]) or "–"
            lines.append(
                f"| {run['title']} | {'; '.join(run['constants'])} | {rates[0]} | {where} | {rates[1]} | {rates[2]} | "
                f"{run['hottest']:.0f} K | {tool} |"
            )
    return lines


def _rate(figure: Mapping[str, float]) -> str:
    mean, std = (MICROMETRES_PER_MINUTE * figure[name] for name in ("mean", "std"))
    return f"{mean:.2g} ± {std:.1g} µm/min"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
