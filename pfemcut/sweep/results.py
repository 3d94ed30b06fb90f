"""What a sweep found: one table of parameters and figures, ``results.csv``, and the same as ``results.json``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pfemcut.output.directory import HISTORY, SUMMARY
from pfemcut.output.tables import number_text, print_table, write_csv
from pfemcut.results.definitions import FIGURES
from pfemcut.results.summary import figure_mean, figure_std
from pfemcut.results.summary_file import NEEDED, required
from pfemcut.sweep.plan import Plan, short_keys, value_text
from pfemcut.sweep.prepare import Prepared, State, states
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_summary, sessions
from pfemcut.whole_files import write_json

CSV = "results.csv"
JSON = "results.json"

RUN_COLUMNS = ("status", "steady", "warnings", "travel", "steps", "wall_time")


@dataclass(frozen=True)
class Outcome:
    """What is known of a variant.

    Attributes
    ----------
    variant
        The variant.
    status
        ``finished``, ``stopped`` (its run ended before its end), ``not finished``, or ``of another case``.
    summary
        Content of its ``summary.json``; empty if there is none, or if it is of another case.
    """

    variant: Prepared
    status: str
    summary: Mapping[str, Any]

    @property
    def finished(self) -> bool:
        """Whether its figures are those of its case."""
        return self.status == State.FINISHED.value

    @property
    def steady(self) -> bool:
        """Whether its cut was steady in the window."""
        return bool(self.summary.get("steady", {}).get("value", False))

    def mean(self, name: str) -> float:
        """Window mean, or last value, of a figure; nan without one."""
        return figure_mean(self.summary, name)

    def std(self, name: str) -> float:
        """Standard deviation of a figure over the window; nan without one."""
        return figure_std(self.summary, name)


def outcomes_of(variants: Sequence[Prepared]) -> tuple[Outcome, ...]:
    """What the variants' folders hold."""
    return tuple(_outcome(variant, state) for variant, state in zip(variants, states(variants), strict=True))


def _outcome(variant: Prepared, state: State) -> Outcome:
    path = variant.directory / SUMMARY
    if state is State.CHANGED:
        return Outcome(variant, state.value, {})
    summary = read_summary(variant.directory) if path.is_file() else {}
    if summary:
        required(summary, path, *NEEDED)
    if state is State.FINISHED:
        return Outcome(variant, state.value, summary)
    # A summary that is finished, of a run that is not, is that of a shorter travel.
    stopped = bool(summary) and not summary["finished"]
    return Outcome(variant, "stopped" if stopped else "not finished", summary if stopped else {})


def write_results(plan: Plan, outcomes: Sequence[Outcome]) -> None:
    """Write the table as CSV and JSON into the sweep's folder."""
    header, rows = table_of(plan, outcomes)
    write_csv(plan.output / CSV, header, rows)
    write_json(
        plan.output / JSON,
        {
            "parameters": list(plan.keys),
            "for_all": dict(plan.common),
            "units": {item.name: item.unit for item in _figures(outcomes)},
            "variants": [_json(outcome) for outcome in outcomes],
            "recorded": provenance(),
        },
    )


def table_of(plan: Plan, outcomes: Sequence[Outcome]) -> tuple[list[str], list[list[object]]]:
    """Header and rows: parameters, how the run ended, and of each figure mean and standard deviation."""
    figures = _figures(outcomes)
    scattered = {
        item.name for item in figures if any("std" in each.summary.get(item.name, {}) for each in outcomes)
    }
    header = ["variant", *plan.keys, *RUN_COLUMNS]
    for item in figures:
        header += [item.name, f"{item.name}_std"] if item.name in scattered else [item.name]
    rows: list[list[object]] = []
    for outcome in outcomes:
        summary = outcome.summary
        row: list[object] = [
            outcome.variant.name,
            *(_cell(value) for value in outcome.variant.parameters.values()),
            outcome.status,
            *(
                (
                    outcome.steady,
                    "; ".join(summary["warnings"]),
                    summary["travel"],
                    summary["steps"]["value"],
                    summary["wall_time"]["value"],
                )
                if summary
                else ("",) * (len(RUN_COLUMNS) - 1)
            ),
        ]
        for item in figures:
            values = [outcome.mean(item.name)]
            values += [outcome.std(item.name)] if item.name in scattered else []
            # Numbers as they stand in the summaries, bit for bit.
            row += [value if math.isfinite(value) else "" for value in values]
        rows.append(row)
    return header, rows


def print_results(plan: Plan, outcomes: Sequence[Outcome]) -> None:
    """Print parameters, status and the plotted figures."""
    short = short_keys(set(plan.keys))
    names = [name for name in plan.figures if any(name in each.summary for each in outcomes)]
    units = {item.name: item.unit for item in FIGURES}
    header = [*(short[key] for key in plan.keys), "status", "wall time"]
    header += [name.replace("_", " ") + ("" if units[name] == "-" else f"\n{units[name]}") for name in names]
    rows = []
    for each in outcomes:
        known = bool(each.summary)
        row = [_cell(value) for value in each.variant.parameters.values()]
        row.append(each.status + (", not steady" if known and not each.steady else ""))
        row += [f"{each.summary['wall_time']['value']:.0f} s" if known else ""]
        for name in names:
            mean, std = each.mean(name), each.std(name)
            row.append(number_text(float(f"{mean:.4g}")) + (f" ± {std:.2g}" if math.isfinite(std) else ""))
        rows.append(row)
    print_table(f"{plan.output}", header, rows)


def _figures(outcomes: Sequence[Outcome]) -> list[Any]:
    return [item for item in FIGURES if any(item.name in each.summary for each in outcomes)]


def _cell(value: Any) -> str:
    return "" if value is None else value_text(value)


def _json(outcome: Outcome) -> dict[str, Any]:
    summary, directory = outcome.summary, outcome.variant.directory
    content: dict[str, Any] = {
        "name": outcome.variant.name,
        "parameters": dict(outcome.variant.parameters),
        "status": outcome.status,
    }
    if summary:
        content |= {
            "ending": summary["ending"],
            "finished": summary["finished"],
            "steady": outcome.steady,
            "window": summary["window"],
            "travel": summary["travel"],
            "steps": summary["steps"]["value"],
            "wall_time": summary["wall_time"]["value"],
            "warnings": summary["warnings"],
            "figures": {item.name: summary[item.name] for item in FIGURES if item.name in summary},
        }
    if (directory / HISTORY).is_file():
        content["sessions"] = sessions(directory)
    return content
