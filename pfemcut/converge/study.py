"""A convergence study from a case file to table and plot; its runs are those of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pfemcut.converge.order import Convergence, convergence_of
from pfemcut.converge.refinement import CASE, Ladder, What, ladders_of
from pfemcut.inputs import InputError
from pfemcut.output.directory import writing
from pfemcut.results.definitions import FIGURES
from pfemcut.sweep.plan import Plan, Values, Variant
from pfemcut.sweep.prepare import prepared
from pfemcut.sweep.results import Outcome, outcomes_of, write_results
from pfemcut.sweep.run import Say, require_finished, run_variants

ADVISED_RATIO = 1.3
"""Celik et al. (2008) advise a ratio of at least this, from experience."""
LEAST_LEVELS = 3


@dataclass(frozen=True)
class Refined:
    """A convergence study.

    Attributes
    ----------
    plan
        Its runs.
    ladders
        Their order.
    ratio
        Of the sizes of neighbouring levels.
    """

    plan: Plan
    ladders: tuple[Ladder, ...]
    ratio: float


@dataclass(frozen=True)
class Finding:
    """What a ladder says of a figure.

    Attributes
    ----------
    ladder, figure
        Their names.
    values, deviations
        From the coarsest level to the finest: means and standard deviations over the window; nan where there is none.
    convergence
        What the three finest say.
    """

    ladder: str
    figure: str
    values: tuple[float, ...]
    deviations: tuple[float, ...]
    convergence: Convergence


def planned(
    case_file: Path,
    output: Path,
    *,
    what: What,
    ratio: float,
    levels: int,
    finer: int,
    common: Values,
    figures: Sequence[str],
) -> Refined:
    """The study of a case; see :func:`pfemcut.converge.refinement.ladders_of`.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    problems = []
    if not ratio > 1.0:
        problems.append(f"--ratio: given {ratio:g}, must be greater than 1")
    if levels < LEAST_LEVELS:
        problems.append(f"--levels: given {levels}, must be at least {LEAST_LEVELS}: fewer show no order")
    if not 0 <= finer < levels:
        problems.append(f"--finer: given {finer}, must be from 0 to {levels - 1}, below --levels")
    if problems:
        raise InputError(problems)
    # The sizes to scale are those of the case with what holds for all variants.
    base = Plan(case_file, output, common, (Variant(CASE, {}),), tuple(figures))
    (case,) = prepared(base)
    ladders = ladders_of(case.case, what, ratio, levels, finer)
    variants = {variant.name: variant for ladder in ladders for variant in ladder.variants}
    return Refined(replace(base, variants=tuple(variants.values())), ladders, ratio)


def run_study(study: Refined, jobs: int, *, overwrite: bool, say: Say) -> None:
    """Run what is not finished and conclude; see :func:`pfemcut.sweep.run.run_sweep`."""
    if study.ratio < ADVISED_RATIO:
        say(
            f"warning: a ratio of {study.ratio:g} is small: {ADVISED_RATIO:g} or more tells an order from noise"
        )
    conclude(study, outcomes_of(run_variants(study.plan, jobs, overwrite=overwrite, say=say)), say)


def conclude(study: Refined, outcomes: Sequence[Outcome], say: Say) -> None:
    """Write and print what is known; raises :class:`pfemcut.sweep.run.SweepStopped` if runs are missing."""
    from pfemcut.converge.plot import write_plot
    from pfemcut.converge.results import print_findings, write_findings

    found = findings(study, outcomes)
    with writing(study.plan.output):
        write_results(study.plan, outcomes)
        written = write_findings(study, outcomes, found)
        written += write_plot(study, found)
    print_findings(study, outcomes, found)
    for path in written:
        say(str(path))
    require_finished(outcomes)


def findings(study: Refined, outcomes: Sequence[Outcome]) -> tuple[Finding, ...]:
    """What the ladders say of each figure that a finished run has; runs that aren't finished give nothing."""
    by_name = {each.variant.name: each for each in outcomes if each.finished}
    known = [item.name for item in FIGURES if any(item.name in each.summary for each in by_name.values())]
    return tuple(_finding(ladder, name, by_name, study.ratio) for ladder in study.ladders for name in known)


def _finding(ladder: Ladder, name: str, by_name: Mapping[str, Outcome], ratio: float) -> Finding:
    runs = [by_name.get(variant.name) for variant in ladder.variants]
    values = tuple(float("nan") if run is None else run.mean(name) for run in runs)
    deviations = tuple(float("nan") if run is None else run.std(name) for run in runs)
    return Finding(ladder.name, name, values, deviations, convergence_of(values, deviations, ratio))
