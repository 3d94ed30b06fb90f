"""Writes docs/case_file.md, the reference of the case file, from the schema.

python scripts/case_file_reference.py [docs/case_file.md]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pfemcut.case.schema import Case

PAGE = Path(__file__).resolve().parent.parent / "docs" / "case_file.md"
INTRODUCTION = """\
# The case file

A case file is TOML. Units are mm, tonne, s and K (so N, MPa and mJ), angles are in degrees. Unknown keys, wrong types
and values out of range are errors that name the key. Every run writes the case with all defaults filled in to
`inputs.resolved.toml`. On the command line, `--set section.key=value` overrides one value, and
`pfemcut check CASE.toml` validates.

This page is written by `python scripts/case_file_reference.py` from `pfemcut/case/schema.py`.
"""
MATERIAL = """\
A material is a name in the library (`pfemcut materials`), a path to a material file (relative to the case file), or a
table: `{ base = "voce_steel", hardening = { flow_stress_softening = 0.0 } }` takes a library material and changes
some of its constants. `pfemcut materials NAME` prints a whole one.
"""
RANGES: tuple[tuple[type, str, str], ...] = (
    (Gt, "gt", "> {}"),
    (Ge, "ge", "≥ {}"),
    (Lt, "lt", "< {}"),
    (Le, "le", "≤ {}"),
)


def main(arguments: Sequence[str]) -> int:
    """Write the page; the exit status."""
    path = Path(arguments[0]) if arguments else PAGE
    path.write_text(page(), encoding="utf-8")
    return 0


def page() -> str:
    """The whole page."""
    fields = Case.model_fields
    sections = {name: table for name, field in fields.items() if (table := _model(field)) is not None}
    top = {name: field for name, field in fields.items() if name not in sections}
    parts = [INTRODUCTION, "## Top level\n", _table(top)]
    for name, model in sections.items():
        needed = "" if fields[name].is_required() else " It may be left out."
        parts += [
            f"\n## [{name}]\n",
            f"{(model.__doc__ or '').strip()}{needed}\n",
            _table(model.model_fields),
        ]
        if name == "workpiece":
            parts.append("\n" + MATERIAL.rstrip())
    return "\n".join(parts) + "\n"


def _table(fields: dict[str, FieldInfo]) -> str:
    lines = ["| Key | Meaning | Allowed | Default |", "|---|---|---|---|"]
    lines += [
        f"| `{name}` | {field.description} | {_allowed(field)} | {_default(field)} |"
        for name, field in fields.items()
    ]
    return "\n".join(lines)


def _model(field: FieldInfo) -> type[BaseModel] | None:
    annotation = field.annotation
    return annotation if isinstance(annotation, type) and issubclass(annotation, BaseModel) else None


def _allowed(field: FieldInfo) -> str:
    choices = _choices(field.annotation)
    if choices:
        return ", ".join(f'`"{choice}"`' for choice in choices)
    limits = [
        text.format(f"{getattr(limit, name):g}")
        for kind, name, text in RANGES
        for limit in field.metadata
        if isinstance(limit, kind)
    ]
    if any(isinstance(limit, MinLen) for limit in field.metadata):
        limits.append("not empty")
    return ", ".join([_kind(field.annotation), *limits])


def _choices(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return ()


def _kind(annotation: Any) -> str:
    names = {float: "number", int: "whole number", bool: "true or false", str: "text", dict: "table"}
    kinds = [
        names[get_origin(each) or each]
        for each in get_args(annotation) or (annotation,)
        if each is not type(None)
    ]
    return " or ".join(dict.fromkeys(kinds))


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.default
    if value is None:
        return "–"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value:g}`"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
