"""``pfemcut new``: a commented case file to start from."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated

import typer

from pfemcut.case.load import toml_value, validated
from pfemcut.case.template import case_template
from pfemcut.case.translate import problem_of
from pfemcut.cli.speech import say
from pfemcut.inputs import InputError
from pfemcut.output.directory import writing


def new(
    path: Annotated[Path, typer.Argument(metavar="[FILE]", help="File to write.")] = Path("case.toml"),
    material: Annotated[
        str, typer.Option(metavar="NAME", help="Material of the library, or a material file.")
    ] = "aisi4340",
    rake: Annotated[str, typer.Option(metavar="ANGLE", help="Rake angle: 6, or '6 deg'.")] = "0 deg",
    tip_radius: Annotated[str, typer.Option(metavar="LENGTH", help="Radius of the tool tip.")] = "25 um",
    speed: Annotated[str, typer.Option(metavar="SPEED", help="Cutting speed.")] = "200 m/min",
    depth: Annotated[str, typer.Option(metavar="LENGTH", help="Uncut chip thickness.")] = "0.1 mm",
) -> None:
    """Write a commented case file; plain numbers are in mm, s and degrees."""
    if path.exists():
        raise InputError([f"{path}: exists already, and is not overwritten"])
    given = (toml_value(text) for text in (rake, tip_radius, speed, depth))
    text = case_template(path.name, material, *given)
    case, checked = validated(tomllib.loads(text), path.parent)
    problem_of(case, checked, path.parent)
    with writing(path.parent), path.open("x", encoding="utf-8") as file:
        file.write(text)
    say(f"{path}: {case.title}")
    say(f"pfemcut check {path}")
    say(f"pfemcut run {path}")
