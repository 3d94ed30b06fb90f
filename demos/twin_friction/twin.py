"""Forces computed with a known friction, which a calibration then recovers from them: an experiment with itself.

    python demos/twin_friction/twin.py [-o DIR] [--resume | --overwrite] [--travel MM] [-j N]

A cut is computed with friction 0.3, and its figures written as measurements with an uncertainty of 2 %. The calibration
begins at 0.1, that of case.toml. It must come back to 0.3 within its interval.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from pfemcut.calibrate.cuts import RUNS
from pfemcut.calibrate.fit import Controls
from pfemcut.calibrate.study import JSON, PNG, TABLE, planned, run_calibration
from pfemcut.cli.speech import say
from pfemcut.output.tables import write_csv
from pfemcut.results.published import KNOWN
from pfemcut.sweep.plan import Plan, Values, Variant
from pfemcut.sweep.results import outcomes_of
from pfemcut.sweep.run import require_finished, run_variants
from pfemcut.validation.options import exit_with, parser, start_of
from pfemcut.validation.small_files import copy_picture

FOLDER = Path(__file__).resolve().parent
TRUE = 0.3
UNCERTAINTY = 0.02
DEPTHS = (0.1,)
FIGURES = ("cutting_force", "thrust_force", "contact_length")
BOUNDS = "contact.friction=0.05:0.6"


def measure(output: Path, common: Values, jobs: int, *, overwrite: bool) -> Path:
    """Compute the cuts with the true friction; the file of their figures."""
    variants = tuple(
        Variant(f"depth={depth:g}", {"contact.friction": TRUE, "cutting.depth": depth}) for depth in DEPTHS
    )
    plan = Plan(FOLDER / "case.toml", output / "truth", common, variants, FIGURES)
    outcomes = outcomes_of(run_variants(plan, jobs, overwrite=overwrite, say=say))
    require_finished(outcomes)
    rows = []
    for depth, outcome in zip(DEPTHS, outcomes, strict=True):
        for name in FIGURES:
            value = outcome.mean(name)
            rows.append([name, f"{value:.6g}", f"{UNCERTAINTY * value:.3g}", KNOWN[name].unit, "twin", depth])
    path = output / "measured.csv"
    write_csv(path, ["figure", "value", "uncertainty", "unit", "source", "cutting.depth"], rows)
    return path


def work(arguments: Sequence[str]) -> bool:
    options_parser = parser("Recovers a known friction from computed forces.", FOLDER / "out")
    options_parser.add_argument("-j", "--jobs", type=int, default=1, metavar="N", help="runs at a time")
    options = options_parser.parse_args(arguments)
    overwrite, output = start_of(options).overwrite, options.output
    if overwrite:
        shutil.rmtree(output / RUNS, ignore_errors=True)
        shutil.rmtree(output / "truth", ignore_errors=True)
    common = {} if options.travel is None else {"cutting.travel": options.travel}
    measured = measure(output, common, options.jobs, overwrite=overwrite)
    study = planned(
        FOLDER / "case.toml",
        measured,
        output,
        fit=[BOUNDS],
        common=common,
        uncertainty=None,
        controls=Controls(),
    )
    found = run_calibration(study, options.jobs, overwrite=overwrite, say=say)
    results = FOLDER / "results" if options.travel is None else output / "results"
    results.mkdir(exist_ok=True)
    for name in ("measured.csv", TABLE, JSON, "evaluations.csv"):
        shutil.copyfile(output / name, results / name)
    copy_picture(output / PNG, results / PNG)
    (friction,) = found.confidence.estimates
    return friction.low <= TRUE <= friction.high


if __name__ == "__main__":
    exit_with(work)
