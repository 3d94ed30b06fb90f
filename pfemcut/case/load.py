"""From a case file and command-line overrides to a validated case and its material, and back to a file."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.inputs import InputError, explained, read_toml
from pfemcut.materials.load import load_material, material_table
from pfemcut.materials.material import Material
from pfemcut.peridynamics.lamina import Lamina
from pfemcut.peridynamics.load import lamina_of, lamina_table
from pfemcut.wear.load import wear_table

AnyCase = Case | GeneralCase | SolidsCase | LaminaCase
AnyMaterial = Material | Lamina
"""A lamina is no material of a solid: it has other constants."""

_KINDS: dict[Any, type[AnyCase]] = {"general": GeneralCase, "solids": SolidsCase, "lamina": LaminaCase}
_DEEPEST = 20  # tables in tables; no key of a case lies so deep


class CaseError(InputError):
    """A case that can't be run as given; one line a problem."""


def load_case(path: Path | str, overrides: Sequence[str] = ()) -> tuple[AnyCase, AnyMaterial]:
    """Read, override and validate a case file and the material it names.

    Parameters
    ----------
    path
        The case file.
    overrides
        ``section.key=value`` each; the value is read as TOML, or as text if it is not TOML.

    Raises
    ------
    CaseError
        With one line for each problem found.
    """
    path = Path(path)
    try:
        table = read_toml(path)
        for override in overrides:
            table = overridden(table, override)
        return validated(table, path.parent)
    except CaseError:
        raise
    except InputError as error:
        raise CaseError(error.problems) from None


def validated(table: Mapping[str, Any], base_directory: Path) -> tuple[AnyCase, AnyMaterial]:
    """The case and the material of an already parsed case file in ``base_directory``.

    Raises
    ------
    CaseError
        With one line for each problem found.
    """
    problems: list[str] = []
    # Other materials than the first body's, and wear constants, stay in the case as whole tables: it alone then makes
    # the problem.
    for written_out in (_with_materials, _with_wear, _with_lamina):
        try:
            table = written_out(table, base_directory)
        except InputError as error:
            problems += error.problems
    model = _model(table)
    try:
        case = model.model_validate(table)
    except ValidationError as error:
        problems += explained(error, model)
    # The material is looked at even when the rest is wrong, so that one try shows all problems.
    try:
        spec, section = _material_spec(table)
        if isinstance(spec, str | Mapping):
            material: AnyMaterial = load_material(spec, base_directory, section=section)
    except InputError as error:
        problems += error.problems
    if problems:
        raise CaseError(problems)
    if isinstance(case, LaminaCase):
        written: Any = case.lamina.material
        material = lamina_of(written)
    return case, material


def _model(table: Mapping[str, Any]) -> type[AnyCase]:
    """The schema of the kind of problem that ``table`` names."""
    kind = table.get("problem")
    return _KINDS.get(kind, Case) if isinstance(kind, str) else Case


def directed(case: AnyCase, directory: Path) -> AnyCase:
    """The case with ``directory`` as its output folder."""
    return case.model_copy(update={"output": case.output.model_copy(update={"directory": str(directory)})})


def _with_materials(table: Mapping[str, Any], base_directory: Path) -> Mapping[str, Any]:
    """``table`` with the materials of a deformable tool and of further bodies written out."""

    def written_out(holder: Any, section: str) -> Any:
        if not isinstance(holder, Mapping) or not isinstance(holder.get("material"), str | Mapping):
            return holder
        return {
            **holder,
            "material": material_table(load_material(holder["material"], base_directory, section=section)),
        }

    tool, bodies = table.get("tool"), table.get("body")
    if isinstance(tool, Mapping) and "body" in tool:
        table = {**table, "tool": {**tool, "body": written_out(tool["body"], "tool.body.material")}}
    if isinstance(bodies, list):
        others = [written_out(each, f"body.{i}.material") for i, each in enumerate(bodies[1:], 1)]
        table = {**table, "body": [*bodies[:1], *others]}
    return table


def _with_wear(table: Mapping[str, Any], base_directory: Path) -> Mapping[str, Any]:
    """``table`` with the tool's wear constants written out."""
    tool = table.get("tool")
    if not isinstance(tool, Mapping) or not isinstance(tool.get("wear"), str | Mapping):
        return table
    return {**table, "tool": {**tool, "wear": wear_table(tool["wear"], base_directory)}}


def _with_lamina(table: Mapping[str, Any], base_directory: Path) -> Mapping[str, Any]:
    """``table`` with a lamina's constants written out."""
    plate = table.get("lamina")
    if not isinstance(plate, Mapping) or not isinstance(plate.get("material"), str | Mapping):
        return table
    return {**table, "lamina": {**plate, "material": lamina_table(plate["material"], base_directory)}}


