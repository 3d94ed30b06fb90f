"""What a convergence study found: ``convergence.csv`` and ``convergence.json`` beside the table of its runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pfemcut.converge.order import SMALLEST_ORDER, Behaviour
from pfemcut.converge.study import Finding, Refined
from pfemcut.output.directory import HISTORY
from pfemcut.output.tables import number_text, or_empty, print_table, write_csv
from pfemcut.results.definitions import FIGURES
from pfemcut.sweep.results import CSV, Outcome
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_history
from pfemcut.whole_files import finite, write_json

TABLE = "convergence.csv"
JSON = "convergence.json"

_ITEMS = {item.name: item for item in FIGURES}


def write_findings(study: Refined, outcomes: Sequence[Outcome], found: Sequence[Finding]) -> list[Path]:
    """Write both files into the study's folder; their paths and that of the table of runs."""
    output, levels = study.plan.output, len(study.ladders[0].factors)
    header = ["ladder", "figure", "unit", *(f"level_{index + 1}" for index in range(levels))]
    header += [f"level_{index + 1}_std" for index in range(levels)]
    header += ["behaviour", "observed_order", "grid_convergence_index", "extrapolated", "half_range"]
    rows: list[list[object]] = []
    for each in found:
        numbers = (*each.values, *each.deviations)
        said = each.convergence
        verdict = (said.order, said.index, said.extrapolated, said.half_range)
        rows.append(
            [
                each.ladder,
                each.figure,
                _ITEMS[each.figure].unit,
                *(or_empty(value) for value in numbers),
                said.behaviour.value,
                *(or_empty(value) for value in verdict),
            ]
        )
    write_csv(output / TABLE, header, rows)
    write_json(
        output / JSON,
        {
            "ratio": study.ratio,
            "ladders": [
                {
                    "name": ladder.name,
                    "factors": list(ladder.factors),
                    "runs": [variant.name for variant in ladder.variants],
                }
                for ladder in study.ladders
            ],
            "runs": {each.variant.name: _run(each) for each in outcomes},
            "findings": [_json(each) for each in found],
            "recorded": provenance(),
        },
    )
    return [output / TABLE, output / JSON, output / CSV]


def print_findings(study: Refined, outcomes: Sequence[Outcome], found: Sequence[Finding]) -> None:
    """Print the levels, and what they say of the figures that were asked for."""
    print_table(f"{study.plan.output}", *_level_rows(study, outcomes), texts=2)
    for ladder in study.ladders:
        header = ["figure", "unit", *(f"{factor:.3g} ×" for factor in ladder.factors)]
        header += ["observed\norder", "grid conv.\nindex", "extra-\npolated", "behaviour"]
        rows = [
            _finding_row(each)
            for each in found
            if each.ladder == ladder.name and each.figure in study.plan.figures
        ]
        sizes = {"mesh": "all mesh sizes", "step": "time steps"}.get(ladder.name, "mesh sizes and time steps")
        print_table(f"{sizes} relative to the case's", header, rows, texts=2)


def behaviour_text(finding: Finding) -> str:
    """The verdict in words, with what must be known of the order."""
    said = finding.convergence
    if said.behaviour is Behaviour.MONOTONE and said.order < SMALLEST_ORDER:
        return f"{said.behaviour.value}, too slowly to extrapolate"
    if said.behaviour is Behaviour.OSCILLATING:
        return f"{said.behaviour.value}, half range {said.half_range:.1%}"
    return said.behaviour.value


def _level_rows(study: Refined, outcomes: Sequence[Outcome]) -> tuple[list[str], list[list[str]]]:
    by_name = {each.variant.name: each for each in outcomes}
    rows = []
    for ladder in study.ladders:
        for factor, variant in zip(ladder.factors, ladder.variants, strict=True):
            outcome = by_name[variant.name]
            run = _run(outcome)
            steady = "" if not outcome.summary or outcome.steady else ", not steady"
            numbers = (
                "" if run[key] is None else f"{run[key]:.0f}" for key in ("particles", "steps", "wall_time")
            )
            rows.append([ladder.name, variant.name, f"{factor:.3g}", *numbers, outcome.status + steady])
    return ["ladder", "run", "size", "particles", "steps", "wall time (s)", "status"], rows


def _finding_row(finding: Finding) -> list[str]:
    said, item = finding.convergence, _ITEMS[finding.figure]
    values = [
        (number_text(float(f"{value:.4g}")) or "–") + (f" ± {std:.1g}" if math.isfinite(std) else "")
        for value, std in zip(finding.values, finding.deviations, strict=True)
    ]
    order = f"{said.order:.2f}" if math.isfinite(said.order) else "–"
    index = f"{said.index:.2%}" if math.isfinite(said.index) else "–"
    limit = number_text(float(f"{said.extrapolated:.4g}")) or "–"
    unit = "" if item.unit == "-" else item.unit
    return [item.label, unit, *values, order, index, limit, behaviour_text(finding)]


def _run(outcome: Outcome) -> dict[str, Any]:
    directory, summary = outcome.variant.directory, outcome.summary
    nodes = list(read_history(directory).get("nodes", ())) if (directory / HISTORY).is_file() else []
    return {
        "changes": dict(outcome.variant.variant.values),
        "status": outcome.status,
        "steady": outcome.steady,
        "particles": int(nodes[-1]) if nodes else None,
        "steps": summary["steps"]["value"] if summary else None,
        "wall_time": summary["wall_time"]["value"] if summary else None,
    }


def _json(finding: Finding) -> dict[str, Any]:
    said = finding.convergence
    return {
        "ladder": finding.ladder,
        "figure": finding.figure,
        "unit": _ITEMS[finding.figure].unit,
        "values": [finite(value) for value in finding.values],
        "deviations": [finite(value) for value in finding.deviations],
        "behaviour": said.behaviour.value,
        "observed_order": finite(said.order),
        "grid_convergence_index": finite(said.index),
        "extrapolated": finite(said.extrapolated),
        "half_range": finite(said.half_range),
    }
