"""What a sweep runs: a base case, and variants of it by the values that they change."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pfemcut.inputs import InputError

Values = Mapping[str, Any]
"""Values by ``section.key``."""
Lists = Mapping[str, Sequence[Any]]
"""Lists of values by ``section.key``."""

LONGEST_NAME = 120
_UNSAFE = re.compile(r"[^A-Za-z0-9._+-]+")


@dataclass(frozen=True)
class Variant:
    """One case of a sweep.

    Attributes
    ----------
    name
        Its name, also of its folder.
    values
        What it changes in the base case.
    """

    name: str
    values: Values


@dataclass(frozen=True)
class Plan:
    """A sweep.

    Attributes
    ----------
    case
        Base case file.
    output
        Folder of the variants' folders, the table and the plot.
    common
        What all variants change.
    variants
        The variants, in order.
    figures
        Names of the figures to plot.
    """

    case: Path
    output: Path
    common: Values
    variants: tuple[Variant, ...]
    figures: tuple[str, ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """The parameters: all keys that variants change, in order of appearance."""
        return tuple(dict.fromkeys(key for variant in self.variants for key in variant.values))


def variants_of(grid: Lists, zipped: Lists, listed: Sequence[tuple[str, Values]] = ()) -> tuple[Variant, ...]:
    """All combinations of the grid's values with the rows of the zipped lists, then the listed variants.

    Parameters
    ----------
    grid
        Lists of which all combinations are made; the first varies slowest.
    zipped
        Lists of equal length: the first values go together, then the second ones, and so on.
    listed
        Further variants: a name, or nothing for one made of the values, and what it changes.

    Raises
    ------
    InputError
        If there is nothing to vary, a list is empty or of another length, a key is varied twice, or two variants
        are the same.
    """
    problems = [f"'{key}' has no values" for key, values in (*grid.items(), *zipped.items()) if not values]
    problems += [f"'{key}' is varied in the grid and in the zipped lists" for key in grid if key in zipped]
    if len({len(values) for values in zipped.values()}) > 1:
        lengths = ", ".join(f"'{key}' {len(values)}" for key, values in zipped.items())
        problems.append(f"zipped lists must have the same length, but have: {lengths}")
    if not (grid or zipped or listed):
        problems.append("nothing to vary")
    if problems:
        raise InputError(problems)
    rows: Sequence[Values] = [
        dict(zip(zipped, values, strict=True)) for values in zip(*zipped.values(), strict=True)
    ]
    crossed = [
        ("", {**dict(zip(grid, values, strict=True)), **row})
        for values in itertools.product(*grid.values())
        for row in (rows or [{}])
    ]
    entries = [*(crossed if grid or zipped else []), *listed]
    short = short_keys({key for _, values in entries for key in values})
    variants = tuple(Variant(name or name_of(values, short), values) for name, values in entries)
    _require_different(variants)
    return variants


def _require_different(variants: Sequence[Variant]) -> None:
    """Raise if two variants would have one folder."""
    seen: dict[str, Variant] = {}
    problems = []
    for variant in variants:
        other = seen.setdefault(variant.name, variant)
        if other is not variant:
            problems.append(f"two variants are called '{variant.name}': a value is listed twice")
    if problems:
        raise InputError(dict.fromkeys(problems))


def short_keys(keys: set[str]) -> dict[str, str]:
    """For each key the fewest of its last parts that no other key ends with."""
    parts = {key: key.split(".") for key in keys}

    def shortest(key: str) -> str:
        own = parts[key]
        for count in range(1, len(own)):
            if sum(other[-count:] == own[-count:] for other in parts.values()) == 1:
                return ".".join(own[-count:])
        return key

    return {key: shortest(key) for key in keys}


def name_of(values: Values, short: Mapping[str, str]) -> str:
    """A readable name that is safe as a file name: ``speed=1000_friction=0.2``.

    It depends on the values alone, so that a sweep that is extended finds its runs again. Where a text loses
    something, or is too long for a name, a hash of the values makes up for it.

    Parameters
    ----------
    values
        What the variant changes.
    short
        Short forms of their keys.
    """
    texts = {key: value_text(value) for key, value in values.items()}
    safe = {
        key: _UNSAFE.sub("-", text).strip("-") if _UNSAFE.search(text) else text
        for key, text in texts.items()
    }
    name = "_".join(f"{_UNSAFE.sub('-', short[key])}={text}" for key, text in safe.items())
    if safe == texts and len(name) <= LONGEST_NAME:
        return name
    digest = hashlib.sha256(json.dumps(values, sort_keys=True, default=str).encode()).hexdigest()[:6]
    return f"{name[: LONGEST_NAME - 7]}_{digest}"


def value_text(value: Any) -> str:
    """A value in a name, a table or a legend: numbers as short as they read back, the rest as JSON."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return json.dumps(value, default=str)
    if isinstance(value, float) and math.isfinite(value) and float(f"{value:g}") == value:
        return f"{value:g}"
    return str(value)
