"""Friction laws, one a module; a module dropped in here is found by itself and its law usable by name."""

from __future__ import annotations

import importlib
import operator
import pkgutil
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from pfemcut.contact.friction_laws.base import LawModel


def _discovered() -> dict[str, type[LawModel]]:
    """Every law class defined in a module of this package, by the name that case files use."""
    laws: dict[str, type[LawModel]] = {}
    for entry in sorted(pkgutil.iter_modules(__path__), key=lambda module: module.name):
        module = importlib.import_module(f"{__name__}.{entry.name}")
        for member in vars(module).values():
            if (
                isinstance(member, type)
                and issubclass(member, LawModel)
                and member.__module__ == module.__name__
                and "law" in member.model_fields
            ):
                (name,) = member.model_fields["law"].annotation.__args__  # type: ignore[union-attr]
                laws[name] = member
    return laws


LAWS = MappingProxyType(_discovered())
"""The friction laws by name."""

if TYPE_CHECKING:
    FrictionTable = LawModel
else:
    FrictionTable: Any = Annotated[reduce(operator.or_, LAWS.values()), Field(discriminator="law")]
    """Type of a ``[contact.friction]`` table: the union of all laws, told apart by ``law``."""
