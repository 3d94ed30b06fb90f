"""``pfemcut sweep``: its options, and what it prints."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pfemcut.cli.options import Jobs, jobs_at_a_time
from pfemcut.cli.speech import say
from pfemcut.cli.table import result_lines
from pfemcut.inputs import InputError


def sweep(
    file: Annotated[
        Path, typer.Argument(metavar="FILE.toml", help="Sweep file, or case file.", show_default=False)
    ],
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary", metavar="SECTION.KEY=V,V,...", help="Values of one key; all combinations if repeated."
        ),
    ] = [],  # noqa: B006 (typer copies it)
    zipped: Annotated[
        list[str],
        typer.Option(
            "--zip", metavar="SECTION.KEY=V,V,...", help="Values that go together with those of other --zip."
        ),
    ] = [],  # noqa: B006
    overrides: Annotated[
        list[str],
        typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Override one value in all variants."),
    ] = [],  # noqa: B006
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder of the variants' folders.")
    ] = None,
    jobs: Jobs = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Run variants whose case changed again from the start.")
    ] = False,
    listing: Annotated[
        bool, typer.Option("--list", "--dry-run", help="Validate and list the variants; run nothing.")
    ] = False,
    only: Annotated[
        str | None, typer.Option("--only", metavar="NAME", help="Run this variant only, without table.")
    ] = None,
    index: Annotated[
        int | None, typer.Option("--index", metavar="K", help="The same by its number in the list, from 0.")
    ] = None,
    collect: Annotated[bool, typer.Option("--collect", help="Run nothing; write table and plot.")] = False,
) -> None:
    """Run variants of a case side by side, then write one table and one plot.

    Called again, it skips what is finished and goes on with what was interrupted.
    """
    if sum((listing, collect, only is not None, index is not None)) > 1:
        raise InputError(["--list, --only, --index and --collect exclude each other"])
    from pfemcut.sweep import run
    from pfemcut.sweep.prepare import prepared
    from pfemcut.sweep.study_file import read_plan

    plan = read_plan(file, vary=vary, zipped=zipped, common=overrides, output=output)
    if listing:
        for line in run.listed(prepared(plan)):
            say(line)
    elif collect:
        run.collect(plan, say)
    elif only is not None or index is not None:
        variant = run.chosen(prepared(plan), only, index)
        summary = run.run_one(variant, overwrite=overwrite, say=say)
        if summary is None:
            return
        for line in result_lines(summary):
            say(line)
        if not summary.finished:
            raise typer.Exit(1)
    else:
        run.run_sweep(plan, jobs_at_a_time(jobs), overwrite=overwrite, say=say)
