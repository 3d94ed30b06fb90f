"""Runs a demo's published case, compares it with ``published.toml`` and records small results beside it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from pfemcut.case.load import load_case
from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.method import Frame
from pfemcut.output.directory import FIGURES, INPUTS, SUMMARY
from pfemcut.output.vtu import read_collection, read_last_frame, write_collection
from pfemcut.ranks import Ranks
from pfemcut.results.derived.free_surface import FREE_SURFACE_TEMPERATURE, free_surface_temperature
from pfemcut.results.published import (
    ALWAYS_SHOWN,
    Row,
    compare,
    comparison_json,
    load_published,
    print_comparison,
)
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_history, read_summary, recorded_run, sessions
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.whole_files import write_json

OF_CUTS = frozenset(ALWAYS_SHOWN) - {"max_temperature"}
CHECKED = ("energy_error", "heat_error", "area_drift", "mass_drift")


def main(folder: Path) -> None:
    """Run the demo in ``folder`` with the options of the command line, and exit.

    The status is 0 if the run finished and every published figure with a tolerance is met.
    """
    exit_with(lambda arguments: run_demo(folder, arguments))


def run_demo(folder: Path, arguments: Sequence[str]) -> bool:
    """Run, compare and record; whether every target is met."""
    options_parser = parser(f"Runs {folder.name} and compares it with its paper.", folder / "out")
    options_parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="SECTION.KEY=VALUE",
        help="change the case, for trying (repeat at will): results then go to DIR/results instead of the demo's",
    )
    options = options_parser.parse_args(arguments)
    # Not after hours of computing: a mistake in the published figures stops here.
    published = load_published(folder / "published.toml")
    case_file, output = folder / "case.toml", options.output
    overrides = [*([] if options.travel is None else [f"cutting.travel={options.travel}"]), *options.set]
    recorded_run(case_file, output, overrides, start_of(options))

    def conclude() -> bool:
        rows = compare(published, figures_of(output, case_file))
        results = output / "results" if overrides else folder / "results"
        record(output, results, rows)
        print_comparison(folder.name, rows)
        print(f"results  {results}")
        return not any(row.failed for row in rows)

    return Ranks().on_first(conclude)


def figures_of(output: Path, case_file: Path) -> dict[str, Any]:
    """Content of ``summary.json``, and the figures that only a comparison asks for."""
    summary = read_summary(output)
    case, _ = load_case(case_file)
    if isinstance(case, SolidsCase):
        # No cut, so no figures of one.
        return {name: value for name, value in summary.items() if name not in OF_CUTS}
    if not isinstance(case, Case):
        return summary
    begin, end = (travel / case.cutting.speed for travel in summary["window"])
    found = np.array(
        [
            free_surface_temperature(frame, frame.tool[0], case.cutting.depth)
            for frame in frames_between(output, begin, end)
        ]
    )
    found = found[np.isfinite(found)]
    if found.size:
        item = FREE_SURFACE_TEMPERATURE
        summary[item.name] = {"mean": float(found.mean()), "std": float(found.std()), "unit": item.unit}
    return summary


def frames_between(output: Path, begin: float, end: float) -> Iterator[Frame]:
    """The frames of a run with times (s) from ``begin`` to ``end``."""
    entries = read_collection(output)
    tolerance = 1e-9 * max(end, 1e-12)
    steps = sorted({e.step for e in entries if begin - tolerance <= e.time <= end + tolerance})
    for step in steps:
        # The reader takes the last frame of a collection: give it one that ends here.
        chosen = [replace(e, file=str((output / e.file).resolve())) for e in entries if e.step == step]
        with TemporaryDirectory() as folder:
            write_collection(Path(folder), chosen)
            yield read_last_frame(Path(folder))


def record(output: Path, results: Path, rows: Sequence[Row]) -> None:
    """Write the comparison and the small copies of a run's results."""
    summary = read_summary(output)
    results.mkdir(parents=True, exist_ok=True)
    write_json(
        results / "comparison.json",
        {
            "title": summary["title"],
            "ending": summary["ending"],
            "finished": summary["finished"],
            "steady": summary["steady"]["value"],
            "window": summary["window"],
            "travel": summary["travel"],
            "steps": summary["steps"]["value"],
            "wall_time": summary["wall_time"]["value"],
            "checks": {name: summary[name]["value"] for name in CHECKED if name in summary},
            "warnings": summary["warnings"],
            "figures": comparison_json(rows),
            "sessions": sessions(output),
            "recorded": provenance(),
        },
    )
    shutil.copyfile(output / SUMMARY, results / SUMMARY)
    shutil.copyfile(output / INPUTS, results / INPUTS)
    write_thinned(results / "history.csv", read_history(output))
    shutil.rmtree(results / FIGURES, ignore_errors=True)
    for picture in sorted((output / FIGURES).glob("*.png")):
        copy_picture(picture, results / FIGURES / picture.name)
