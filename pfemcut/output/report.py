"""The report of a run: one HTML file with everything in it, made from the output directory alone."""

from __future__ import annotations

import base64
import json
import math
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from pfemcut.output.directory import FIGURES, HISTORY, INPUTS, REPORT, SUMMARY, OutputError
from pfemcut.output.figures import write_figures
from pfemcut.output.profile_figure import write_profile_figure
from pfemcut.output.progress import duration
from pfemcut.output.vtu import FieldsError, read_last_frame
from pfemcut.results.definitions import FIGURES as DEFINITIONS
from pfemcut.results.derived.steady_window import steady_window
from pfemcut.results.history import HistoryError, read_table

TEMPLATE = "report.html.j2"


def write_report(directory: Path) -> Path:
    """Draw the figures of a run again and write its report; return the report's path.

    Parameters
    ----------
    directory
        Output directory of a run, finished or stopped.

    Raises
    ------
    OutputError
        If the directory holds no run's results or they are damaged.
    """
    directory = Path(directory)
    summary = _summary(directory)
    inputs = _text(directory / INPUTS)
    pictures = _pictures(directory, inputs)
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    page = environment.get_template(TEMPLATE).render(
        summary=summary,
        duration=duration(summary["wall_time"]["value"]),
        results=[
            _result(item.label, item.meaning, summary[item.name])
            for item in DEFINITIONS
            if item.name in summary
        ],
        pictures=[
            {"name": path.stem, "data": base64.b64encode(path.read_bytes()).decode()} for path in pictures
        ],
        ledgers=_ledgers(summary["ledgers"]),
        inputs=inputs,
    )
    path = directory / REPORT
    temporary = path.with_name(path.name + ".tmp")
    temporary.write_text(page, encoding="utf-8")
    os.replace(temporary, path)
    return path


def significant(value: float, digits: int = 4) -> str:
    """Return ``value`` with so many significant digits, without an exponent where a reader needs none."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{digits - 1}e}" if places > 7 or places < -4 else f"{value:.{max(places, 0)}f}"


def figure_text(figure: Mapping[str, Any]) -> str:
    """Return a figure of the summary as text: mean ± standard deviation, or the value."""
    if "mean" not in figure:
        return significant(figure["value"])
    return f"{significant(figure['mean'])} ± {significant(figure['std'], 2)}"


def _pictures(directory: Path, inputs: str) -> list[Path]:
    try:
        history = read_table(directory / HISTORY)
        frame = read_last_frame(directory)
    except (HistoryError, FieldsError, OSError) as error:
        raise OutputError(str(error)) from error
    depth = float(tomllib.loads(inputs).get("cutting", {}).get("depth", 0.1))
    if not history or history["step"].size == 0:
        return []
    window = steady_window(history["travel"], history["cutting_force"])
    figures = write_figures(directory / FIGURES, frame, history, window, depth)
    return [*figures, *write_profile_figure(directory)]


def _result(label: str, meaning: str, figure: Mapping[str, Any]) -> dict[str, str]:
    return {"label": label, "meaning": meaning, "unit": figure["unit"], "value": figure_text(figure)}


def _ledgers(energies: Mapping[str, float]) -> list[dict[str, str]]:
    work = energies.get("tool_work", 0.0)
    return [
        {
            "label": name.replace("_", " "),
            "value": significant(value),
            "share": f"{value / work:.2%}" if work else "",
        }
        for name, value in energies.items()
    ]


def _summary(directory: Path) -> dict[str, Any]:
    path = directory / SUMMARY
    try:
        found = json.loads(_text(path))
    except json.JSONDecodeError as error:
        raise OutputError(f"{path}: damaged ({error})") from error
    return dict(found)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise OutputError(
            f"{path}: can't be read: {error.strerror}; is this the directory of a run?"
        ) from error
