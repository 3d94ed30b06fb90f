"""Units of a case's keys, from the descriptions in its schema."""

from __future__ import annotations

import re
from collections.abc import Iterable

from pfemcut.case.load import AnyCase
from pfemcut.inputs import description_of

_UNIT = re.compile(r"\(([^()]*)\)$")


def units_of(case: AnyCase, keys: Iterable[str]) -> dict[str, str]:
    """Unit by ``section.key``, for those keys whose description ends with one in brackets."""
    found = {}
    for key in keys:
        parts = [int(part) if part.isdecimal() else part for part in key.split(".")]
        match = _UNIT.search(description_of(type(case), parts))
        if match and match[1] != "dimensionless":
            found[key] = match[1]
    return found
