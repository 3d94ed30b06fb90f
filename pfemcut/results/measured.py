"""Measured figures and force curves from CSV files.

A file of figures has one row a figure, named as in ``summary.json``; uncertainty (one standard deviation) and source
may be left out. Columns with a dot name what a row's cut changes in a case, so that one file can hold several cuts::

    figure,value,uncertainty,unit,source,cutting.speed
    cutting_force,395,12,N/mm,"own test 3",5000
    chip_thickness,0.32,0.01,mm,"own test 3",5000

A file of a curve has forces per width (N/mm) against the travel of the tool (mm)::

    travel,cutting_force,thrust_force
    0.001,12.5,8.1

A column that tells cuts apart may have its unit in brackets, ``cutting.speed (m/min)``, or in each cell, as in case
files. Lines that begin with ``#`` and empty lines are skipped.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import toml_value
from pfemcut.inputs import InputError, nearest
from pfemcut.results.derived.steady_window import steady_window
from pfemcut.results.published import KNOWN

Array = NDArray[np.float64]

COLUMNS = ("figure", "value", "uncertainty", "unit", "source")
REQUIRED = ("figure", "value", "unit")
TRAVEL = "travel"
FORCES = ("cutting_force", "thrust_force")

SAME_UNITS = {
    "N/mm2": "N/mm²",
    "N/mm^2": "N/mm²",
    "MPa": "N/mm²",
    "deg": "degree",
    "degrees": "degree",
    "°": "degree",
    "": "-",
    "1": "-",
    "s^-1": "1/s",
    "mm^-1": "1/mm",
}
"""Other ways to write a unit, of the same size."""
_UNIT = re.compile(r"\s*(\(.*\)|\[.*\])\s*$")


@dataclass(frozen=True)
class MeasuredFigure:
    """One measured figure.

    Attributes
    ----------
    name, unit
        As in :data:`pfemcut.results.published.KNOWN`.
    value, uncertainty
        Value and standard deviation; the latter is nan if it isn't given.
    source
        Where it comes from; may be empty.
    changes
        What its cut changes in a case, by ``section.key``.
    """

    name: str
    value: float
    uncertainty: float
    unit: str
    source: str
    changes: Mapping[str, Any]


@dataclass(frozen=True)
class Curve:
    """Forces per width against travel.

    Attributes
    ----------
    travel
        mm, never falling; shape (rows,).
    forces
        Cutting or thrust force or both (N/mm) by name; each of shape (rows,).
    """

    travel: Array
    forces: Mapping[str, Array]

    def means(self) -> dict[str, tuple[float, float]]:
        """Mean and standard deviation of each force over the steady window, that of a run with this curve."""
        leading = next(name for name in FORCES if name in self.forces)
        window = steady_window(self.travel, self.forces[leading])
        return {name: (window.mean(values), window.std(values)) for name, values in self.forces.items()}


@dataclass(frozen=True)
class Measured:
    """Content of a file: figures, and the curve that they are of if it holds one."""

    figures: tuple[MeasuredFigure, ...]
    curve: Curve | None


def load_measured(path: Path) -> Measured:
    """Read a CSV file of figures or of a curve; a curve's figures are its means over the steady window.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    lines = _lines(path)
    if not lines:
        raise InputError([f"{path}: is empty"])
    header = [name.strip() for name in lines[0][1]]
    bare = [_bare(name) for name in header]
    twice = sorted({name for name in bare if bare.count(name) > 1})
    if twice:
        raise InputError(f"{path}: column '{name}' is there twice" for name in twice)
    rows: list[tuple[int, dict[str, str]]] = []
    problems: list[str] = []
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            problems.append(f"{path}: line {number}: has {len(cells)} values, the header {len(header)}")
        else:
            rows.append((number, dict(zip(header, (cell.strip() for cell in cells), strict=True))))
    if problems:
        raise InputError(problems)
    if not rows:
        raise InputError([f"{path}: has a header and no values"])
    if _bare(header[0]) == TRAVEL:
        curve = _curve(path, header, rows)
        figures = tuple(
            MeasuredFigure(name, mean, std if std > 0.0 else math.nan, KNOWN[name].unit, path.name, {})
            for name, (mean, std) in curve.means().items()
        )
        return Measured(figures, curve)
    return Measured(_figures(path, header, rows), None)


