"""What is compared: runs (by ``history.csv`` and ``summary.json`` alone), published tables, measurements."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from pfemcut.case.load import replaced, resolved_toml, validated
from pfemcut.inputs import InputError, read_toml
from pfemcut.output.directory import HISTORY, INPUTS, SUMMARY
from pfemcut.results.history import HistoryError, read_table
from pfemcut.results.measured import FORCES, TRAVEL, Array, Curve, cuts_of, load_measured
from pfemcut.results.published import KNOWN, load_published
from pfemcut.results.summary import summarise
from pfemcut.results.summary_file import SummaryError, read_summary_file
from pfemcut.sweep.plan import Values

TELLS_NOTHING = ("results", "out")
"""Folders that are called after the one that they are in."""
SKIPPED = ("steady", "steps", "wall_time")
"""Figures of the run rather than of the cut."""
NEEDED = {"step", TRAVEL, "cutting_force"}
"""Columns without which a history has no figures."""
_NO_ROWS = np.zeros(0)


class Kind(Enum):
    """What a source is; the value says what its spread means."""

    RUN = "standard deviation over the window"
    PUBLISHED = "tolerance"
    MEASURED = "uncertainty"


@dataclass(frozen=True)
class Entry:
    """A figure of a source; its spread is nan if it isn't known."""

    value: float
    spread: float
    unit: str


@dataclass(frozen=True)
class Source:
    """One of the things that are compared.

    Attributes
    ----------
    label
        Its name in table and plot.
    kind
        What it is.
    entries
        Its figures by name.
    curve
        Its forces against travel, if it has them.
    notes
        What a reader must know of it.
    """

    label: str
    kind: Kind
    entries: Mapping[str, Entry]
    curve: Curve | None
    notes: tuple[str, ...] = ()


