"""From a sweep file, or the command line's lists, to a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from pfemcut.case.load import toml_value
from pfemcut.case.sections import Section
from pfemcut.inputs import InputError, explained, nearest, read_toml
from pfemcut.results.definitions import FIGURES
from pfemcut.sweep.plan import Lists, Plan, Values, variants_of

MAIN_FIGURES = (
    "cutting_force",
    "thrust_force",
    "chip_thickness",
    "contact_length",
    "shear_angle",
    "max_temperature",
)
"""Figures that are plotted unless others are asked for."""

NAME = "name"


class StudyFile(Section):
    """A sweep file."""

    case: str = Field(min_length=1, description="Base case file, beside this file")
    output: str = Field(default="", description="Folder of the results")
    figures: list[str] = Field(
        default=list(MAIN_FIGURES), min_length=1, description="Figures of summary.json to plot"
    )
    set: dict[str, Any] = Field(default={}, description="Values of all variants by section.key")
    grid: dict[str, Any] = Field(default={}, description="Lists of values, all combinations")
    zip: dict[str, Any] = Field(default={}, description="Lists of values that go together")
    variant: list[dict[str, Any]] = Field(default=[], description="Further variants")


def is_study(table: Mapping[str, Any]) -> bool:
    """Whether a parsed TOML file is a sweep file: only these name a case."""
    return "case" in table


def read_plan(
    path: Path,
    *,
    vary: Sequence[str] = (),
    zipped: Sequence[str] = (),
    common: Sequence[str] = (),
    output: Path | None = None,
) -> Plan:
    """The plan of a sweep file, or of a case file with lists of values.

    Parameters
    ----------
    path
        A sweep file or a case file.
    vary, zipped
        ``section.key=value,value,...`` of a case file: all combinations, and values that go together.
    common
        ``section.key=value`` of all variants.
    output
        Folder of the results; by default the file's, or ``out/NAME`` for a file ``NAME.toml``.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    table = read_toml(path)
    settings = settings_of(common)
    if is_study(table):
        if vary or zipped:
            raise InputError([f"{path}: has the parameters already; --vary and --zip are for a case file"])
        try:
            plan = _plan_of(path, table)
        except InputError as error:
            raise InputError(f"{path}: {problem}" for problem in error.problems) from None
    else:
        if not vary and not zipped:
            hint = 'give --vary section.key=value,value,... or a sweep file (which has `case = "CASE.toml"`)'
            raise InputError([f"{path}: nothing to vary: {hint}"])
        grid = {key: value_list(text) for key, text in _split(vary, "--vary").items()}
        together = {key: value_list(text) for key, text in _split(zipped, "--zip").items()}
        plan = Plan(path, Path("out") / path.stem, {}, variants_of(grid, together), MAIN_FIGURES)
    both = [key for key in plan.keys if key in settings]
    if both:
        raise InputError(f"--set: '{key}' is varied" for key in both)
    return replace(plan, common={**plan.common, **settings}, output=output or plan.output)


def settings_of(common: Sequence[str]) -> dict[str, Any]:
    """Values by key of the ``section.key=value`` given with ``--set``."""
    return {key: toml_value(text) for key, text in _split(common, "--set", "value").items()}


def _plan_of(path: Path, table: Mapping[str, Any]) -> Plan:
    try:
        file = StudyFile.model_validate(table)
    except ValidationError as error:
        raise InputError(explained(error, StudyFile)) from None
    known = {item.name for item in FIGURES}
    problems = [
        f"figures: unknown '{name}'{nearest(name, known)}" for name in file.figures if name not in known
    ]
    lists: dict[str, Lists] = {}
    for name, section in (("grid", file.grid), ("zip", file.zip)):
        lists[name] = flat(section)
        problems += [
            f"[{name}] {key}: given {values!r}, must be a list of values"
            for key, values in lists[name].items()
            if not isinstance(values, list)
        ]
    listed: list[tuple[str, Values]] = []
    for index, entry in enumerate(file.variant):
        name = entry.get(NAME, "")
        if not isinstance(name, str) or (NAME in entry and not _is_file_name(name)):
            problems.append(
                f"[variant[{index}]] name: given {name!r}, must be letters, digits and any of . + - = _"
            )
        listed.append((str(name), flat({key: value for key, value in entry.items() if key != NAME})))
        if not listed[-1][1]:
            problems.append(f"[variant[{index}]] changes nothing")
    common = flat(file.set)
    if problems:
        raise InputError(problems)
    variants = variants_of(lists["grid"], lists["zip"], listed)
    varied = [key for key in (*lists["grid"], *lists["zip"]) if key in common]
    if varied:
        raise InputError(f"[set] {key}: is varied" for key in varied)
    output = Path(file.output) if file.output else Path("out") / path.stem
    return Plan(path.parent / file.case, output, common, variants, tuple(file.figures))


def flat(section: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """``section.key`` to value of a table whose keys are bare (``tool.rake = ...``) or quoted (``"tool.rake"``).

    A quoted key is a whole path, and its value is taken as it is, also if it is a table.
    """
    found: dict[str, Any] = {}
    for key, value in section.items():
        path = f"{prefix}{key}"
        if isinstance(value, Mapping) and "." not in key:
            found |= flat(value, f"{path}.")
        else:
            found[path] = value
    return found


def value_list(text: str) -> list[Any]:
    """The values of a comma-separated list; commas in brackets, braces and quotes do not separate."""
    whole = toml_value(f"[{text}]")
    return whole if isinstance(whole, list) else [toml_value(part.strip()) for part in _parts(text)]


def _parts(text: str) -> list[str]:
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        else:
            depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0 and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return parts if text.strip() else []


def _split(options: Sequence[str], option: str, shape: str = "value,value,...") -> dict[str, str]:
    """Key and text of each ``section.key=text``."""
    found: dict[str, str] = {}
    for given in options:
        key, equals, text = given.partition("=")
        key = key.strip()
        if not equals or not all(part.strip() for part in key.split(".")):
            raise InputError([f"{option}: given '{given}', must be section.key={shape}"])
        if key in found:
            raise InputError([f"{option}: '{key}' is given twice"])
        found[key] = text
    return found


def _is_file_name(name: str) -> bool:
    return all(letter.isalnum() or letter in ".+-=_" for letter in name) and name.strip(".") != ""