def _material_spec(table: Mapping[str, Any]) -> tuple[Any, str]:
    """What the case gives as material, and where it does."""
    if _model(table) is LaminaCase:
        return None, ""
    if _model(table) is not Case:
        bodies = table.get("body")
        holder, section = (bodies[0] if isinstance(bodies, list) and bodies else None), "body.material"
    else:
        holder, section = table.get("workpiece"), "workpiece.material"
    return (holder.get("material") if isinstance(holder, Mapping) else None), section


def overridden(table: Mapping[str, Any], override: str) -> dict[str, Any]:
    """A copy of ``table`` with one ``section.key=value`` applied.

    A key inside a material that is given by name turns the name into the ``base`` of a table; tables that come in
    numbers, such as ``[[body]]``, count from 0: ``body.0.name=strip``.

    Raises
    ------
    CaseError
        If the override has no key or value, or leads through something that is not a table.
    """
    target, equals, text = override.partition("=")
    keys = [key.strip() for key in target.split(".")]
    if not equals or not all(keys):
        raise CaseError([f"--set: given {override!r}, must be section.key=value"])
    return replaced(table, keys, toml_value(text), f"--set: given {override!r}")


def replaced(table: Mapping[str, Any], keys: Sequence[str], value: Any, origin: str) -> dict[str, Any]:
    """A copy of ``table`` with the value at the path ``keys`` replaced; see :func:`overridden`.

    Parameters
    ----------
    table
        A parsed case file.
    keys
        Section, key and so on.
    value
        The new value, as parsed TOML.
    origin
        What an error message begins with.

    Raises
    ------
    CaseError
        If the path leads through something that is not a table.
    """
    if len(keys) > _DEEPEST:
        raise CaseError([f"{origin}, but no key lies {len(keys)} tables deep"])

    def inner(inside: Any, depth: int) -> Any:
        if depth == len(keys):
            return value
        if isinstance(inside, str) and _is_material(keys[:depth]):
            inside = {"base": inside}
        if isinstance(inside, list):
            if keys[depth] not in map(str, range(len(inside))):
                limit = f"must have a number below {len(inside)} after '{'.'.join(keys[:depth])}'"
                raise CaseError([f"{origin}, {limit}"])
            at = int(keys[depth])
            return [*inside[:at], inner(inside[at], depth + 1), *inside[at + 1 :]]
        if not isinstance(inside, Mapping):
            raise CaseError([f"{origin}, but '{'.'.join(keys[:depth])}' is not a table"])
        return {**inside, keys[depth]: inner(inside.get(keys[depth], {}), depth + 1)}

    return inner(table, 0)


def _is_material(keys: Sequence[str]) -> bool:
    match list(keys):
        case ["workpiece" | "lamina", "material"] | ["body", _, "material"] | ["tool", "body", "material"]:
            return True
    return False


def toml_value(text: str) -> Any:
    """``text`` read as a TOML value, or itself if it is none."""
    try:
        document = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):  # a TOMLDecodeError is a ValueError
        return text
    # Anything beyond one value (a line break smuggled in) is no value.
    return document["value"] if list(document) == ["value"] else text


def solid(material: AnyMaterial) -> Material:
    """``material`` of a case that is no lamina."""
    assert isinstance(material, Material)
    return material


def resolved_toml(case: AnyCase, material: AnyMaterial) -> str:
    """Case file with every default written out and the material inlined: it alone reproduces the run."""
    table = case.model_dump()
    if isinstance(case, LaminaCase):
        return tomli_w.dumps(_without_none(table))
    holder = table["workpiece"] if isinstance(case, Case) else table["body"][0]
    holder["temperature"] = initial_temperature(case, solid(material))
    # Last, so that its sub-table does not swallow the keys behind it.
    del holder["material"]
    holder["material"] = material_table(solid(material))
    return tomli_w.dumps(_without_none(table))


def _without_none(value: Any) -> Any:
    """``value`` without table entries that are None, which TOML has no word for."""
    if isinstance(value, dict):
        return {key: _without_none(inner) for key, inner in value.items() if inner is not None}
    if isinstance(value, list | tuple):
        return [_without_none(inner) for inner in value]
    return value


def initial_temperature(case: Case | GeneralCase | SolidsCase, material: Material) -> float:
    """Temperature (K) of the body at time zero."""
    given = (case.workpiece if isinstance(case, Case) else case.body[0]).temperature
    return material.reference_temperature if given is None else given
