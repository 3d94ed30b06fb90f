"""Writes docs/case_file.md, the reference of the case file, from the schema.

python scripts/case_file_reference.py [docs/case_file.md]
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.case.wording import allowed, choices, default, inner_types, kind_of

PAGE = Path(__file__).resolve().parent.parent / "docs" / "case_file.md"
INTRODUCTION = """\
# The case file

A case file is TOML. Plain numbers are in mm, tonne, s and K (so N, MPa and mJ), angles in degrees; text such as
`"200 m/min"` brings [its own unit](units.md). Unknown keys, wrong types
and values out of range are errors that name the key. Every run writes the case with all defaults filled in to
`inputs.resolved.toml`. On the command line, `--set section.key=value` overrides one value, and
`pfemcut check CASE.toml` validates.

This page is written by `python scripts/case_file_reference.py` from `pfemcut/case/*schema.py` and `particles.py`.
"""
MATERIAL = """\
A material is a name in the library (`pfemcut materials`), a path to a material file (relative to the case file), or a
table: `{ base = "voce_steel", hardening = { flow_stress_softening = 0.0 } }` takes a library material and changes
some of its constants. `pfemcut materials NAME` prints a whole one.
"""
KINDS: tuple[tuple[str, type[BaseModel]], ...] = (
    ("An orthogonal cut", Case),
    ('A general problem (`problem = "general"`)', GeneralCase),
    ('Solids filled with particles (`problem = "solids"`)', SolidsCase),
    ('A composite lamina in tension (`problem = "lamina"`)', LaminaCase),
)


def main(arguments: Sequence[str]) -> int:
    """Write the page; the exit status."""
    path = Path(arguments[0]) if arguments else PAGE
    path.write_text(page(), encoding="utf-8")
    return 0


def page() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for title, case in KINDS:
        parts += [f"\n## {title}\n" if len(parts) > 1 else f"## {title}\n", *_sections(case, 3)]
        if case is Case:
            parts.append("\n" + MATERIAL.rstrip())
    return "\n".join(parts) + "\n"


def _sections(model: type[BaseModel], level: int, name: str = "") -> list[str]:
    """A model's own keys, then its tables, each with its heading."""
    fields = model.model_fields
    tables = {key: found for key, field in fields.items() if (found := _models(field.annotation))}
    own = {key: field for key, field in fields.items() if key not in tables}
    parts = [_table(own)] if own else []
    for key, found in tables.items():
        path = f"{name}.{key}" if name else key
        for at, (table, many) in enumerate(found):
            if at and issubclass(table, found[0][0]):
                own_keys = {k: f for k, f in table.model_fields.items() if k not in found[0][0].model_fields}
                parts += [
                    f"\n{'#' * level} [[{path}]]\n",
                    f"{(table.__doc__ or '').strip()} The keys of [{path}], and\n",
                    _table(own_keys),
                ]
                continue
            shown = f"[[{path}]]" if many else f"[{path}]"
            needed = "" if fields[key].is_required() else " It may be left out."
            parts += [
                f"\n{'#' * level} {shown}\n",
                f"{(table.__doc__ or '').strip()}{needed}\n",
                *_sections(table, level + 1, path),
            ]
    for key, field in own.items():
        for table in _alternatives(field):
            path = f"{name}.{key}" if name else key
            law = [repr(choices(f.annotation)[0]) for k, f in table.model_fields.items() if k == "law"]
            tag = "".join(f", law = {each}" for each in law).replace("'", '"')
            parts += [
                f"\n{'#' * level} [{path}]{tag}\n",
                f"{_first_lines(table)} In the place of a number.\n",
                *_sections(table, level + 1, path),
            ]
    return parts


def _first_lines(model: type[BaseModel]) -> str:
    """The first paragraph of a model's documentation."""
    return " ".join((model.__doc__ or "").split("\n\n")[0].split())


def _table(fields: dict[str, FieldInfo]) -> str:
    lines = ["| Key | Meaning | Allowed | Default |", "|---|---|---|---|"]
    lines += [
        f"| `{name}` | {field.description} | {allowed(field)} | {default(field)} |"
        for name, field in fields.items()
    ]
    return "\n".join(lines)


def _models(annotation: Any) -> list[tuple[type[BaseModel], bool]]:
    """The models of a field that holds tables and nothing else, and whether each is that of a list of tables."""
    if get_origin(annotation) is Annotated:
        return _models(get_args(annotation)[0])
    if get_origin(annotation) is tuple:
        return [(model, True) for model, _ in _models(get_args(annotation)[0])]
    if get_origin(annotation) in (Union, UnionType):
        found = [_models(each) for each in get_args(annotation) if each is not type(None)]
        return [pair for each in found for pair in each] if all(found) else []
    is_model = isinstance(annotation, type) and issubclass(annotation, BaseModel)
    return [(annotation, False)] if is_model else []


def _alternatives(field: FieldInfo) -> list[type[BaseModel]]:
    """The models of the tables that may stand in the place of a number and have keys of their own."""
    kinds = inner_types(field.annotation)
    models = [each for each in kinds if isinstance(each, type) and issubclass(each, BaseModel)]
    written = [kind_of(each) for each in models]
    return [model for model, kind in zip(models, written, strict=True) if float in kinds and kind == "table"]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
