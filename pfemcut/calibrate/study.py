"""A calibration from its files to its report."""

from __future__ import annotations

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
from pfemcut.sweep.plan import Values
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
    for name, keys in (("--set", common), (str(measured_file), {k for changes in cuts for k in changes})):
        problems += [f"{name}: '{each.key}' is fitted" for each in parameters if each.key in keys]
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
        raise RunStopped(
            f"a run that the search needs did not finish, see {evaluate.folder(error.point)}: other bounds or another "
            "start may avoid it"
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
    for text in found.confidence.warnings:
        say(f"warning: {text}")
    changes = " ".join(f"--set {each.parameter.key}={each.value:g}" for each in found.confidence.estimates)
    say(f"fitted: {changes}")
    for name in (TABLE, JSON, PNG):
        say(str(study.output / name))
    return found
