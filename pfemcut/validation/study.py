"""Studies: a few variants of one case side by side, each run resumable, concluded in small tables and plots."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.inputs import InputError, UserError, nearest
from pfemcut.method import RunStopped
from pfemcut.output.tables import number_text, print_table, write_csv
from pfemcut.ranks import Ranks
from pfemcut.results.summary import figure_mean, figure_std
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.provenance import ROOT, provenance
from pfemcut.validation.recorded_run import (
    Start,
    is_finished,
    read_history,
    read_summary,
    recorded_run,
    sessions,
)
from pfemcut.whole_files import finite, write_json

REDUCED_CASE = ROOT / "demos" / "aisi4340_demo" / "case.toml"
"""The reduced block and coarse sizes that studies run on."""


@dataclass(frozen=True)
class Variant:
    """One run of a study.

    Attributes
    ----------
    name
        Its name, also its folder.
    changes
        What it changes in the case (``section.key=value``).
    travel
        mm; the study's unless given.
    """

    name: str
    changes: tuple[str, ...] = ()
    travel: float | None = None


@dataclass(frozen=True)
class Outcome:
    """What a variant's run left.

    Attributes
    ----------
    variant
        The variant.
    directory
        Its output directory.
    summary
        Content of ``summary.json``.
    history
        Columns of ``history.csv``.
    """

    variant: Variant
    directory: Path
    summary: Mapping[str, Any]
    history: Mapping[str, NDArray[np.float64]]

    def mean(self, name: str) -> float:
        """Window mean, or last value, of a figure; nan without one."""
        return figure_mean(self.summary, name)

    def std(self, name: str) -> float:
        """Standard deviation of a figure over the window; nan without one."""
        return figure_std(self.summary, name)


@dataclass(frozen=True)
class Study:
    """A study.

    Attributes
    ----------
    name
        Name of its files.
    folder
        Demo folder that it belongs to.
    variants
        What is run.
    conclude
        Writes tables and plots of the outcomes into a folder (with :attr:`name` in their names) and returns the
        content of the study's JSON file and whether what the study must show is shown.
    travel
        mm; None if the case is no cut.
    case
        Case file that the variants change; the reduced cut of AISI 4340 unless given.
    partial
        Whether the runs that are finished are enough to conclude from; the others are then left out.
    """

    name: str
    folder: Path
    variants: tuple[Variant, ...]
    conclude: Callable[[Sequence[Outcome], Path], tuple[dict[str, Any], bool]]
    travel: float | None
    case: Path = REDUCED_CASE
    partial: bool = False


def main(study: Study) -> None:
    """Run a study with the options of the command line, and exit."""
    exit_with(lambda arguments: run_study(study, arguments))


def run_study(study: Study, arguments: Sequence[str]) -> bool:
    """Run the variants one after another and conclude; whether what the study must show is shown."""
    options_parser = parser(
        f"Study '{study.name}' of {study.folder.name}.", study.folder / f"out_{study.name}"
    )
    options_parser.add_argument(
        "--only",
        action="append",
        metavar="NAME",
        help="run this variant only, without conclusions (repeat at will): "
        + ", ".join(variant.name for variant in study.variants),
    )
    options_parser.add_argument(
        "--conclude", action="store_true", help="run nothing: conclude from the runs that are there"
    )
    options = options_parser.parse_args(arguments)
    if study.travel is None and options.travel is not None:
        raise UserError("--travel: this study is of no cut")
    start, output = start_of(options), options.output
    wanted = _wanted(study, options.only)
    for variant in () if options.conclude else wanted:
        planned = study.travel if variant.travel is None else variant.travel
        travel = planned if options.travel is None else options.travel
        _run(study.case, variant, output / variant.name, travel, start)
    if options.only:
        return True

    def conclude() -> bool:
        outcomes = [
            _outcome(variant, output / variant.name)
            for variant in study.variants
            if not study.partial or is_finished(output / variant.name)
        ]
        results = study.folder / "results" if options.travel is None else output / "results"
        results.mkdir(parents=True, exist_ok=True)
        content, shown = study.conclude(outcomes, results)
        write_json(
            results / f"{study.name}.json",
            {
                **content,
                "shown": shown,
                "runs": {
                    outcome.variant.name: {
                        "changes": list(outcome.variant.changes),
                        "ending": outcome.summary["ending"],
                        "steady": outcome.summary["steady"]["value"],
                        "travel": outcome.summary["travel"],
                        "steps": outcome.summary["steps"]["value"],
                        "wall_time": outcome.summary["wall_time"]["value"],
                        "warnings": outcome.summary["warnings"],
                        "sessions": sessions(outcome.directory),
                    }
                    for outcome in outcomes
                },
                "recorded": provenance(),
            },
        )
        print(f"results  {results}")
        return shown

    return Ranks().on_first(conclude)


def write_table(path: Path, title: str, header: Sequence[str], rows: Sequence[Sequence[str | float]]) -> None:
    """Write the rows as CSV (numbers to five digits, nothing for nan) and print them."""
    texts = [[number_text(value) for value in row] for row in rows]
    write_csv(path, header, texts)
    # Many columns don't fit into a terminal: there the runs stand side by side.
    lines = [list(header), *texts]
    shown = [list(line) for line in zip(*lines, strict=True)] if len(header) > len(texts) + 1 else lines
    print_table(title, shown[0], shown[1:])


def finite_figures(
    header: Sequence[str], rows: Sequence[Sequence[str | float]]
) -> dict[str, dict[str, float | None]]:
    """The figures of a table by run and name: its numbers that are floats, None for those that are not finite."""
    return {
        str(row[0]): {
            name: finite(value)
            for name, value in zip(header[1:], row[1:], strict=True)
            if isinstance(value, float)
        }
        for row in rows
    }


def _wanted(study: Study, names: Sequence[str] | None) -> Sequence[Variant]:
    known = {variant.name: variant for variant in study.variants}
    unknown = [name for name in names or () if name not in known]
    if unknown:
        raise InputError([f"--only: unknown variant '{name}'{nearest(name, known)}" for name in unknown])
    return [known[name] for name in names] if names else study.variants


def _run(case: Path, variant: Variant, directory: Path, travel: float | None, start: Start) -> None:
    if Ranks().first:
        print(f"-- {variant.name}", flush=True)
    # The study concludes from all variants, so one that stops is reported there and does not end the others.
    try:
        travelled = [] if travel is None else [f"cutting.travel={travel}"]
        recorded_run(case, directory, [*travelled, *variant.changes], start)
    except RunStopped as stopped:
        from pfemcut.driver import RunInterrupted

        if isinstance(stopped, RunInterrupted):
            raise
        if Ranks().first:
            print(f"{variant.name}: run stopped: {stopped}", flush=True)


def _outcome(variant: Variant, directory: Path) -> Outcome:
    return Outcome(variant, directory, read_summary(directory), read_history(directory))
