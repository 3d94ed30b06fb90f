"""Wear constants: their schema, the library, and the way from a case file to :class:`UsuiWear` and back."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict, ValidationError, model_validator

from pfemcut.input_table import InputTable
from pfemcut.inputs import InputError, explained
from pfemcut.library import entry, entry_names
from pfemcut.wear.usui import Constants, UsuiWear

PACKAGE = "pfemcut.wear"
SECTION = "tool.wear"


class _Table(InputTable):
    A: float = Field(gt=0, description="Usui's factor A (1/MPa)")
    B: float = Field(ge=0, description="Usui's temperature B (K)")

    @model_validator(mode="before")
    @classmethod
    def _b_is_no_point_on_a_scale(cls, table: Any) -> Any:
        """``table``, unless its ``B`` is in °C or °F: it stands over absolute temperatures."""
        given = table.get("B") if isinstance(table, Mapping) else None
        if isinstance(given, str) and re.search("deg|°|celsius|fahrenheit", given, re.IGNORECASE):
            raise ValueError(f"B: given {given!r}, must be in K, such as '5300 K'")
        return table


class AboveTable(_Table):
    """Other constants from a temperature on."""

    temperature: float = Field(gt=0, description="Temperature from which they hold (K)")


class WearTable(_Table):
    """Constants of Usui's wear rate A σ v exp(−B/T) for a pair of tool and workpiece material."""

    name: str = Field(default="", description="Name for reports")
    source: str = Field(default="", description="Where the constants come from")
    checked: str = Field(default="", description="Against what they were checked")
    notes: Annotated[tuple[str, ...], Strict(False)] = Field(default=(), description="What a user must know")
    above: AboveTable | None = Field(
        default=None, description="Table of other constants from a temperature on"
    )


def wear_names() -> list[str]:
    """Names of the library's pairs."""
    return entry_names(PACKAGE)


def wear_table(spec: str | Mapping[str, Any], base_directory: Path) -> dict[str, Any]:
    """The table of constants that a case file asks for, checked and complete.

    Parameters
    ----------
    spec
        A library name, a path to a TOML file (relative ones start at ``base_directory``), or a table.
    base_directory
        Folder of the case file.

    Raises
    ------
    InputError
        If there are no such constants or they are not valid.
    """
    origin, section = "", SECTION
    if isinstance(spec, str):
        table, origin = _named(spec, base_directory)
        section = ""
    else:
        table = dict(spec)
    try:
        found = WearTable.model_validate(table).model_dump(exclude_none=True)
    except ValidationError as error:
        problems = explained(error, WearTable, section)
        raise InputError(f"{origin}: {line}" if origin else line for line in problems) from None
    return {**found, "notes": list(found["notes"])}


def wear_of(table: Mapping[str, Any]) -> UsuiWear:
    """The law of a table of constants (:func:`wear_table`)."""
    given = WearTable.model_validate(dict(table))
    above = [] if given.above is None else [given.above]
    return UsuiWear(
        name=given.name or "unnamed",
        ranges=(
            Constants(0.0, given.A, given.B),
            *(Constants(each.temperature, each.A, each.B) for each in above),
        ),
        source=given.source,
        checked=given.checked,
    )


def _named(name: str, base_directory: Path) -> tuple[dict[str, Any], str]:
    """Table of the library or of a file, and what messages call it."""
    table, path = entry(PACKAGE, name, base_directory, "[tool] wear", "pair")
    return table, f"wear constants '{name}'" if name in wear_names() else str(path)
