"""Tables of a run's inputs: every key with its value, unit, meaning and source, from the resolved case file.

The meanings come from the case file's schema, the sources from the material's file. Keys that the schema doesn't
know (a case of another version) are shown without a meaning rather than left out.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.schema import Case
from pfemcut.inputs import models_in
from pfemcut.materials.load import MaterialTable
from pfemcut.output.report.text import converted, shown, spoken
from pfemcut.peridynamics.load import LaminaTable
from pfemcut.units import unit_and_words

NUMERICS = ("mesh", "time", "solver", "output")
"""Sections of which only what differs from the defaults is shown."""

TITLES = {
    "workpiece": "Workpiece",
    "tool": "Tool",
    "cutting": "Cut",
    "contact": "Contact",
    "lamina": "Plate",
    "hole": "Holes",
    "crack": "Line cracks",
    "lattice": "Lattice",
    "pull": "Pull",
    "mesh": "Particle spacing",
    "time": "Time steps",
    "solver": "Solver",
    "output": "Output",
    "body": "Bodies",
    "boundary": "Boundary conditions",
    "probe": "Probes",
}

_WORDS = ("name", "source", "checked", "notes", "sources")


@dataclass(frozen=True)
class InputRow:
    """One input: key, value, unit, the value in a common unit, meaning, and whether it is the default."""

    key: str
    value: str
    unit: str
    other: str
    meaning: str
    source: str = ""
    default: bool = False


@dataclass(frozen=True)
class InputTable:
    """The inputs of one section."""

    title: str
    rows: tuple[InputRow, ...]


@dataclass(frozen=True)
class MaterialInputs:
    """A material: its constants with their sources, and what is said of the whole.

    Attributes
    ----------
    title
        Of which body it is, and its name.
    source, checked, notes
        Words of the material file.
    rows
        Its constants; their sources are numbers of ``references``, from 1.
    references
        Sources of the constants.
    """

    title: str
    source: str
    checked: str
    notes: tuple[str, ...]
    rows: tuple[InputRow, ...]
    references: tuple[str, ...]


def tables(inputs: str) -> tuple[tuple[InputTable, ...], tuple[MaterialInputs, ...]]:
    """Return the tables of a resolved case file (TOML text), materials apart.

    Raises
    ------
    tomllib.TOMLDecodeError
        If the text is no TOML.
    """
    table = tomllib.loads(inputs)
    kinds: dict[str, type[BaseModel]] = {"general": GeneralCase, "lamina": LaminaCase}
    model = kinds.get(str(table.get("problem")), Case)
    sections = []
    for name, title in TITLES.items():
        given = {name: table[name]} if name in table else {}
        rows = tuple(
            replace(row, key=row.key.removeprefix(f"{name}."))
            for row in _rows(given, [model], "")
            if not (name in NUMERICS and row.default)
        )
        if rows:
            sections.append(InputTable(title, rows))
    return tuple(sections), tuple(_materials(table))


def _materials(table: Mapping[str, Any]) -> Iterator[MaterialInputs]:
    holders = [("Workpiece", table.get("workpiece", {}))]
    holders += [(each.get("name", "body"), each) for each in table.get("body", ())]
    holders.append(("Tool", table.get("tool", {}).get("body", {})))
    holders.append(("Lamina", table.get("lamina", {})))
    for owner, holder in holders:
        given = holder.get("material")
        if isinstance(given, Mapping):
            name = f"{owner}: {given['name']}" if given.get("name") else owner
            rows = tuple(_constants(given))
            references = tuple(dict.fromkeys(row.source for row in rows if row.source))
            numbered = (
                replace(row, source=f"[{references.index(row.source) + 1}]" if row.source else "")
                for row in rows
            )
            yield MaterialInputs(
                name,
                given.get("source", ""),
                given.get("checked", ""),
                tuple(given.get("notes", ())),
                tuple(numbered),
                references,
            )


def _constants(material: Mapping[str, Any]) -> Iterator[InputRow]:
    sources = material.get("sources", {})
    given = {key: value for key, value in material.items() if key not in _WORDS}
    model = LaminaTable if "axial_modulus" in given else MaterialTable
    for row in _rows(given, [model], ""):
        table, _, constant = row.key.rpartition(".")
        source = sources.get(row.key) or sources.get(constant) or sources.get(table, "")
        yield replace(row, key=row.key.removeprefix("hardening."), source=source)


def _rows(section: Mapping[str, Any], models: Sequence[type[BaseModel]], prefix: str) -> Iterator[InputRow]:
    """Rows of a section and of the tables in it, but not of materials.

    Parameters
    ----------
    section
        A table of the case file.
    models
        The schema's models that may describe it.
    prefix
        What stands before its keys.
    """
    if isinstance(section.get("law"), str):
        models = [each for each in models if _is_law(each, section["law"])]
    for key, value in section.items():
        fields = [model.model_fields[key] for model in models if key in model.model_fields]
        inner = [each for field in fields for each in models_in(field.annotation, field.metadata)]
        if key == "material":
            continue
        if isinstance(value, Mapping) and not _is_by_temperature(value):
            yield from _rows(value, inner, f"{prefix}{key}.")
        elif isinstance(value, list) and value and all(isinstance(each, Mapping) for each in value):
            for number, each in enumerate(value):
                yield from _rows(each, inner, f"{prefix}{key}.{number}.")
        else:
            yield _row(f"{prefix}{key}", value, fields)


def _row(key: str, value: Any, fields: Sequence[FieldInfo]) -> InputRow:
    description = next((field.description for field in fields if field.description), "")
    unit, meaning = unit_and_words(description)
    default = any(not field.is_required() and field.default == value for field in fields)
    text, other = shown(value), converted(value, unit)
    if _is_by_temperature(value):
        # A property by temperature.
        text = f"{shown(value['value'])} at {shown(value['temperature'])} K"
        other = converted(value["value"], unit)
    meaning = meaning.removesuffix(", or a table").removesuffix("; a number or a table")
    return InputRow(key, text, spoken(unit), other, meaning, default=default)


def _is_by_temperature(value: Any) -> bool:
    return isinstance(value, Mapping) and set(value) == {"temperature", "value"}


def _is_law(model: type[BaseModel], law: str) -> bool:
    field = model.model_fields.get("law")
    return field is not None and law in get_args(field.annotation)
