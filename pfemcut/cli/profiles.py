"""``pfemcut profiles``: profiles along the tool of a run, also with other wear constants than its case has."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pfemcut.cli.speech import say
from pfemcut.cli.table import figure_in_column
from pfemcut.inputs import InputError


def profiles(
    directory: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of the results.", show_default=False)
    ],
    wear: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Wear constants (library, or file) instead of the case's."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder of table and picture, unless the run's."),
    ] = None,
) -> None:
    """Write the profiles along the tool of a run and print their figures."""
    # Not before it's needed: matplotlib takes a second to load.
    from pfemcut.output.directory import FIGURES
    from pfemcut.output.profile_figure import write_picture
    from pfemcut.output.tool_profiles import cut_profiles, write_table
    from pfemcut.results.derived.profile_figures import profile_figures
    from pfemcut.wear.load import wear_of, wear_table

    if wear is not None and output is None:
        raise InputError(["--wear: needs -o, so that the run's own table stays that of its case"])
    law = () if wear is None else (wear_of(wear_table(wear, Path())),)
    found = cut_profiles(directory, law)
    if not found:
        raise InputError([f"{directory}: holds no cut with contact (history.csv, contact.csv or fields)"])
    for each in found:
        into = directory if output is None else output
        into.mkdir(parents=True, exist_ok=True)
        table = write_table(into, each.profiles)
        picture = write_picture(each, into if output is not None else directory / FIGURES)
        first, last = each.travel
        say(f"{each.profiles.instants} instants, travel {first:.4g} to {last:.4g} mm")
        for name, figure in profile_figures(each.profiles).items():
            say(f"  {name:<24} {figure_in_column(figure)}")
        for used in each.inputs.wear:
            say(f"wear constants: {used.name}; {used.checked or 'not said against what they were checked'}")
        say(f"{table}, {picture}")
