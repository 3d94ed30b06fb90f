"""A calibration from its files to its report."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pfemcut.calibrate.confidence import Confidence, confidence_of
from pfemcut.calibrate.cuts import Cuts, Target, own_values, targets_of
from pfemcut.calibrate.fit import Controls, Fit, NotComputed, fitted
from pfemcut.calibrate.parameters import Parameter, read_parameters, started
from pfemcut.inputs import InputError
from pfemcut.method import RunStopped
from pfemcut.output.directory import writing
from pfemcut.results.measured import load_measured
from pfemcut.sweep.plan import Values, value_text
from pfemcut.sweep.results import Outcome
from pfemcut.sweep.run import Say

TABLE = "calibration.csv"
JSON = "calibration.json"
PNG = "calibration.png"


@dataclass(frozen=True)
class Calibration:
    """What is fitted to what.

    Attributes
    ----------
    case_file, output
        The case, and the folder of the calibration.
    common
        What all runs change in the case.
    parameters
        The parameters, with their starts.
    targets, cuts
        Measured figures, and what their cuts change in the case.
    assumed
        Whether uncertainties were not measured but assumed.
    controls
        How to search.
    """

    case_file: Path
    output: Path
    common: Values
    parameters: tuple[Parameter, ...]
    targets: tuple[Target, ...]
    cuts: tuple[Values, ...]
    assumed: bool
    controls: Controls


@dataclass(frozen=True)
class Found:
    """What was found: the fit, what is known of it, the runs at its end, and how many points were computed."""

    fit: Fit
    confidence: Confidence
    runs: tuple[Outcome, ...]
    points: int

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a user of the parameters must know: of the fit, and of the runs whose figures were fitted."""
        return (*self.confidence.warnings, *(text for run in self.runs for text in warnings_of(run)))


def planned(
    case_file: Path,
    measured_file: Path,
    output: Path,
    *,
    fit: Sequence[str],
    common: Values,
    uncertainty: float | None,
    controls: Controls,
) -> Calibration:
    """The calibration of a case with a file of measured figures, all of it validated.

    Parameters
    ----------
    case_file, measured_file, output
        Case, measured figures or curve, and the folder to work in.
    fit
        See :func:`pfemcut.calibrate.parameters.read_parameters`.
    common
        What all runs change in the case.
    uncertainty
        Relative uncertainty of figures that have none; None if all must have theirs.
    controls
        How to search.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    parameters = read_parameters(fit)
    measured = load_measured(measured_file).figures
    unknown = [each for each in measured if not each.uncertainty > 0.0]
    if unknown and uncertainty is None:
        names = ", ".join(dict.fromkeys(each.name for each in unknown))
        raise InputError(
            [
                f"{measured_file}: no uncertainty of {names}: add it, or give --uncertainty 0.05 (of each value)"
            ]
        )
    figures = [
        replace(each, uncertainty=abs((uncertainty or 0.0) * each.value)) if each in unknown else each
        for each in measured
    ]
    problems = [
        f"{measured_file}: {each.name} is zero: it needs an uncertainty of its own"
        for each in figures
        if not each.uncertainty > 0.0
    ]
    targets, cuts = targets_of(figures)
    if len(targets) < len(parameters):
        problems.append(f"{len(targets)} measured figures can't determine {len(parameters)} parameters")
    of_cuts = dict.fromkeys(key for changes in cuts for key in changes)
    for name, keys in (("--set", common), (str(measured_file), of_cuts)):
        problems += [
            f"{name}: '{key}' is fitted, by '{each.key}'" if key != each.key else f"{name}: '{key}' is fitted"
            for each in parameters
            for key in keys
            if within(key, each.key)
        ]
    problems += [
        f"--set: '{key}' would have no effect: {measured_file} gives '{other}' for its cuts"
        for other in of_cuts
        for key in common
        if within(key, other)
    ]
    if problems:
        raise InputError(problems)
    values = own_values(case_file, output, common, parameters)
    return Calibration(
        case_file,
        output,
        common,
        started(parameters, values),
        targets,
        cuts,
        bool(unknown),
        controls,
    )


def calibrate(study: Calibration, evaluate: Cuts) -> Found:
    """Search the parameters.

    Raises
    ------
    RunStopped
        If runs are stopped by a signal, or a point that the search needs can't be computed.
    """
    measured = np.array([each.figure.value for each in study.targets])
    uncertainties = np.array([each.figure.uncertainty for each in study.targets])
    try:
        fit = fitted(study.parameters, measured, uncertainties, evaluate, study.controls)
    except NotComputed as error:
        folders = [str(each.variant.directory) for each in evaluate.last[error.point] if not each.finished]
        runs = "a run" if len(folders) == 1 else f"{len(folders)} runs"
        raise RunStopped(
            f"{runs} that the search needs did not finish, see {', '.join(folders)}: "
            "other bounds or another start may avoid it"
        ) from None
    known = confidence_of(
        fit,
        study.parameters,
        measured,
        uncertainties,
        study.controls.difference,
        assumed=study.assumed,
    )
    return Found(fit, known, evaluate.last[fit.point], len(evaluate.last))


def run_calibration(study: Calibration, jobs: int, *, overwrite: bool, say: Say) -> Found:
    """Run the calibration and write its report; parameters and errors as of :func:`pfemcut.sweep.run.run_sweep`."""
    evaluate = Cuts(
        study.case_file,
        study.output,
        study.common,
        study.parameters,
        study.targets,
        study.cuts,
        jobs=jobs,
        overwrite=overwrite,
        say=say,
    )
    # All cuts at the start and at both ends, so that a wrong one stops the calibration before hours of computing.
    evaluate.prepared(
        [tuple(getattr(each, name) for each in study.parameters) for name in ("start", "low", "high")]
    )
    found = calibrate(study, evaluate)
    # Not before it's needed: matplotlib takes a second to load.
    from pfemcut.calibrate.plot import write_plot
    from pfemcut.calibrate.results import print_found, write_found

    with writing(study.output):
        write_found(study, found)
        write_plot(study.output / PNG, study, found)
    print_found(study, found)
    for text in found.warnings:
        say(f"warning: {text}")
    for name in (TABLE, JSON, PNG):
        say(str(study.output / name))
    say(run_command(study, found))
    return found


def run_command(study: Calibration, found: Found) -> str:
    """The command that runs the case with the fitted parameters."""
    fitted = {each.parameter.key: each.value for each in found.confidence.estimates}
    values = [f"{key}={value_text(value)}" for key, value in {**study.common, **fitted}.items()]
    options = [word for value in values for word in ("--set", value)]
    return shlex.join(["pfemcut", "run", str(study.case_file), *options])


def warnings_of(run: Outcome) -> list[str]:
    """What a run's summary warns of, and if its cut was not steady; with the run's name."""
    texts = list(map(str, run.summary["warnings"]))
    if not run.steady and not any("not steady" in text for text in texts):
        texts.insert(0, "not steady")
    return [f"{run.variant.name}: {text}" for text in texts]


def within(key: str, other: str) -> bool:
    """Whether a value at ``other`` replaces that at ``key``: they are the same, or ``key`` lies in it."""
    return f"{key}.".startswith(f"{other}.")
