"""Laws that are found by themselves: one pydantic model a module of a package, usable by its name."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from types import MappingProxyType, ModuleType
from typing import TypeVar

from pydantic import BaseModel

Law = TypeVar("Law", bound=BaseModel)


def discovered(package: ModuleType, base: type[Law]) -> Mapping[str, type[Law]]:
    """Every subclass of ``base`` that a module of ``package`` defines and names by its field ``law``."""
    laws: dict[str, type[Law]] = {}
    for entry in sorted(pkgutil.iter_modules(package.__path__), key=lambda module: module.name):
        module = importlib.import_module(f"{package.__name__}.{entry.name}")
        for member in vars(module).values():
            if (
                isinstance(member, type)
                and issubclass(member, base)
                and member.__module__ == module.__name__
                and "law" in member.model_fields
            ):
                (name,) = member.model_fields["law"].annotation.__args__  # type: ignore[union-attr]
                laws[name] = member
    return MappingProxyType(laws)
