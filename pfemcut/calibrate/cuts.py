"""Computes the measured figures at points of the parameters: runs of a sweep, one folder a point and cut.

Folders are named by the values that a run changes, and finished runs in them are taken as they are. So a calibration
that was interrupted goes on: the search repeats itself from what is there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pfemcut.calibrate.fit import Computed
from pfemcut.calibrate.parameters import Parameter
from pfemcut.inputs import InputError
from pfemcut.output.directory import writing
from pfemcut.output.tables import write_csv
from pfemcut.results.measured import MeasuredFigure, cuts_of
from pfemcut.sweep.plan import Plan, Values, Variant, name_of, short_keys
from pfemcut.sweep.prepare import Prepared, prepared, require_unchanged
from pfemcut.sweep.results import Outcome, outcomes_of
from pfemcut.sweep.run import Say, require_no_launcher, run_unfinished

RUNS = "runs"
EVALUATIONS = "evaluations.csv"


@dataclass(frozen=True)
class Target:
    """A measured figure in the order that the fit takes it.

    Attributes
    ----------
    figure
        The figure.
    cut
        Number of its cut.
    """

    figure: MeasuredFigure
    cut: int


def targets_of(figures: Sequence[MeasuredFigure]) -> tuple[tuple[Target, ...], tuple[Values, ...]]:
    """The figures cut by cut, and what each cut changes in the case."""
    cuts = cuts_of(figures)
    targets = tuple(Target(each, index) for index, (_, members) in enumerate(cuts) for each in members)
    return targets, tuple(changes for changes, _ in cuts)


class Cuts:
    """Evaluates points by runs.

    Parameters
    ----------
    case_file
        The case.
    output
        Folder of the calibration.
    common
        What all runs change in the case.
    parameters
        The parameters.
    targets, cuts
        From :func:`targets_of`.
    jobs
        Runs at a time.
    overwrite
        Whether runs whose case changed start anew.
    say
        Prints a line.
    """

    def __init__(
        self,
        case_file: Path,
        output: Path,
        common: Values,
        parameters: Sequence[Parameter],
        targets: Sequence[Target],
        cuts: Sequence[Values],
        *,
        jobs: int,
        overwrite: bool,
        say: Say,
    ) -> None:
        self._plan = Plan(case_file, output / RUNS, common, (), ())
        self._parameters, self._targets, self._cuts = tuple(parameters), tuple(targets), tuple(cuts)
        self._jobs, self._overwrite, self._say = jobs, overwrite, say
        self._short = short_keys(
            {each.key for each in parameters} | {key for changes in cuts for key in changes}
        )
        self._rows: list[list[object]] = []
        self.last: dict[tuple[float, ...], tuple[Outcome, ...]] = {}

    def prepared(self, points: Sequence[tuple[float, ...]]) -> tuple[Prepared, ...]:
        """The runs of the points, validated, point by point and cut by cut.

        Raises
        ------
        InputError
            With one line for each problem found.
        """
        variants = [self._variant(point, changes) for point in points for changes in self._cuts]
        return prepared(replace(self._plan, variants=tuple(variants)))

    def __call__(self, points: Sequence[tuple[float, ...]]) -> list[Computed]:
        """Figures at the points; nan where a run could not go to its end."""
        require_no_launcher()
        variants = self.prepared(points)
        if not self._overwrite:
            require_unchanged(variants)
        run_unfinished(variants, self._jobs, overwrite=self._overwrite)
        outcomes = outcomes_of(variants)
        count = len(self._cuts)
        found = []
        for index, point in enumerate(points):
            own = outcomes[index * count : (index + 1) * count]
            self.last[point] = own
            found.append(self._computed(own))
            self._note(point, found[-1], own)
        return found

    def _variant(self, point: tuple[float, ...], changes: Values) -> Variant:
        fitted = dict(zip((each.key for each in self._parameters), point, strict=True))
        # The cut's values first: one of them may be the material in which a parameter is fitted.
        return Variant(name_of({**fitted, **changes}, self._short), {**changes, **fitted})

    def _computed(self, outcomes: Sequence[Outcome]) -> Computed:
        runs = [outcomes[each.cut] for each in self._targets]
        values = [
            run.mean(each.figure.name) if run.finished else math.nan
            for run, each in zip(runs, self._targets, strict=True)
        ]
        deviations = [run.std(each.figure.name) for run, each in zip(runs, self._targets, strict=True)]
        missing = [
            f"{run.variant.directory}: its summary has no '{each.figure.name}', which was measured"
            for run, each, value in zip(runs, self._targets, values, strict=True)
            if run.finished and math.isnan(value)
        ]
        if missing:
            raise InputError(dict.fromkeys(missing))
        return Computed(np.array(values), np.array(deviations))

    def _note(self, point: tuple[float, ...], computed: Computed, outcomes: Sequence[Outcome]) -> None:
        """Print the point and add it to the table of evaluations."""
        measured = np.array([each.figure.value for each in self._targets])
        uncertainty = np.array([each.figure.uncertainty for each in self._targets])
        misfit = float(np.sum(((computed.values - measured) / uncertainty) ** 2))
        values = ", ".join(
            f"{self._short[each.key]} {value:g}" for each, value in zip(self._parameters, point, strict=True)
        )
        stopped = [each.variant.name for each in outcomes if not each.finished]
        text = f"misfit {misfit:.4g}" if not stopped else f"not computed: {', '.join(stopped)}"
        self._say(f"point {len(self._rows) + 1}: {values}: {text}")
        known = [value if math.isfinite(value) else "" for value in (misfit, *computed.values)]
        self._rows.append([*point, *known])
        header = [
            *(each.key for each in self._parameters),
            "misfit",
            *target_names(self._targets, self._cuts),
        ]
        path = self._plan.output.parent / EVALUATIONS
        with writing(path.parent):
            write_csv(path, header, self._rows)


def target_names(targets: Sequence[Target], cuts: Sequence[Values]) -> list[str]:
    """Name of each figure, with what its cut changes if there are several."""
    short = short_keys({key for changes in cuts for key in changes})
    return [
        each.figure.name + (f" {name_of(cuts[each.cut], short)}" if len(cuts) > 1 else "") for each in targets
    ]


def own_values(case_file: Path, output: Path, common: Values, parameters: Sequence[Parameter]) -> Values:
    """The case's own values of the parameters (None for what it hasn't), after validation at both ends of the bounds.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    probes = (
        Variant("without --fit", {}),
        Variant("at the lower bounds", {each.key: each.low for each in parameters}),
        Variant("at the upper bounds", {each.key: each.high for each in parameters}),
    )
    return prepared(Plan(case_file, output, common, probes, ()))[0].parameters
