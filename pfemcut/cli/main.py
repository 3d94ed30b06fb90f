"""The command line, ``pfemcut COMMAND``; commands with more than a few lines have a file of their own beside this one.

Exit status 0 for success (a finished, valid run), 1 for a run that stopped, 2 for bad input, 130 for Ctrl-C.
Whatever is slow to import (dolfinx, matplotlib) is imported by the command that needs it.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from pfemcut.case.check import figures, warnings
from pfemcut.case.load import directed, load_case
from pfemcut.cli.calibrate import calibrate
from pfemcut.cli.compare import compare
from pfemcut.cli.converge import converge
from pfemcut.cli.examples import examples
from pfemcut.cli.new import new
from pfemcut.cli.options import CaseFile
from pfemcut.cli.profiles import profiles
from pfemcut.cli.report import report
from pfemcut.cli.speech import complain, say
from pfemcut.cli.sweep import sweep
from pfemcut.cli.table import result_lines
from pfemcut.cli.watch import watch
from pfemcut.inputs import InputError, UserError
from pfemcut.materials.describe import described
from pfemcut.materials.load import library_names, load_material
from pfemcut.method import RunStopped

Overrides = Annotated[
    list[str],
    typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Override one value; repeat at will."),
]

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    help="Metal cutting with the particle finite element method.",
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its status; under mpirun only rank 0 speaks."""
    sys.exit(status(sys.argv[1:] if arguments is None else arguments))


def status(arguments: Sequence[str]) -> int:
    """Run the command line and return its exit status, errors printed as one line each."""
    try:
        return int(app(list(arguments), standalone_mode=False, prog_name="pfemcut") or 0)
    except UserError as error:
        complain(*str(error).splitlines())
        return 2
    except RunStopped as error:
        complain(f"run stopped: {error}")
        return 1
    except KeyboardInterrupt:
        complain("interrupted")
        return 130
    except Exception as error:
        # Mistakes on the command line: depending on its version, typer brings click or has its own copy of it,
        # so they are known by what they can do.
        if not hasattr(error, "format_message"):
            raise
        complain(" ".join(error.format_message().split()))
        return 2


@app.callback(invoke_without_command=True)
def _options(
    context: typer.Context,
    show_version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if show_version:
        say(f"pfemcut {version('pfemcut')}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        raise InputError(["no command given; see pfemcut --help"])


@app.command()
def run(
    case_file: CaseFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder of the results.")
    ] = None,
    travel: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Travel of the tool, instead of the case's: 1 (mm), or '1 mm'."),
    ] = None,
    overrides: Overrides = [],  # noqa: B006 (typer copies it)
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the last checkpoint.")] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the results of an earlier run in DIR.")
    ] = False,
) -> None:
    """Run a case."""
    if resume and overwrite:
        raise InputError(["--resume and --overwrite exclude each other"])
    # Not before they're needed: mpi4py and dolfinx take a second to load.
    from pfemcut.ranks import Ranks

    ranks = Ranks()
    with ranks.together():
        changes = [*overrides, *([] if travel is None else [f"cutting.travel={travel}"])]
        case, material = ranks.on_first(lambda: load_case(case_file, changes))
        if output is not None:
            case = directed(case, output)
        from pfemcut.driver import run_case

        summary = run_case(
            case,
            material,
            Path(case.output.directory),
            base_directory=case_file.parent,
            resume=resume,
            overwrite=overwrite,
        )
    for line in result_lines(summary):
        say(line)
    if not summary.finished:
        raise typer.Exit(1)


app.command()(sweep)
app.command()(compare)
app.command()(converge)
app.command()(calibrate)
app.command()(examples)
app.command()(new)
app.command()(profiles)


@app.command()
def check(case_file: CaseFile, overrides: Overrides = []) -> None:  # noqa: B006 (typer copies it)
    """Validate a case and print its main figures."""
    case, material = load_case(case_file, overrides)
    for name, text in figures(case, material, case_file.parent):
        say(f"{name:<11} {text}")
    for text in warnings(case, material, case_file.parent):
        say(f"warning: {text}")


app.command()(report)
app.command()(watch)


@app.command()
def materials(
    name: Annotated[str | None, typer.Argument(help="Material to print; all names if left out.")] = None,
) -> None:
    """List the materials of the library, or print one as a material file."""
    if name is not None:
        say(described(load_material(name, Path(), section="")))
        return
    width = max(map(len, library_names()))
    for known in library_names():
        material = load_material(known, Path())
        say(f"{known:<{width}} {material.name}: {material.source}")
