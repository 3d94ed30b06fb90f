"""Figures of several sources side by side, with their differences from a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from pfemcut.compare.sources import Entry, Kind, Source
from pfemcut.inputs import InputError, nearest
from pfemcut.output.tables import or_empty, write_csv
from pfemcut.results.published import KNOWN
from pfemcut.whole_files import finite

SIGNIFICANT = 2.0
"""A difference of this many combined standard deviations or more is called significant."""
NOTHING = "–"


class Verdict(Enum):
    """What is said of a difference."""

    SIGNIFICANT = "differs"
    SCATTER = "within scatter"
    WITHIN = "within tolerance"
    OUTSIDE = "outside tolerance"
    UNKNOWN = ""


@dataclass(frozen=True)
class Difference:
    """Of a figure from the reference's.

    Attributes
    ----------
    relative
        (value − reference) / |reference|; nan where the reference is zero.
    deviations
        |value − reference| over the root of the sum of both squared spreads; nan where neither has a spread, and
        against a tolerance.
    verdict
        What follows.
    """

    relative: float
    deviations: float
    verdict: Verdict


@dataclass(frozen=True)
class Row:
    """One figure of all sources.

    Attributes
    ----------
    name, label, unit
        See :class:`pfemcut.results.definitions.Definition`.
    entries
        Of each source; None where it has no such figure.
    differences
        Of each source from the reference; None for the reference itself and where one of them has no such figure.
    """

    name: str
    label: str
    unit: str
    entries: tuple[Entry | None, ...]
    differences: tuple[Difference | None, ...]


@dataclass(frozen=True)
class Comparison:
    """Rows of figures, columns of sources, differences from the source number ``reference``."""

    sources: tuple[Source, ...]
    reference: int
    rows: tuple[Row, ...]


def compared(sources: Sequence[Source], reference: int, names: Sequence[str]) -> Comparison:
    """The comparison of the figures ``names``; those that no source has are left out."""
    rows = []
    for name in names:
        entries = tuple(source.entries.get(name) for source in sources)
        known = [entry for entry in entries if entry is not None]
        if not known:
            continue
        differences = tuple(
            None if index == reference else _difference(sources, reference, index, entries)
            for index in range(len(sources))
        )
        label = KNOWN[name].label if name in KNOWN else name.replace("_", " ")
        rows.append(Row(name, label, known[0].unit, entries, differences))
    return Comparison(tuple(sources), reference, tuple(rows))


def chosen_figures(sources: Sequence[Source], wanted: Sequence[str], always: Sequence[str]) -> list[str]:
    """Names of the figures to compare.

    Parameters
    ----------
    sources
        The sources.
    wanted
        Names that were asked for; ``all`` is every figure that is there, nothing the main ones.
    always
        The main ones, which come with all figures of published tables and measurements.

    Raises
    ------
    InputError
        If no source has a figure that was asked for.
    """
    there = dict.fromkeys([*KNOWN, *(name for source in sources for name in source.entries)])
    there = dict.fromkeys(name for name in there if any(name in source.entries for source in sources))
    if not wanted:
        given = {name for source in sources if source.kind is not Kind.RUN for name in source.entries}
        return [name for name in there if name in given or name in always]
    if "all" in wanted:
        return list(there)
    unknown = [name for name in wanted if name not in there]
    if unknown:
        raise InputError(f"--figures: no source has '{name}'{nearest(name, there)}" for name in unknown)
    return list(dict.fromkeys(wanted))


def _difference(
    sources: Sequence[Source], reference: int, index: int, entries: Sequence[Entry | None]
) -> Difference | None:
    one, other = entries[index], entries[reference]
    if one is None or other is None:
        return None
    change = one.value - other.value
    relative = change / abs(other.value) if other.value else math.nan
    tables = {
        each.spread
        for source, each in ((sources[index], one), (sources[reference], other))
        if source.kind is Kind.PUBLISHED
    }
    if tables:
        # A tolerance is no standard deviation: it says itself what is near enough.
        known = [tolerance for tolerance in tables if math.isfinite(tolerance)]
        if not known:
            return Difference(relative, math.nan, Verdict.UNKNOWN)
        return Difference(
            relative, math.nan, Verdict.WITHIN if abs(change) <= min(known) else Verdict.OUTSIDE
        )
    spread = math.hypot(*(each.spread for each in (one, other) if math.isfinite(each.spread)))
    if not spread:
        return Difference(relative, math.nan, Verdict.UNKNOWN)
    deviations = abs(change) / spread
    verdict = Verdict.SIGNIFICANT if deviations >= SIGNIFICANT else Verdict.SCATTER
    return Difference(relative, deviations, verdict)


def entry_text(entry: Entry | None) -> str:
    """``182.3 ± 0.4``, or a dash."""
    if entry is None:
        return NOTHING
    spread = f" ± {entry.spread:.2g}" if math.isfinite(entry.spread) else ""
    return f"{float(f'{entry.value:.4g}'):g}{spread}"


def difference_text(difference: Difference | None) -> str:
    """``+1.2 %, 3.4 std: differs``, or a dash."""
    if difference is None:
        return NOTHING
    parts = [f"{100.0 * difference.relative:+.1f} %" if math.isfinite(difference.relative) else NOTHING]
    if math.isfinite(difference.deviations):
        parts.append(f"{difference.deviations:.1f} std" if difference.deviations < 100.0 else "> 100 std")
    return ", ".join(parts) + (f": {difference.verdict.value}" if difference.verdict.value else "")


def text_table(comparison: Comparison) -> tuple[list[str], list[list[str]]]:
    """Header and rows for a reader: each source's figure, with its difference below."""
    header = ["figure", "unit"]
    for index, source in enumerate(comparison.sources):
        header.append(source.label + ("\nreference" if index == comparison.reference else ""))
    rows = []
    for row in comparison.rows:
        cells = [
            entry_text(entry) + ("" if difference is None else f"\n{difference_text(difference)}")
            for entry, difference in zip(row.entries, row.differences, strict=True)
        ]
        rows.append([row.label, "" if row.unit == "-" else row.unit, *cells])
    return header, rows


