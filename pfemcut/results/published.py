"""Published figures of a demo (``published.toml``) beside the computed ones.

The file has one table a figure, named as in ``summary.json``::

    [max_temperature]
    value = 810.0
    unit = "K"
    tolerance = 25.0        # absolute, in the same unit; left out where there is no target
    source = "Rodriguez et al. 2017, section 7.2"
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, Field, ValidationError
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from pfemcut.inputs import InputError, InputModel, explained, nearest, read_toml
from pfemcut.results.definitions import FIGURES
from pfemcut.results.derived.free_surface import FREE_SURFACE_TEMPERATURE
from pfemcut.results.summary import Summary

KNOWN = {item.name: item for item in (*FIGURES, FREE_SURFACE_TEMPERATURE)}
"""Figures that can be compared: those of the summary, and what only papers ask for."""

ALWAYS_SHOWN = (
    "cutting_force",
    "thrust_force",
    "chip_thickness",
    "contact_length",
    "shear_angle",
    "shear_angle_band",
    "max_temperature",
    "contact_end_temperature",
)
"""Figures that a comparison shows even if nothing is published of them."""


_LOG_WIDTH = 120


class PublishedFigure(InputModel):
    """One published figure."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    value: float = Field(description="Published value")
    unit: str = Field(min_length=1, description="Its unit, the same as in summary.json")
    tolerance: float | None = Field(
        default=None, gt=0, description="Absolute tolerance in that unit; none if left out"
    )
    source: str = Field(min_length=1, description="Where it is published")


class Verdict(Enum):
    """What a comparison says of one figure."""

    WITHIN = "within tolerance"
    OUTSIDE = "outside tolerance"
    NO_TARGET = "no target"
    NOT_COMPUTED = "not computed"


@dataclass(frozen=True)
class Row:
    """One figure, published and computed; what isn't known is None.

    Attributes
    ----------
    name, label, unit
        See :class:`pfemcut.results.definitions.Definition`.
    published, tolerance, source
        See :class:`PublishedFigure`.
    computed, std
        Mean and standard deviation over the steady window, or the last value without deviation.
    difference
        (computed − published) / published.
    verdict
        A published figure with a tolerance that wasn't computed counts as failed.
    """

    name: str
    label: str
    unit: str
    published: float | None
    tolerance: float | None
    source: str | None
    computed: float | None
    std: float | None
    difference: float | None
    verdict: Verdict

    @property
    def failed(self) -> bool:
        """Whether there is a target and the figure misses it."""
        return self.verdict is Verdict.OUTSIDE or (
            self.verdict is Verdict.NOT_COMPUTED and self.tolerance is not None
        )


def load_published(path: Path | str) -> dict[str, PublishedFigure]:
    """Read and validate ``published.toml``; figures by name, in the file's order.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    path = Path(path)
    problems: list[str] = []
    figures: dict[str, PublishedFigure] = {}
    for name, table in read_toml(path).items():
        if name not in KNOWN:
            problems.append(f"{path}: [{name}]: unknown figure{nearest(name, KNOWN)}")
            continue
        try:
            figure = PublishedFigure.model_validate(table)
        except ValidationError as error:
            problems += [f"{path}: {line}" for line in explained(error, PublishedFigure, name)]
            continue
        if figure.unit != KNOWN[name].unit:
            problems.append(f"{path}: [{name}] unit: given '{figure.unit}', must be '{KNOWN[name].unit}'")
        figures[name] = figure
    if problems:
        raise InputError(problems)
    return figures


def compare(
    published: Mapping[str, PublishedFigure], summary: Summary | Mapping[str, Any]
) -> tuple[Row, ...]:
    """Published figures, then the main ones that aren't published, in the order of the definitions.

    Parameters
    ----------
    published
        From :func:`load_published`.
    summary
        A run's summary, or the content of its ``summary.json``.
    """
    figures = summary.to_json() if isinstance(summary, Summary) else summary
    names = [name for name in KNOWN if name in published or (name in ALWAYS_SHOWN and name in figures)]
    return tuple(_row(name, published.get(name), figures.get(name)) for name in names)


def comparison_table(title: str, rows: Sequence[Row]) -> Table:
    """The rows as a table for the terminal."""
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    table.add_column("figure")
    for heading in ("published", "computed", "difference"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    styles = {Verdict.WITHIN: "green", Verdict.OUTSIDE: "red", Verdict.NOT_COMPUTED: "yellow"}
    for row in rows:
        table.add_row(
            row.label,
            published_text(row),
            computed_text(row),
            "" if row.difference is None else f"{row.difference:+.1%}",
            row.verdict.value,
            style=styles.get(row.verdict, ""),
        )
    return table


def print_comparison(title: str, rows: Sequence[Row], console: Console | None = None) -> None:
    """Print the rows."""
    if console is None:
        console = Console()
        if not console.is_terminal:
            console = Console(width=_LOG_WIDTH)
    console.print(comparison_table(title, rows))


def comparison_json(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The rows as JSON."""
    return [{**asdict(row), "verdict": row.verdict.value} for row in rows]


def published_text(row: Row) -> str:
    """``810 ± 25 K``, or nothing."""
    return _text(row.published, row.tolerance, row.unit)


def computed_text(row: Row) -> str:
    """``812 ± 3 K``, or nothing."""
    return _text(row.computed, row.std, row.unit)


def _text(value: float | None, spread: float | None, unit: str) -> str:
    if value is None:
        return ""
    shown = f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    spread_text = "" if spread is None else f" ± {spread:.2g}"
    return f"{shown}{spread_text}{'' if unit == '-' else ' ' + unit}"


def _row(name: str, target: PublishedFigure | None, figure: Mapping[str, Any] | None) -> Row:
    computed = None if figure is None else float(figure.get("mean", figure.get("value", math.nan)))
    if computed is not None and not math.isfinite(computed):
        computed = None
    std = None if figure is None or "std" not in figure else float(figure["std"])
    value = None if target is None else target.value
    tolerance = None if target is None else target.tolerance
    difference = None
    if computed is not None and value:
        difference = (computed - value) / value
    if computed is None:
        verdict = Verdict.NOT_COMPUTED
    elif value is None or tolerance is None:
        verdict = Verdict.NO_TARGET
    else:
        verdict = Verdict.WITHIN if abs(computed - value) <= tolerance else Verdict.OUTSIDE
    return Row(
        name,
        KNOWN[name].label,
        KNOWN[name].unit,
        value,
        tolerance,
        None if target is None else target.source,
        computed,
        std,
        difference,
        verdict,
    )