def read_sources(paths: Sequence[Path]) -> tuple[Source, ...]:
    """The sources at these paths, with different labels.

    A folder is a run, a ``.toml`` file a published table, a ``.csv`` file a measurement. Of a measurement with several
    cuts, that of the first run is taken.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    problems: list[str] = []
    sources: list[Source] = []
    first_run = next((path for path in paths if path.is_dir()), None)
    for path, label in zip(paths, labels_of(paths), strict=True):
        try:
            sources.append(replace(_source(path, first_run), label=label))
        except InputError as error:
            problems += error.problems
    if not problems:
        problems = _unit_problems(sources)
    if problems:
        raise InputError(problems)
    return tuple(sources)


def labels_of(paths: Sequence[Path]) -> list[str]:
    """The parts of each path that tell it from the others."""
    parts = [path.resolve().parts for path in paths]
    if len(set(parts)) < len(parts):
        twice = next(path for path, own in zip(paths, parts, strict=True) if parts.count(own) > 1)
        raise InputError([f"{twice}: is given twice"])
    runs = [own for path, own in zip(paths, parts, strict=True) if path.is_dir()]
    # A last folder that all runs share (``results``) tells nothing, nor does one that many runs have.
    shared = {own[-1] for own in runs} if len(runs) > 1 else {own[-1] for own in runs} & set(TELLS_NOTHING)
    cut = len(shared) == 1
    telling = [own[:-1] if cut and own in runs and len(own) > 2 else own for own in parts]
    labels = []
    for index, own in enumerate(telling):
        others = [*telling[:index], *telling[index + 1 :]]
        count = next(
            (n for n in range(1, len(own)) if all(each[-n:] != own[-n:] for each in others)), len(own)
        )
        labels.append("/".join(own[-count:]))
    return labels


def _source(path: Path, first_run: Path | None) -> Source:
    if path.is_dir():
        return _run(path)
    if path.suffix == ".toml":
        published = load_published(path)
        entries = {
            name: Entry(each.value, math.nan if each.tolerance is None else each.tolerance, each.unit)
            for name, each in published.items()
        }
        return Source("", Kind.PUBLISHED, entries, None)
    if path.suffix == ".csv":
        return _measurement(path, first_run)
    if path.exists():
        raise InputError([f"{path}: must be the folder of a run, a .toml table or a .csv file"])
    raise InputError([f"{path}: no such file or folder"])


def _run(directory: Path) -> Source:
    columns = _columns(directory / HISTORY)
    forces = {name: columns[name] for name in FORCES if name in columns}
    curve = Curve(columns[TRAVEL], forces) if forces and columns.get(TRAVEL, _NO_ROWS).size else None
    path = directory / SUMMARY
    if path.is_file():
        content = _json(path)
        notes = [] if content.get("finished", True) else [str(content.get("ending", "not finished"))]
        notes += [str(text) for text in content.get("warnings") or ()]
    elif curve is not None and columns.keys() >= NEEDED:
        unfinished = summarise(columns, {}, title="", finished=False, ending="")
        content, notes = unfinished.to_json(), ["has no summary: means of what its history has so far"]
    else:
        raise InputError([f"{directory}: no results here ({SUMMARY} and {HISTORY} are missing or empty)"])
    return Source("", Kind.RUN, _entries(path, content), curve, tuple(notes))


def _columns(history: Path) -> dict[str, Array]:
    try:
        return read_table(history) if history.is_file() else {}
    except HistoryError as error:
        raise InputError([str(error)]) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError([f"{history}: can't be read: {error}"]) from None


def _json(path: Path) -> dict[str, Any]:
    try:
        return read_summary_file(path)
    except SummaryError as error:
        raise InputError([str(error)]) from None


def _entries(path: Path, content: Mapping[str, Any]) -> dict[str, Entry]:
    """All figures of a summary, also those that only its method knows."""
    found = {}
    for name, figure in content.items():
        if name in SKIPPED or not isinstance(figure, Mapping) or "unit" not in figure:
            continue
        try:
            value = float(figure.get("mean", figure.get("value", math.nan)))
            found[name] = Entry(value, float(figure.get("std", math.nan)), str(figure["unit"]))
        except (TypeError, ValueError):
            raise InputError([f"{path}: {name}: has no number"]) from None
    return {name: entry for name, entry in found.items() if math.isfinite(entry.value)}


def _measurement(path: Path, first_run: Path | None) -> Source:
    measured = load_measured(path)
    cuts = cuts_of(measured.figures)
    notes: tuple[str, ...] = ()
    if any(changes for changes, _ in cuts):
        inputs = None if first_run is None else first_run / INPUTS
        if inputs is None or not inputs.is_file():
            raise InputError([f"{path}: has cuts of its own, and there is no {INPUTS} to choose one by"])
        fitting = [cut for cut in cuts if _is_of(inputs, cut[0], path)]
        if not fitting:
            varied = sorted({key for changes, _ in cuts for key in changes})
            raise InputError([f"{path}: none of its cuts has the {', '.join(varied)} of {first_run}"])
        left = len(cuts) - len(fitting)
        notes = (f"other cuts in the file, left out: {left}",) if left else ()
        cuts = fitting
    entries = {
        figure.name: Entry(figure.value, figure.uncertainty, figure.unit)
        for _, figures in cuts
        for figure in figures
    }
    return Source("", Kind.MEASURED, entries, measured.curve, notes)


def _is_of(inputs: Path, changes: Values, path: Path) -> bool:
    """Whether a cut's ``changes`` are what the resolved case ``inputs`` of a run has.

    Raises
    ------
    InputError
        If a case can't have these values, such as lengths for a speed.
    """
    of_run = read_toml(inputs)
    return all(_same(of_run, key, value, inputs, path) for key, value in changes.items())


def _same(of_run: Mapping[str, Any], key: str, wanted: Any, inputs: Path, path: Path) -> bool:
    value = _at(of_run, key)
    if isinstance(wanted, str) and wanted != value:
        # As text a number with its unit, or a name: what a case makes of it is compared.
        changed = replaced(of_run, key.split("."), wanted, f"{path}: column '{key}'")
        try:
            case, material = validated(changed, inputs.parent)
        except InputError as error:
            raise InputError(f"{path}: {problem}" for problem in error.problems) from None
        wanted = _at(tomllib.loads(resolved_toml(case, material)), key)
    return _alike(value, wanted)


def _at(table: Mapping[str, Any], key: str) -> Any:
    """The value at a path of keys; None without one."""
    value: Any = table
    for part in key.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    return value


def _alike(one: Any, other: Any) -> bool:
    """Whether two parsed tables are equal, numbers but for round-off."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_alike(value, other[key]) for key, value in one.items())
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_alike, one, other))
    if type(one) in (int, float) and type(other) in (int, float):
        return math.isclose(one, other, rel_tol=1e-9)
    return bool(one == other)


def _unit_problems(sources: Sequence[Source]) -> list[str]:
    """Figures that sources have in different units."""
    seen: dict[str, tuple[str, str]] = {name: (item.unit, "") for name, item in KNOWN.items()}
    problems = []
    for source in sources:
        for name, entry in source.entries.items():
            unit, where = seen.setdefault(name, (entry.unit, f" as in {source.label}"))
            if entry.unit != unit:
                problems.append(
                    f"{source.label}: unit of {name}: given '{entry.unit}', must be '{unit}'{where}"
                )
    return problems