def markdown(comparison: Comparison) -> str:
    """The table in Markdown."""
    header, rows = text_table(comparison)

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", "<br>") for cell in cells) + " |"

    rule = "|" + "|".join([" --- ", " --- ", *(" ---: " for _ in comparison.sources)]) + "|"
    lines = [line(header), rule, *(line(row) for row in rows), ""]
    return "\n".join([*lines, *(f"- {text}" for text in notes_of(comparison)), ""])


def notes_of(comparison: Comparison) -> list[str]:
    """What the spreads mean, and what must be known of the sources."""
    kinds = {
        source.kind
        for source in comparison.sources
        if any(math.isfinite(entry.spread) for entry in source.entries.values())
    }
    notes = [
        f"± of a {kind.name.lower()} figure: {kind.value}"
        for kind in (Kind.PUBLISHED, Kind.MEASURED)
        if kind in kinds
    ]
    if Kind.RUN in kinds:
        notes.insert(0, f"± of a run: {Kind.RUN.value}; std: root of the sum of both squares")
    notes += [f"{source.label}: {text}" for source in comparison.sources for text in source.notes]
    return notes


def write_table(path: Path, comparison: Comparison) -> None:
    """Write the table as CSV: numbers as they are, a row a figure."""
    header = ["figure", "unit"]
    for index, source in enumerate(comparison.sources):
        header += [source.label, f"{source.label} spread"]
        if index != comparison.reference:
            header += [f"{source.label} {name}" for name in ("difference", "deviations", "verdict")]
    rows: list[list[object]] = []
    for row in comparison.rows:
        cells: list[object] = [row.name, row.unit]
        for index, (entry, difference) in enumerate(zip(row.entries, row.differences, strict=True)):
            cells += [NOTHING, ""] if entry is None else [entry.value, or_empty(entry.spread)]
            if index == comparison.reference:
                continue
            if difference is None:
                cells += ["", "", ""]
            else:
                cells += [
                    or_empty(difference.relative),
                    or_empty(difference.deviations),
                    difference.verdict.value,
                ]
        rows.append(cells)
    write_csv(path, header, rows)


def as_json(comparison: Comparison) -> dict[str, Any]:
    """The comparison as JSON, which has no nan."""
    return {
        "reference": comparison.sources[comparison.reference].label,
        "sources": [
            {"label": source.label, "kind": source.kind.name.lower(), "notes": list(source.notes)}
            for source in comparison.sources
        ],
        "figures": [
            {
                "name": row.name,
                "unit": row.unit,
                "values": [
                    None if entry is None else {"value": entry.value, "spread": finite(entry.spread)}
                    for entry in row.entries
                ],
                "differences": [
                    None
                    if each is None
                    else {
                        "relative": finite(each.relative),
                        "deviations": finite(each.deviations),
                        "verdict": each.verdict.value,
                    }
                    for each in row.differences
                ],
            }
            for row in comparison.rows
        ],
    }
