"""``pfemcut calibrate``: its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pfemcut.cli.options import CaseFile, Jobs, jobs_at_a_time
from pfemcut.cli.speech import say


def calibrate(
    case_file: CaseFile,
    measured: Annotated[
        Path,
        typer.Argument(
            metavar="MEASURED.csv", help="Measured figures, or a curve of forces.", show_default=False
        ),
    ],
    fit: Annotated[
        list[str],
        typer.Option(
            "--fit",
            metavar="SECTION.KEY=LOW:HIGH[:START],...",
            help="Parameters with their bounds, or a TOML file of them; repeat at will.",
        ),
    ] = [],  # noqa: B006 (typer copies it)
    overrides: Annotated[
        list[str],
        typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Override one value in all runs."),
    ] = [],  # noqa: B006
    uncertainty: Annotated[
        float | None,
        typer.Option(
            metavar="PART",
            help="Standard deviation of figures that have none, as a part of their value.",
        ),
    ] = None,
    difference: Annotated[
        float,
        typer.Option(
            metavar="PART",
            help="Step of the derivatives, as a part of the bounds' range: wide against the figures' noise.",
        ),
    ] = 0.05,
    central: Annotated[
        bool, typer.Option("--central", help="Differences to both sides: twice the runs, less error.")
    ] = False,
    tolerance: Annotated[
        float,
        typer.Option(metavar="PART", help="The search ends with steps below this part of the range."),
    ] = 2e-3,
    steps: Annotated[int, typer.Option(metavar="N", min=1, help="Steps of the search at most.")] = 20,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder of runs and report.")
    ] = None,
    jobs: Jobs = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Run points whose case changed again from the start.")
    ] = False,
) -> None:
    """Identify friction or material parameters from measured forces and other figures.

    Least squares within bounds; every point is a run in a folder of its own. Called again, it goes on from them.
    """
    from pfemcut.calibrate.fit import Controls
    from pfemcut.calibrate.study import planned, run_calibration
    from pfemcut.inputs import InputError
    from pfemcut.sweep.study_file import settings_of

    problems = [
        f"--{name}: given {value:g}, must be above 0 and at most {limit:g}"
        for name, value, limit in (
            ("difference", difference, 0.5),
            ("tolerance", tolerance, 0.5),
            ("uncertainty", 0.05 if uncertainty is None else uncertainty, 1.0),
        )
        if not 0.0 < value <= limit
    ]
    if problems:
        raise InputError(problems)
    study = planned(
        case_file,
        measured,
        output or Path("out") / f"{case_file.stem}_calibrate",
        fit=fit,
        common=settings_of(overrides),
        uncertainty=uncertainty,
        controls=Controls(difference, central, tolerance, steps),
    )
    run_calibration(study, jobs_at_a_time(jobs), overwrite=overwrite, say=say)
