"""Fills the tables of docs/particles.md from what the demos of particles recorded.

python scripts/particles_tables.py
"""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from pfemcut.validation.marked_page import Marks
from pfemcut.whole_files import write_text

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "particles.md"
METHODS = ("tlsph", "esph")
NOTHING = "No run has been recorded yet."
TAYLOR = {
    "length": ("Length, surface to surface (mm)", 2),
    "length_centres": ("centre to centre", 2),
    "diameter": ("Diameter, surface to surface (mm)", 2),
    "diameter_centres": ("centre to centre", 2),
    "diameter_stretched": ("stretched", 2),
    "unevenness": ("Unevenness (%)", 3),
}
PRESSING = {
    "particles": ("Particles", 0),
    "rate_band_width": ("Band width (mm)", 3),
    "rate_angles": ("Families at (degree)", 0),
    "rate_contrast": ("Contrast", 2),
    "gradient": ("Gradient of strain (1/mm)", 1),
    "strain_left": ("Strain: left third", 3),
    "strain_middle": ("middle", 3),
    "strain_right": ("right", 3),
    "unevenness": ("Unevenness (%)", 3),
}
CUTTING = {
    "cutting_force": ("Cutting force (N/mm)", 0),
    "cutting_force_std": ("its deviation", 0),
    "chip_thickness": ("Chip thickness (mm)", 3),
    "band_angle": ("Band: angle (degree)", 0),
    "band_width": ("width (mm)", 3),
    "segments": ("Segments", 0),
    "segment_length": ("their length before the cut (mm)", 2),
    "strain_spread": ("Spread of strain along the chip", 2),
    "strain_noise": ("Noise of strain (%)", 1),
    "nearest_variation": ("Variation of the nearest distance", 2),
    "clustered": ("Clustered (%)", 1),
    "unevenness": ("Unevenness (%)", 2),
}
BESIDE = {"PFEM": "aisi4340_rake6", "tlsph": "aisi4340_rake6_tlsph", "esph": "aisi4340_rake6_esph"}
PERCENT = ("unevenness", "clustered", "strain_noise")
CUT = {
    "cutting_force": ("Cutting force (N/mm)", 1),
    "thrust_force": ("Thrust force (N/mm)", 1),
    "chip_thickness": ("Chip thickness (mm)", 3),
    "contact_length": ("Contact length (mm)", 3),
    "shear_angle": ("Shear angle, chip ratio (degree)", 1),
    "max_temperature": ("Maximum temperature (K)", 0),
    "contact_end_temperature": ("Temperature where contact ends (K)", 0),
}


def main() -> int:
    """Fill the page; the exit status."""
    text = PAGE.read_text(encoding="utf-8")
    found = filled(text, ROOT / "demos")
    if found != text:
        write_text(PAGE, found)
    return 0


def filled(text: str, demos: Path) -> str:
    """The page's ``text`` with the tables of what is recorded in ``demos``."""
    sections = {
        "taylor": studied(demos, "taylor", "ladder", TAYLOR),
        "pressing": studied(demos, "pressing", "bands", PRESSING),
        "cutting": studied(demos, "cutting", "cuts", CUTTING),
        "rake6": methods_beside(demos),
    }
    for name, content in sections.items():
        text = Marks(name).filled(text, content)
    return text


def studied(demos: Path, case: str, study: str, columns: Mapping[str, tuple[str, int]]) -> str:
    """A table of a study's runs with both methods."""
    lines = []
    for method in METHODS:
        path = demos / f"{case}_{method}" / "results" / f"{study}.csv"
        if path.is_file():
            lines += [line(method, row, columns) for row in rows_of(path)]
    if not lines:
        return NOTHING
    heads = ["Method", "Run", *(label for label, _ in columns.values())]
    return "\n".join([f"| {' | '.join(heads)} |", "|---" * len(heads) + "|", *lines])


def line(method: str, row: Mapping[str, str], columns: Mapping[str, tuple[str, int]]) -> str:
    """One line of a study's table."""
    cells = [method, row["run"].replace("_", " ")]
    cells += [cell(name, row[name], decimals) for name, (_, decimals) in columns.items()]
    return "| " + " | ".join(cells) + " |"


def cell(name: str, text: str, decimals: int) -> str:
    """A figure with its decimals, a hundredfold where it is in per cent; a text as it is."""
    try:
        value = float(text)
    except ValueError:
        return ", ".join(text.split()) or "none"
    return f"{value * (100.0 if name in PERCENT else 1.0):.{decimals}f}"


def methods_beside(demos: Path) -> str:
    """The cut of AISI 4340 at rake 6 with the PFEM and with both kinds of SPH, as far as recorded."""
    summaries = {}
    for method, name in BESIDE.items():
        path = demos / name / "results" / "summary.json"
        if path.is_file():
            summaries[method] = json.loads(path.read_text(encoding="utf-8"))
    if not summaries:
        return NOTHING
    lines = [f"| Figure | {' | '.join(summaries)} |", "|---" * (len(summaries) + 1) + "|"]
    for name, (label, decimals) in CUT.items():
        shown = [figure(summary, name, decimals) for summary in summaries.values()]
        lines.append(f"| {label} | {' | '.join(shown)} |")
    for name, label in (("steps", "Steps, for particles batches of them"), ("wall_time", "Wall time (min)")):
        scale = 60.0 if name == "wall_time" else 1.0
        shown = [f"{summary[name]['value'] / scale:.0f}" for summary in summaries.values()]
        lines.append(f"| {label} | {' | '.join(shown)} |")
    return "\n".join(lines)


def figure(summary: Mapping[str, Mapping[str, float]], name: str, decimals: int) -> str:
    """Mean and deviation over the steady window."""
    found = summary.get(name)
    if not found or found.get("mean") is None:
        return "–"
    return f"{found['mean']:.{decimals}f} ± {found['std']:.{decimals}f}"


def rows_of(path: Path) -> Sequence[Mapping[str, str]]:
    """Rows of a table."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


if __name__ == "__main__":
    sys.exit(main())