def cuts_of(figures: Sequence[MeasuredFigure]) -> list[tuple[Mapping[str, Any], tuple[MeasuredFigure, ...]]]:
    """The figures of each cut with what it changes, in the order of the file."""
    found: dict[tuple[tuple[str, Any], ...], list[MeasuredFigure]] = {}
    for figure in figures:
        # 5000 and 5000.0 are one value.
        values = (
            (key, each if type(each) in (int, float) else repr(each)) for key, each in figure.changes.items()
        )
        found.setdefault(tuple(values), []).append(figure)
    return [(members[0].changes, tuple(members)) for members in found.values()]


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Number and cells of each line that says something."""
    if path.is_dir():
        raise InputError([f"{path}: is a directory, not a CSV file"])
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError([f"{path}: no such file"]) from None
    except UnicodeDecodeError as error:
        raise InputError([f"{path}: not UTF-8 text (byte {error.start})"]) from None
    except OSError as error:
        raise InputError([f"{path}: can't be read: {error.strerror}"]) from None
    numbered = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    kept = [(number, line) for number, line in numbered if not line.lstrip().startswith("#")]
    try:
        return [(number, next(csv.reader([line], strict=True))) for number, line in kept]
    except csv.Error as error:
        raise InputError([f"{path}: {error}"]) from None


def _figures(
    path: Path, header: Sequence[str], rows: Sequence[tuple[int, Mapping[str, str]]]
) -> tuple[MeasuredFigure, ...]:
    problems = [f"{path}: column '{name}' is missing" for name in REQUIRED if name not in header]
    problems += [
        f"{path}: column '{name}': units stand in the column 'unit', a row a figure"
        if _bare(name) in COLUMNS
        else f"{path}: unknown column '{name}'{nearest(name, COLUMNS)}"
        for name in header
        if name not in COLUMNS and "." not in _bare(name)
    ]
    if problems:
        raise InputError(problems)
    figures: list[MeasuredFigure] = []
    for number, row in rows:
        place, name = f"{path}: line {number}", row["figure"]
        changes = {_bare(key): _changed(text, _unit(key)) for key, text in row.items() if "." in key and text}
        value, wrong = _number(row["value"])
        problems += [f"{place}: value: {wrong}"] if wrong else []
        uncertainty, wrong = _number(row.get("uncertainty", "")) if row.get("uncertainty") else (math.nan, "")
        problems += [f"{place}: uncertainty: {wrong}"] if wrong else []
        if uncertainty <= 0.0:
            problems.append(
                f"{place}: uncertainty: given {uncertainty:g}, must be greater than 0, or left out"
            )
        if name not in KNOWN:
            problems.append(f"{place}: unknown figure '{name}'{nearest(name, KNOWN)}")
            continue
        unit = SAME_UNITS.get(row["unit"], row["unit"])
        if unit != KNOWN[name].unit:
            problems.append(f"{place}: unit of {name}: given '{row['unit']}', must be '{KNOWN[name].unit}'")
        figures.append(MeasuredFigure(name, value, uncertainty, unit, row.get("source", ""), changes))
    for of_cut, members in cuts_of(figures):
        names = [member.name for member in members]
        cut = ", ".join(f"{key} = {value}" for key, value in of_cut.items())
        problems += [
            f"{path}: {name} is there twice{f' for {cut}' if cut else ''}: give their mean"
            for name in sorted({name for name in names if names.count(name) > 1})
        ]
    if problems:
        raise InputError(problems)
    return tuple(figures)


def _curve(path: Path, header: Sequence[str], rows: Sequence[tuple[int, Mapping[str, str]]]) -> Curve:
    units = {TRAVEL: "mm", **{name: "N/mm" for name in FORCES}}
    problems = [
        f"{path}: unknown column '{name}'{nearest(_bare(name), units)}"
        for name in header
        if _bare(name) not in units
    ]
    problems += [
        f"{path}: unit of {_bare(name)}: given '{_unit(name)}', must be '{units[_bare(name)]}'"
        for name in header
        if _bare(name) in units and _unit(name) not in ("", units[_bare(name)])
    ]
    if not problems and len(header) < 2:
        problems.append(f"{path}: has no force: add a column cutting_force or thrust_force")
    columns: dict[str, list[float]] = {_bare(name): [] for name in header}
    for number, row in rows:
        for name, text in row.items():
            value, wrong = _number(text)
            problems += [f"{path}: line {number}: {_bare(name)}: {wrong}"] if wrong else []
            columns[_bare(name)].append(value)
    if not problems and np.any(np.diff(columns[TRAVEL]) < 0.0):
        number = rows[int(np.argmax(np.diff(columns[TRAVEL]) < 0.0)) + 1][0]
        problems.append(f"{path}: line {number}: travel must not fall")
    if problems:
        raise InputError(problems)
    arrays = {name: np.array(values) for name, values in columns.items()}
    return Curve(arrays[TRAVEL], {name: arrays[name] for name in FORCES if name in arrays})


def _number(text: str) -> tuple[float, str]:
    """A finite number, or nan and what is wrong with it."""
    try:
        value = float(text)
    except ValueError:
        return math.nan, f"given '{text}', must be a number"
    return (value, "") if math.isfinite(value) else (math.nan, f"given '{text}', must be a finite number")


def _changed(text: str, unit: str) -> Any:
    """What a cell changes in a case: a number with the unit of its column as text, which cases take."""
    value = toml_value(text)
    return f"{text} {unit}" if unit and type(value) in (int, float) else value


def _bare(name: str) -> str:
    """The name of a column without the unit in brackets behind it."""
    return _UNIT.sub("", name).strip()


def _unit(name: str) -> str:
    """The unit in brackets behind the name of a column; empty without one."""
    found = _UNIT.search(name)
    return found[0].strip()[1:-1].strip() if found else ""
