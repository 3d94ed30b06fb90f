"""What a run comes to: its summary, figures and report, from the tables in its output directory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pfemcut.any_problem import AnyProblem
from pfemcut.inputs import InputError, read_toml
from pfemcut.output.directory import HISTORY, INPUTS, SUMMARY, TIMING
from pfemcut.output.surface import surface_figures, surface_warnings
from pfemcut.output.tool_profiles import cut_profiles, write_table
from pfemcut.problem import Problem
from pfemcut.results.derived.profile_figures import profile_figures
from pfemcut.results.derived.tool_heating import tool_warnings
from pfemcut.results.history import CORE_COLUMNS, read_table
from pfemcut.results.summary import Summary, summarise, update_summary

if TYPE_CHECKING:
    from pfemcut.output.scales import Scales


def summary_of(
    directory: Path, problem: AnyProblem, *, finished: bool, ending: str, warnings: Sequence[str]
) -> Summary:
    """Build the summary of the tables in ``directory``, and write the profiles along the tool beside them."""
    history, timing = directory / HISTORY, directory / TIMING
    none = {name: np.zeros(0) for name in CORE_COLUMNS}
    cut, tool = problem.cut, problem.tool
    columns = (read_table(history) or none) if history.exists() else none
    last = float(columns["time"][-1]) if columns["time"].size else 0.0
    if last > 0.0 and isinstance(problem, Problem):
        # Unloading and cooling are no part of the cut.
        warnings = (*warnings, *tool_warnings(problem, min(last, problem.time.end)))
    figures: dict[str, dict[str, float | str]] = {}
    for found in cut_profiles(directory):
        write_table(directory, found.profiles)
        figures = profile_figures(found.profiles)
    summary = summarise(
        columns,
        read_table(timing) if timing.exists() else {},
        title=problem.title,
        finished=finished,
        ending=ending,
        depth=cut[0].depth if cut else math.nan,
        rake=tool[0].shape.rake if tool else math.nan,
        warnings=warnings,
        profile_figures=figures,
    )
    if not isinstance(problem, Problem):
        return summary
    figures = surface_figures(directory, problem)
    return replace(
        summary,
        figures={**summary.figures, **figures},
        warnings=(*summary.warnings, *surface_warnings(problem, figures, last)),
    )


def report_case(directory: Path, *, animation: bool = True, scales: Scales | None = None) -> None:
    """Write figures and report of a cutting case from its output directory alone.

    A run that was killed, or goes on, has no summary yet; its history so far makes one.

    Parameters
    ----------
    directory
        Output directory of a run.
    animation
        Whether to draw the animation of the chip too.
    scales
        Colour scales of fields that replace their own.

    Raises
    ------
    UserError
        If the directory holds no run's results or they are damaged.
    """
    from pfemcut.case.load import validated
    from pfemcut.case.translate import problem_of
    from pfemcut.output.report import write_report

    ended = (directory / SUMMARY).exists()
    try:
        problem = problem_of(*validated(read_toml(directory / INPUTS), directory), directory)
    except InputError:
        if not ended:
            raise
        # A case of another version: the page shows what is there.
        write_report(directory, animation=animation, scales=scales)
        return
    if ended:
        if isinstance(problem, Problem):
            update_summary(directory / SUMMARY, surface_figures(directory, problem))
        write_report(directory, animation=animation, scales=scales)
    else:
        # Not written: the run goes on, and who reads a summary takes it for ended.
        ending = "had not ended when this was written"
        summary = summary_of(directory, problem, finished=False, ending=ending, warnings=(ending,))
        write_report(directory, animation=animation, scales=scales, summary=summary.to_json())
