"""How the run went numerically: steps, iterations, remeshing, as rows of a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from pfemcut.output.report.text import number, significant

Array = NDArray[np.float64]


def _steps(dt: Array) -> str:
    return f"{number(1e6 * float(dt.min()), 3)} to {number(1e6 * float(dt.max()), 3)} µs"


def _iterations(values: Array) -> str:
    return f"mean {values.mean():.2f}, at most {values.max():.0f}"


def _mean(values: Array) -> str:
    return f"mean {significant(float(values.mean()), 3)}"


def _last(values: Array) -> str:
    return f"{values[-1]:.0f}"


def _range(values: Array) -> str:
    return f"{values.min():.0f} to {values.max():.0f}"


def _sum(values: Array) -> str:
    return f"{values.sum():.0f}"


_ROWS: tuple[tuple[str, str, Callable[[Array], str]], ...] = (
    ("step", "Steps", _last),
    ("dt", "Time step", _steps),
    ("newton_iterations", "Newton iterations of a step", _iterations),
    ("step_cuts", "Times that a step was halved", _last),
    ("extrapolated_steps", "Steps that only the extrapolated plastic multiplier could solve", _last),
    ("nodes", "Particles", _range),
    ("elements", "Elements", _range),
    ("inserted", "Particles inserted in a step", _mean),
    ("removed", "Particles removed in a step", _mean),
    ("changed_elements", "Elements that remeshing changes in a step", _mean),
    ("outside_gauss_points", "New Gauss points outside the old mesh, in all", _sum),
)


def convergence_rows(history: Mapping[str, Array]) -> list[tuple[str, str]]:
    """Return what the columns of a history tell of convergence and remeshing, as name and text."""
    return [(label, text(history[column])) for column, label, text in _ROWS if column in history]
