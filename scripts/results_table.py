"""Fills the README's table of published and computed figures from demos/*/results/comparison.json.

python scripts/results_table.py [README.md]
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pfemcut.results.published import Row, Verdict, computed_text, published_text
from pfemcut.validation.marked_page import Marks
from pfemcut.whole_files import write_text

ROOT = Path(__file__).resolve().parent.parent
MARKS = Marks("results")
HEAD = ("| Case | Figure | Published | Computed | Difference | Target |", "|---|---|---|---|---|---|")
SHOWN = {
    Verdict.WITHIN: "met",
    Verdict.OUTSIDE: "**missed**",
    Verdict.NO_TARGET: "",
    Verdict.NOT_COMPUTED: "not computed",
}


def main(arguments: Sequence[str]) -> int:
    """Fill the table; the exit status."""
    readme = Path(arguments[0]) if arguments else ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    if text.count(MARKS.begin) != 1 or text.count(MARKS.end) != 1:
        print(f"{readme}: needs the lines {MARKS.begin} and {MARKS.end}, once each", file=sys.stderr)
        return 2
    filled_text = MARKS.filled(text, table(ROOT / "demos"))
    if filled_text != text:
        write_text(readme, filled_text)
    return 0


def table(demos: Path) -> str:
    """The table of all demos with published figures, and below it how each run went."""
    lines, notes = list(HEAD), []
    for folder in sorted(path.parent for path in demos.glob("*/published.toml")):
        link = f"[{folder.name}](demos/{folder.name})"
        comparison = folder / "results" / "comparison.json"
        if not comparison.exists():
            lines.append(f"| {link} | no full run has been recorded yet | | | | |")
            continue
        content = json.loads(comparison.read_text(encoding="utf-8"))
        for number, figure in enumerate(content["figures"]):
            row = Row(**{**figure, "verdict": Verdict(figure["verdict"])})
            difference = "" if row.difference is None else f"{row.difference:+.1%}"
            cells = (
                link if number == 0 else "",
                row.label,
                published_text(row) or "–",
                computed_text(row) or "–",
                difference,
                SHOWN[row.verdict],
            )
            lines.append("| " + " | ".join(cells) + " |")
        notes.append(note(folder.name, content))
    return "\n".join([*lines, *([""] if notes else []), *notes])


def note(name: str, content: Mapping[str, Any]) -> str:
    """One line on how a run went."""
    checks = ", ".join(f"{key.replace('_', ' ')} {value:.1g}" for key, value in content["checks"].items())
    commits = ", ".join(dict.fromkeys(session["commit"] for session in content["sessions"])) or "not noted"
    minutes = f"{content['wall_time'] / 60.0:.0f} min"
    if content["travel"] == 0.0:
        return f"- `{name}`: {minutes}; {checks}; commit {commits}."
    return (
        f"- `{name}`: {content['travel']:.3g} mm in {content['steps']} steps and {minutes} "
        f"({'steady' if content['steady'] else 'not steady'}); {checks}; commit {commits}."
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
