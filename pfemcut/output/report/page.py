"""Puts the page of a report together: figures drawn again, tables, and the template."""

from __future__ import annotations

import base64
import io
import math
import time
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from numpy.typing import NDArray
from PIL import Image

from pfemcut.case.check import warnings
from pfemcut.case.load import validated
from pfemcut.inputs import InputError
from pfemcut.method import Frame
from pfemcut.output.directory import FIGURES, HISTORY, INPUTS, REPORT, SUMMARY, OutputError
from pfemcut.output.figures import write_figures
from pfemcut.output.lamina_figures import write_lamina_figures
from pfemcut.output.profile_figure import write_profile_figure
from pfemcut.output.progress import duration
from pfemcut.output.report.animation import NAME as ANIMATION
from pfemcut.output.report.animation import write_animation
from pfemcut.output.report.convergence import convergence_rows
from pfemcut.output.report.history_figures import write_history_figures
from pfemcut.output.report.inputs import tables
from pfemcut.output.report.ledgers import Ledger, energy_ledger, heat_ledger
from pfemcut.output.report.registry import Picture, Section, found_pictures, found_tables
from pfemcut.output.report.results import HEADLINES, check_rows, result_rows
from pfemcut.output.scales import Scales
from pfemcut.output.surface_pictures import write_surface_pictures
from pfemcut.output.vtu import FieldsError, read_last_frame
from pfemcut.results.derived.steady_window import SteadyWindow, steady_window
from pfemcut.results.history import HistoryError, read_table
from pfemcut.results.summary_file import SummaryError, read_summary_file, required
from pfemcut.whole_files import write_text

Array = NDArray[np.float64]

TEMPLATE = "report.html.j2"
QUALITY = 88
"""Of the pictures in the page (WebP), which makes them a third of the PNG files beside it."""
SHOWN = ("title", "finished", "ending", "warnings", "steps", "wall_time", "travel", "versions")
"""What the page shows of every summary."""


@dataclass(frozen=True)
class Embedded:
    """A picture with its content and size (pixels), and whether it is an animation."""

    caption: str
    name: str
    source: str
    width: int
    height: int
    moving: bool


def write_report(
    directory: Path,
    *,
    animation: bool = True,
    scales: Scales | None = None,
    summary: Mapping[str, Any] | None = None,
) -> Path:
    """Draw the figures of a run again and write its report; return the report's path.

    Parameters
    ----------
    directory
        Output directory of a run, finished or stopped.
    animation
        Whether to draw the animation of the chip too.
    scales
        Colour scales of fields that replace their own.
    summary
        Content of the summary of a run that has not written one.

    Raises
    ------
    OutputError
        If the directory holds no run's results or they are damaged.
    """
    directory = Path(directory)
    summary = _summary(directory) if summary is None else summary
    inputs = _text(directory / INPUTS)
    try:
        given = tomllib.loads(inputs)
        history, frame = read_table(directory / HISTORY), read_last_frame(directory, until=_cut_end(given))
        if history and history["step"].size:
            _draw(directory, summary, given, history, frame, animation=animation, scales=scales or {})
        page = _page(directory, summary, inputs, given, history)
    except (HistoryError, FieldsError, tomllib.TOMLDecodeError, OSError) as error:
        raise OutputError(f"{directory}: {error}") from error
    path = directory / REPORT
    write_text(path, page)
    return path


def _draw(
    directory: Path,
    summary: Mapping[str, Any],
    given: Mapping[str, Any],
    history: Mapping[str, Array],
    frame: Frame,
    *,
    animation: bool,
    scales: Scales,
) -> None:
    figures = directory / FIGURES
    depth = float(given.get("cutting", {}).get("depth", math.nan))
    if "lamina" in given:
        write_lamina_figures(figures, frame, history, given)
    else:
        write_figures(figures, frame, history, _window(history), depth, scales)
        write_history_figures(figures, history)
    write_profile_figure(directory)
    write_surface_pictures(directory, summary)
    # One of an earlier state would stay.
    (figures / ANIMATION).unlink(missing_ok=True)
    if animation and not math.isnan(depth):
        write_animation(directory, figures, depth, scales)


