"""Units of a case's keys, from the descriptions in its schema."""

from __future__ import annotations

from collections.abc import Iterable

from pfemcut.case.load import AnyCase
from pfemcut.inputs import description_of
from pfemcut.units import declared


def units_of(case: AnyCase, keys: Iterable[str]) -> dict[str, str]:
    """Unit by ``section.key``, for those keys that declare one."""
    found = {}
    for key in keys:
        parts = [int(part) if part.isdecimal() else part for part in key.split(".")]
        if kind := declared(description_of(type(case), parts)):
            found[key] = kind.unit
    return found
