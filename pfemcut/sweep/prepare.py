"""Every variant's case validated before anything starts, and how far its earlier run got."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import tomli_w

from pfemcut.case.check import warnings
from pfemcut.case.load import AnyCase, AnyMaterial, CaseError, directed, replaced, resolved_toml, validated
from pfemcut.case.schema import Case
from pfemcut.case.translate import problem_of
from pfemcut.inputs import InputError, UserError, read_toml
from pfemcut.output.directory import INPUTS, OutputError
from pfemcut.problem.course import Course
from pfemcut.results.checkpoint import NAME, PREVIOUS, changed_keys
from pfemcut.sweep.plan import Plan, Values, Variant
from pfemcut.validation.recorded_run import is_finished


class State(Enum):
    """How far a variant's run in its folder got."""

    NEW = "new"
    INTERRUPTED = "goes on"
    FINISHED = "finished"
    CHANGED = "of another case"


@dataclass(frozen=True)
class Prepared:
    """A variant that can run.

    Attributes
    ----------
    variant
        The variant.
    case, material
        Its validated case and material.
    base_directory
        Folder that the files which the case names lie in.
    directory
        Its output folder.
    parameters
        Values of all parameters of the sweep: the variant's own, else the base case's; None for what neither has.
    course
        How far its run is at each time.
    """

    variant: Variant
    case: AnyCase
    material: AnyMaterial
    base_directory: Path
    directory: Path
    parameters: Values
    course: Course

    @property
    def name(self) -> str:
        """The variant's name."""
        return self.variant.name


def prepared(plan: Plan) -> tuple[Prepared, ...]:
    """All variants of ``plan``, validated as ``pfemcut check`` does.

    Raises
    ------
    InputError
        With one line for each problem, which names the first variant that has it.
    """
    base = read_toml(plan.case)
    keys, folder = plan.keys, plan.case.parent

    def one(variant: Variant) -> Prepared:
        table: Mapping[str, Any] = base
        for key, value in {**plan.common, **variant.values}.items():
            table = replaced(table, key.split("."), value, f"given '{key}'")
        directory = plan.output / variant.name
        case, material = validated(table, folder)
        case = directed(case, directory)
        course = problem_of(case, material, folder).course
        resolved = tomllib.loads(resolved_toml(case, material))
        parameters = {key: _parameter(key, variant.values, table, resolved) for key in keys}
        return Prepared(variant, case, material, folder, directory, parameters, course)

    made: list[Prepared] = []
    found: list[tuple[str, str]] = []
    for variant in plan.variants:
        try:
            made.append(one(variant))
        except InputError as error:
            found += [(variant.name, problem) for problem in error.problems]
        except UserError as error:
            found.append((variant.name, str(error)))
    if found:
        raise CaseError(_grouped(found))
    return tuple(made)


def advice(variants: Iterable[Prepared]) -> list[str]:
    """Warnings of the cases, each once with the first variant that has it."""
    found = [(each.name, text) for each in variants for text in warnings(each.case, each.material)]
    return _grouped(found)


def states(variants: Iterable[Prepared]) -> tuple[State, ...]:
    """How far the runs in the variants' folders got."""
    return tuple(State.CHANGED if changes(each) else _state(each) for each in variants)


def require_unchanged(variants: Iterable[Prepared]) -> None:
    """Raise :class:`OutputError`, with a line for each change, if a folder holds the run of another case."""
    found = [
        (str(each.directory), f"the run of another case is there ({text})")
        for each in variants
        for text in changes(each)
    ]
    if found:
        told: dict[str, list[str]] = {}
        for name, text in found:
            told.setdefault(text, []).append(name)
        lines = [f"{', '.join(names)}: {text}" for text, names in told.items()]
        raise OutputError("\n".join([*lines, "--overwrite runs what changed from the start"]))


def changes(variant: Prepared) -> tuple[str, ...]:
    """What the run in the variant's folder has otherwise, as ``key: there -> wanted``.

    A run may be taken further, so a longer travel is no change; a shorter one is: the figures would be those of
    another window.
    """
    stored = _stored(variant)
    if not stored:
        return ()
    found = changed_keys(stored, resolved_toml(variant.case, variant.material))
    if isinstance(variant.case, Case):
        wanted, there = variant.case.cutting.travel, _travel(variant)
        if wanted < there:
            found = (*found, f"cutting.travel: {there!r} -> {wanted!r}")
    return found


def _state(variant: Prepared) -> State:
    directory = variant.directory
    whole = not isinstance(variant.case, Case) or (
        variant.case.cutting.travel == _travel(variant) and _after(variant) == _table(variant).get("after")
    )
    if _stored(variant) and whole and is_finished(directory):
        return State.FINISHED
    if any((directory / name).is_file() for name in (NAME, PREVIOUS)):
        return State.INTERRUPTED
    return State.NEW


def _stored(variant: Prepared) -> str:
    """The resolved case of the run in the variant's folder; empty without one."""
    path = variant.directory / INPUTS
    # Read by the one who says what is wrong with a damaged file.
    return tomli_w.dumps(read_toml(path)) if path.is_file() else ""


def _table(variant: Prepared) -> Mapping[str, Any]:
    """The resolved case, parsed, of the run in the variant's folder; empty without one."""
    path = variant.directory / INPUTS
    return read_toml(path) if path.is_file() else {}


def _travel(variant: Prepared) -> float:
    """Travel (mm) of the case of the run in the variant's folder; 0 without one."""
    return float(_table(variant).get("cutting", {}).get("travel", 0.0))


def _after(variant: Prepared) -> Mapping[str, Any] | None:
    """What the variant's case has after the cut, as a resolved case writes it; a run may be taken on to there."""
    after: Mapping[str, Any] | None = tomllib.loads(resolved_toml(variant.case, variant.material)).get(
        "after"
    )
    return after


def _parameter(key: str, given: Values, table: Mapping[str, Any], resolved: Mapping[str, Any]) -> Any:
    """The value at ``key`` that a variant has; text with a unit as the plain number that became of it."""
    value = given[key] if key in given else _looked_up(key, table, resolved)
    plain = _looked_up(key, resolved) if isinstance(value, str) else None
    return plain if isinstance(plain, float) else value


def _looked_up(key: str, *tables: Mapping[str, Any]) -> Any:
    """The value at ``key`` in the first table that has it; None if none has."""
    for table in tables:
        value: Any = table
        for part in key.split("."):
            if isinstance(value, Mapping):
                value = value.get(part)
            elif isinstance(value, list | tuple) and part in map(str, range(len(value))):
                value = value[int(part)]
            else:
                value = None
        if value is not None:
            return value
    return None


def _grouped(found: Iterable[tuple[str, str]]) -> list[str]:
    """Each text once, with the first name that it comes with and the number of the others."""
    names: dict[str, list[str]] = {}
    for name, text in found:
        names.setdefault(text, []).append(name)
    return [
        f"variant {first}{f' (and {len(others)} more)' if others else ''}: {text}"
        for text, (first, *others) in names.items()
    ]
