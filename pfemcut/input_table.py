"""What all tables of input files share, case files and material files alike."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ConfigDict, model_validator
from pydantic.fields import FieldInfo

from pfemcut.inputs import NoQuantity, models_in
from pfemcut.units import Kind, UnitError, declared, in_base_unit


class InputTable(BaseModel):
    """A table that is immutable, with no unknown keys, no guessing of types, finite numbers, and values with units.

    A key that holds numbers declares its unit in brackets in its description. A key of an inner table that declares
    none has that of the key which holds the table: the ``value`` of a table in time, say.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _in_base_units(cls, table: Any) -> Any:
        """``table`` with text such as ``"200 m/min"`` as plain numbers in base units."""
        if not isinstance(table, Mapping):
            return table
        return {
            key: _converted(value, field, declared(field.description or ""))
            if (field := cls.model_fields.get(key)) and not isinstance(value, int | float)
            else value
            for key, value in table.items()
        }


def _converted(value: Any, field: FieldInfo, kind: Kind | None) -> Any:
    if kind is None:
        return value
    if isinstance(value, str):
        if not _holds_numbers(field.annotation, *field.metadata):
            return value
        try:
            return in_base_unit(value, kind)
        except UnitError as error:
            # It fails the validation in its place, so that all problems are found in one go.
            return NoQuantity(value, str(error))
    if isinstance(value, list | tuple):
        return [_converted(each, field, kind) for each in value]
    if isinstance(value, Mapping):
        inner = {
            key: each
            for model in models_in(field.annotation, field.metadata)
            for key, each in model.model_fields.items()
            if "(dimensionless" not in (each.description or "") and declared(each.description or "") is None
        }
        return {
            key: _converted(each, inner[key], kind) if key in inner else each for key, each in value.items()
        }
    return value


def _holds_numbers(*annotations: Any) -> bool:
    """Whether any of the annotations mentions a number outside of a table."""
    return any(each is float or _holds_numbers(*get_args(each)) for each in annotations)
