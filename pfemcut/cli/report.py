"""``pfemcut report``: its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pfemcut.inputs import InputError


def report(
    directory: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of the results.", show_default=False)
    ],
    animation: Annotated[
        bool, typer.Option("--animation/--no-animation", help="Draw the animation of the chip.")
    ] = True,
    scale: Annotated[
        list[str],
        typer.Option("--scale", metavar="FIELD=LOW:HIGH", help="Colour scale of a field; repeat at will."),
    ] = [],  # noqa: B006 (typer copies it)
) -> None:
    """Write the figures and the report of a run, also of one that is going on or was killed."""
    if not (directory / "history.csv").is_file():
        raise InputError([f"{directory}: no results here (history.csv is missing)"])
    from pfemcut.conclusion import report_case
    from pfemcut.output.figures import FIELDS
    from pfemcut.output.scales import given_scales

    scales = given_scales(scale, [field.name for field in FIELDS])
    report_case(directory, animation=animation, scales=scales)
