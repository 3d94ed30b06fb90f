"""The parameters of a calibration, with their bounds, from the command line or a file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from pfemcut.case.sections import Section
from pfemcut.inputs import InputError, explained, read_toml

DIGITS = 6
"""Significant digits of a parameter's value, and of its place between the bounds: more would mean nothing, and the
value is part of a folder's name."""
_ALL_DIGITS = 17
_SHAPE = "must be section.key=LOW:HIGH or section.key=LOW:HIGH:START"


@dataclass(frozen=True)
class Parameter:
    """A parameter to fit.

    Attributes
    ----------
    key
        ``section.key`` of the case.
    low, high
        Bounds.
    start
        Where the search begins; nan for the case's own value.
    """

    key: str
    low: float
    high: float
    start: float

    def value(self, scaled: float) -> float:
        """The value at ``scaled`` from 0 (low) to 1 (high), to :data:`DIGITS` digits, never beyond a bound."""
        exact = self.low + scaled * (self.high - self.low)
        # Bounds that are near to each other differ in their last digits only: there it takes more.
        decimals = DIGITS - 1 - math.floor(math.log10(self.high - self.low))
        digits = DIGITS if exact == 0.0 else decimals + 1 + math.floor(math.log10(abs(exact)))
        rounded = float(f"{exact:.{min(max(digits, DIGITS), _ALL_DIGITS)}g}")
        return min(max(rounded, self.low), self.high)

    def scaled(self, value: float) -> float:
        """Where the value lies between the bounds, from 0 to 1."""
        return (value - self.low) / (self.high - self.low)


class Bounds(Section):
    """A parameter in a file."""

    low: float = Field(description="Lower bound")
    high: float = Field(description="Upper bound")
    start: float | None = Field(default=None, description="Where the search begins")


def read_parameters(given: Sequence[str]) -> tuple[Parameter, ...]:
    """Parameters from ``section.key=LOW:HIGH[:START]``, several with commas between, or the path of a TOML file.

    The file has a table for each, ``"contact.friction" = {low = 0.05, high = 0.6, start = 0.2}``. A key that begins
    with ``material.`` means the workpiece's material.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    problems: list[str] = []
    found: list[Parameter] = []
    for text in given:
        try:
            if "=" not in text and text.endswith(".toml"):
                found += _from_file(Path(text))
            else:
                found += [_from_text(part.strip()) for part in text.split(",")]
        except InputError as error:
            problems += error.problems
    if not found and not problems:
        problems.append(f"nothing to fit: give --fit, which {_SHAPE}")
    keys = [each.key for each in found]
    problems += [f"--fit: '{key}' is given twice" for key in dict.fromkeys(keys) if keys.count(key) > 1]
    problems += [problem for each in found for problem in _wrong(each)]
    if problems:
        raise InputError(problems)
    return tuple(found)


def started(parameters: Iterable[Parameter], values: Mapping[str, Any]) -> tuple[Parameter, ...]:
    """The parameters with the case's own values as start where none is given.

    Raises
    ------
    InputError
        If the case's value is no number, or is outside of the bounds.
    """
    problems: list[str] = []
    found: list[Parameter] = []
    for each in parameters:
        start: Any = values[each.key] if math.isnan(each.start) else each.start
        if isinstance(start, bool) or not isinstance(start, int | float):
            problems.append(f"--fit: '{each.key}' is {start!r} in the case, which is no number")
            continue
        if not each.low <= start <= each.high:
            problems.append(
                f"--fit: '{each.key}' starts at the case's {start:g}, outside of {each.low:g} to {each.high:g}: "
                "give a start, LOW:HIGH:START"
            )
        found.append(Parameter(each.key, each.low, each.high, float(start)))
    if problems:
        raise InputError(problems)
    return tuple(found)


def _from_text(text: str) -> Parameter:
    key, equals, bounds = text.partition("=")
    key = key.strip()
    if not all(part.strip() for part in key.split(".")):
        raise InputError([f"--fit: given '{text}', {_SHAPE}"])
    if not equals:
        raise InputError([f"--fit: given '{text}' without bounds, {_SHAPE}"])
    try:
        numbers = [float(part) for part in bounds.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(map(math.isfinite, numbers)):
        raise InputError([f"--fit: given '{text}', {_SHAPE}"])
    return Parameter(_full(key), numbers[0], numbers[1], numbers[2] if len(numbers) == 3 else math.nan)


def _from_file(path: Path) -> list[Parameter]:
    problems: list[str] = []
    found: list[Parameter] = []

    def visit(table: Mapping[str, Any], prefix: str) -> None:
        for key, value in table.items():
            name = f"{prefix}{key}"
            if not isinstance(value, Mapping):
                problems.append(f"{path}: {name}: given {value!r}, must be a table with low and high")
            elif not Bounds.model_fields.keys() & value.keys():
                visit(value, f"{name}.")
            else:
                try:
                    bounds = Bounds.model_validate(value)
                except ValidationError as error:
                    problems.extend(f"{path}: {line}" for line in explained(error, Bounds, name))
                else:
                    start = math.nan if bounds.start is None else bounds.start
                    found.append(Parameter(_full(name), bounds.low, bounds.high, start))

    visit(read_toml(path), "")
    if not found and not problems:
        problems.append(f"{path}: has no parameters")
    if problems:
        raise InputError(problems)
    return found


def _full(key: str) -> str:
    return f"workpiece.{key}" if key.startswith("material.") else key


def _wrong(parameter: Parameter) -> list[str]:
    problems = []
    if not parameter.low < parameter.high:
        problems.append(
            f"--fit: '{parameter.key}': low = {parameter.low:g} must be less than high = {parameter.high:g}"
        )
    elif not math.isnan(parameter.start) and not parameter.low <= parameter.start <= parameter.high:
        problems.append(
            f"--fit: '{parameter.key}': start = {parameter.start:g} must be "
            f"from {parameter.low:g} to {parameter.high:g}"
        )
    return problems
