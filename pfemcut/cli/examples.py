"""``pfemcut examples``: the case files of the published and predicted cuts, which are installed with the package."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path
from typing import Annotated

import typer

import pfemcut
from pfemcut.cli.speech import say
from pfemcut.inputs import InputError, nearest
from pfemcut.output.directory import writing

CASE = "case.toml"


def examples(
    directory: Annotated[
        Path | None, typer.Argument(metavar="[DIR]", help="Folder to copy to; NAME unless given.")
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the examples, as without an option.")] = False,
    copy: Annotated[str | None, typer.Option("--copy", metavar="NAME", help="Copy an example.")] = None,
) -> None:
    """List the examples, or copy one with its published or measured figures."""
    if copy is None:
        if directory is not None:
            raise InputError(["DIR is where --copy NAME copies to"])
        for line in example_lines():
            say(line)
        return
    if listed:
        raise InputError(["--list and --copy exclude each other"])
    for path in copied(copy, Path(copy) if directory is None else directory):
        say(str(path))


def folder() -> Path:
    """Where the examples are: installed with the package, or the demos of a source tree."""
    package = Path(pfemcut.__file__).parent
    installed = package / "examples"
    return installed if installed.is_dir() else package.parent / "demos"


def example_names() -> list[str]:
    """Names of the examples."""
    return sorted(path.parent.name for path in folder().glob(f"*/{CASE}"))


def example_lines() -> list[str]:
    """A line each: name and title."""
    names = example_names()
    width = max(map(len, names), default=0)
    titles = {
        name: tomllib.loads((folder() / name / CASE).read_text(encoding="utf-8")).get("title", "")
        for name in names
    }
    return [f"{name:<{width}}  {titles[name]}" for name in names]


def copied(name: str, target: Path) -> list[Path]:
    """Copy the files of an example into the folder ``target``; the copies.

    Raises
    ------
    InputError
        If there is no such example, or a file of it is there already.
    """
    if name not in example_names():
        raise InputError([f"unknown example '{name}'{nearest(name, example_names())}"])
    sources = sorted((folder() / name).glob("*.toml"))
    there = [target / source.name for source in sources if (target / source.name).exists()]
    if there:
        raise InputError(f"{path}: exists already, and is not overwritten" for path in there)
    with writing(target):
        target.mkdir(parents=True, exist_ok=True)
        return [Path(shutil.copyfile(source, target / source.name)) for source in sources]
