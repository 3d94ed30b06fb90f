"""A material in words: a material file with the meaning and the source of every value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import tomli_w
from pydantic import BaseModel

from pfemcut.materials.hardening import LAWS
from pfemcut.materials.load import MaterialTable, material_table
from pfemcut.materials.material import Material
from pfemcut.units import declared, in_other


def described(material: Material) -> str:
    """Printable description: a valid material file with each key's meaning and unit as a comment."""
    table = material_table(material)
    hardening, sources = table.pop("hardening"), table.pop("sources")
    lines = _commented(table, MaterialTable)
    lines += ["", "[hardening]", *_commented(hardening, LAWS[hardening["law"]])]
    if sources:
        lines += ["", tomli_w.dumps({"sources": sources}).strip()]
    return "\n".join(lines)


def source_of(material: Material, key: str) -> str:
    """Source of the value of ``key`` (``hardening.A`` or the like for a law's constant); empty if not given.

    A constant of the law without its own source has that of the material's value of the same name, which is the
    reference temperature, or that of the whole law.
    """
    sources = dict(material.sources)
    table, _, constant = key.rpartition(".")
    return sources.get(key) or sources.get(constant) or sources.get(table, "")


def _in_other(value: Any, model: type[BaseModel], key: str) -> str:
    """A number in the unit that engineers use, if that is another one."""
    kind = declared(model.model_fields[key].description or "")
    other = in_other(value, kind.unit) if kind and isinstance(value, int | float) else None
    return f"{other[0]:.6g} {other[1]}: " if other else ""


def _commented(table: Mapping[str, Any], model: type[BaseModel]) -> list[str]:
    lines = []
    for key, value in table.items():
        if isinstance(value, dict):
            inside = ", ".join(f"{inner} = {value[inner]}" for inner in value)
            written = f"{key} = {{ {inside} }}"
        else:
            written = tomli_w.dumps({key: value}).strip()
        note = _in_other(value, model, key) + (model.model_fields[key].description or "")
        lines.append(f"{written}  # {note}" if note else written)
    return lines