def _page(
    directory: Path,
    summary: Mapping[str, Any],
    inputs: str,
    given: Mapping[str, Any],
    history: Mapping[str, Array],
) -> str:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    rows = bool(history) and history["step"].size > 0
    sections, materials = tables(inputs)
    figures = directory / FIGURES
    pictures = found_pictures(figures)
    results = result_rows(summary, history, _window(history)) if rows else []
    inertia = bool(given.get("time", {}).get("inertia", False)) or "lamina" in given
    by_name = {row.name: row for row in results}
    return environment.get_template(TEMPLATE).render(
        summary=summary,
        cut="cutting" in given,
        lamina="lamina" in given,
        choices=_choices(given, directory),
        written=time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime()),
        duration=duration(summary["wall_time"]["value"]),
        window=_window(history) if rows else SteadyWindow(0.0, 0.0, np.zeros(0), 0.0, 0.0, False, ""),
        sections=sections,
        materials=materials,
        results=results,
        headlines=[by_name[name] for name in HEADLINES if name in by_name],
        checks=check_rows(summary),
        ledgers=_ledgers(history, inertia=inertia) if rows else [],
        convergence=convergence_rows(history) if rows else [],
        pictures={
            section.value: [_embedded(figures, each) for each in pictures[section]] for section in Section
        },
        tables={section.value: found for section, found in found_tables(directory).items()},
        inputs=inputs,
        inputs_link=_data("text/plain;charset=utf-8", inputs.encode()),
    )


def _choices(given: Mapping[str, Any], directory: Path) -> list[str]:
    """What ``pfemcut check`` warns of in the case; nothing of a case that this version can't read."""
    try:
        return warnings(*validated(given, directory))
    except InputError:
        return []


def _cut_end(given: Mapping[str, Any]) -> float:
    """When a cut ends (s), of which the pictures show it under load; inf for other problems."""
    cutting = given.get("cutting", {})
    return float(cutting.get("travel", math.inf)) / float(cutting.get("speed", 1.0))


def _window(history: Mapping[str, Array]) -> SteadyWindow:
    return steady_window(history["travel"], history["cutting_force"])


def _embedded(figures: Path, picture: Picture) -> Embedded:
    path = figures / picture.file
    content = path.read_bytes()
    with Image.open(path) as image:
        width, height = image.size
        media = Image.MIME[image.format or "PNG"]
        if media == "image/png":
            buffer = io.BytesIO()
            image.convert("RGB").save(buffer, format="WEBP", quality=QUALITY, method=4)
            if buffer.tell() < len(content):
                content, media = buffer.getvalue(), "image/webp"
    return Embedded(
        picture.caption, path.stem, _data(media, content), width, height, picture.file == ANIMATION
    )


def _ledgers(history: Mapping[str, Array], *, inertia: bool) -> list[tuple[str, Ledger]]:
    found = [("Energy", energy_ledger(history, inertia=inertia)), ("Heat", heat_ledger(history))]
    return [(title, ledger) for title, ledger in found if ledger.income]


def _data(media: str, content: bytes) -> str:
    return f"data:{media};base64,{base64.b64encode(content).decode()}"


def _summary(directory: Path) -> dict[str, Any]:
    path = directory / SUMMARY
    _text(path)  # It asks whether this is the directory of a run.
    try:
        found = read_summary_file(path)
        required(found, path, *SHOWN)
    except SummaryError as error:
        raise OutputError(str(error)) from error
    return found


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except ValueError as error:
        raise OutputError(f"{path}: damaged: {error}") from error
    except OSError as error:
        raise OutputError(
            f"{path}: can't be read: {error.strerror}; is this the directory of a run?"
        ) from error
