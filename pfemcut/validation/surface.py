"""Runs a demo of what a cut leaves on the workpiece, and records small results beside it; nothing is compared."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from pfemcut.output.directory import FIGURES, INPUTS, RESIDUAL, SUMMARY
from pfemcut.ranks import Ranks
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.provenance import provenance
from pfemcut.validation.recorded_run import read_history, read_summary, recorded_run, sessions
from pfemcut.validation.small_files import copy_picture, write_thinned
from pfemcut.whole_files import write_json


def main(folder: Path) -> None:
    """Run the demo in ``folder`` with the options of the command line, and exit with 0 if it finished."""
    exit_with(lambda arguments: run_demo(folder, arguments))


def run_demo(folder: Path, arguments: Sequence[str]) -> bool:
    """Run and record; whether the run finished."""
    options = parser(f"Runs {folder.name} and records what it leaves.", folder / "out").parse_args(arguments)
    output = options.output
    overrides = [] if options.travel is None else [f"cutting.travel={options.travel}"]
    recorded_run(folder / "case.toml", output, overrides, start_of(options))

    def conclude() -> bool:
        results = output / "results" if overrides else folder / "results"
        record(output, results)
        print(f"results  {results}")
        return bool(read_summary(output)["finished"])

    return Ranks().on_first(conclude)


def record(output: Path, results: Path) -> None:
    """Write the small copies of a run's results, and where they come from."""
    results.mkdir(parents=True, exist_ok=True)
    for name in (SUMMARY, INPUTS, RESIDUAL):
        if (output / name).exists():
            shutil.copyfile(output / name, results / name)
    write_json(results / "origin.json", {"sessions": sessions(output), "recorded": provenance()})
    write_thinned(results / "history.csv", read_history(output))
    shutil.rmtree(results / FIGURES, ignore_errors=True)
    for picture in sorted((output / FIGURES).glob("*.png")):
        copy_picture(picture, results / FIGURES / picture.name)
