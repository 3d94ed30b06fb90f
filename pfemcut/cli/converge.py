"""``pfemcut converge``: its options."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from pfemcut.cli.options import CaseFile, Jobs, jobs_at_a_time, names_in
from pfemcut.cli.speech import say
from pfemcut.converge.refinement import What
from pfemcut.inputs import InputError, nearest


def converge(
    case_file: CaseFile,
    what: Annotated[
        What,
        typer.Option(
            "--what",
            help="Refine the mesh, the step, both (a ladder each), or both together (one ladder).",
        ),
    ] = What.MESH,
    ratio: Annotated[
        float, typer.Option("--ratio", metavar="R", help="Ratio of the sizes of neighbouring levels.")
    ] = math.sqrt(2.0),
    levels: Annotated[int, typer.Option("--levels", metavar="N", help="Number of levels.")] = 3,
    finer: Annotated[
        int,
        typer.Option("--finer", metavar="K", help="Levels finer than the case; the others are coarser."),
    ] = 0,
    overrides: Annotated[
        list[str],
        typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Override one value on all levels."),
    ] = [],  # noqa: B006 (typer copies it)
    figures: Annotated[
        str, typer.Option("--figures", metavar="NAME,NAME,...", help="Figures to print and plot.")
    ] = "",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder of the levels' folders.")
    ] = None,
    jobs: Jobs = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Run levels whose case changed again from the start.")
    ] = False,
    listing: Annotated[
        bool, typer.Option("--list", "--dry-run", help="Validate and list the levels; run nothing.")
    ] = False,
    collect: Annotated[bool, typer.Option("--collect", help="Run nothing; write tables and plot.")] = False,
) -> None:
    """Refine mesh or step level by level: observed order and grid convergence index of each figure.

    The case itself is the finest level unless --finer is given. Called again, it skips what is finished.
    """
    if listing and collect:
        raise InputError(["--list and --collect exclude each other"])
    from pfemcut.converge.study import conclude, planned, run_study
    from pfemcut.results.definitions import FIGURES
    from pfemcut.sweep.prepare import prepared
    from pfemcut.sweep.results import outcomes_of
    from pfemcut.sweep.run import listed
    from pfemcut.sweep.study_file import MAIN_FIGURES, settings_of

    known = {item.name for item in FIGURES}
    wanted = names_in(figures) or list(MAIN_FIGURES)
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise InputError(f"--figures: unknown '{name}'{nearest(name, known)}" for name in unknown)
    study = planned(
        case_file,
        output or Path("out") / f"{case_file.stem}_converge",
        what=what,
        ratio=ratio,
        levels=levels,
        finer=finer,
        common=settings_of(overrides),
        figures=wanted,
    )
    if listing:
        for line in listed(prepared(study.plan)):
            say(line)
    elif collect:
        conclude(study, outcomes_of(prepared(study.plan)), say)
    else:
        run_study(study, jobs_at_a_time(jobs), overwrite=overwrite, say=say)
