"""Pictures of a run's history: ledgers, particles, convergence and time steps against travel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.output.drawing import save  # noqa: E402
from pfemcut.output.report.ledgers import ENERGY_IN, ENERGY_OUT, HEAT_IN, HEAT_OUT, Account  # noqa: E402
from pfemcut.results.summary import LARGEST_ENERGY_ERROR, LARGEST_HEAT_ERROR  # noqa: E402

Array = NDArray[np.float64]
History = Mapping[str, Array]

SMALLEST_SHARE = 0.002
"""Of what came in: smaller accounts would be lines on the axis."""


def write_history_figures(directory: Path, history: History) -> list[Path]:
    """Write the pictures that the history's columns allow into ``directory``; return their paths."""
    directory.mkdir(exist_ok=True)
    wanted = {
        "energy": ({"tool_work", "plastic_work", "energy_error"}, draw_energy),
        "heat": ({"heat_generated", "heat_content", "heat_error"}, draw_heat),
        "particles": ({"nodes"}, draw_particles),
        "convergence": ({"newton_iterations", "dt", "step_cuts"}, draw_convergence),
    }
    along = abscissa(history)[0]
    # A ledger into which nothing came has nothing to show.
    for name, accounts in (("energy", ENERGY_IN), ("heat", HEAT_IN)):
        if not any(history[each.column].any() for each in accounts if each.column in history):
            del wanted[name]
    written = []
    for name, (columns, draw) in wanted.items():
        if columns <= set(history) and along.size > 1:
            written.append(save(draw(history), directory / f"{name}.png"))
    return written


def abscissa(history: History) -> tuple[Array, str]:
    """Return the travel, or the time where no tool moves, with its label."""
    if history["travel"].any() or "time" not in history:
        return history["travel"], "travel (mm)"
    return history["time"], "time (s)"


def draw_energy(history: History) -> Figure:
    """Return what the tool's work became, and the ledger's error."""
    return _ledger(
        history,
        (ENERGY_IN, "work of the tool"),
        ENERGY_OUT,
        history["energy_error"],
        LARGEST_ENERGY_ERROR,
        "Energy ledger",
    )


def draw_heat(history: History) -> Figure:
    """Return where the heat went, and the ledger's error."""
    return _ledger(
        history,
        (HEAT_IN, "heat generated"),
        HEAT_OUT,
        history["heat_error"],
        LARGEST_HEAT_ERROR,
        "Heat ledger",
    )


def draw_particles(history: History) -> Figure:
    """Return the number of particles, and how many a step inserts and removes."""
    along, label = abscissa(history)
    rows = ("inserted", "removed")
    figure, (upper, *lower) = _panels("Particles", 2 if set(rows) <= set(history) else 1)
    upper.plot(along, history["nodes"], color="tab:blue", linewidth=1.2)
    upper.set(ylabel="particles")
    upper.set_ylim(0.0, 1.1 * float(history["nodes"].max()))
    for axes in lower:
        for name, colour in zip(rows, ("tab:green", "tab:red"), strict=True):
            axes.plot(along, _smooth(history[name]), color=colour, linewidth=1.0, label=name)
        axes.set(ylabel=f"a step (mean of {_width(along)})")
        axes.legend(fontsize="small")
    _finish([upper, *lower], along, label)
    return figure


def draw_convergence(history: History) -> Figure:
    """Return Newton iterations and step sizes, with the halved and the extrapolated steps marked."""
    along, label = abscissa(history)
    figure, (upper, lower) = _panels("Convergence", 2)
    iterations = history["newton_iterations"]
    upper.plot(along, iterations, ".", color="0.7", markersize=2.5, label="each step")
    upper.plot(along, _smooth(iterations), color="tab:blue", linewidth=1.2, label=f"mean of {_width(along)}")
    upper.set(ylabel="Newton iterations")
    upper.set_ylim(0.0, float(iterations.max()) + 1.0)
    lower.plot(along, 1e6 * history["dt"], color="tab:blue", linewidth=1.0, label="step")
    for name, text, colour in (
        ("step_cuts", "halved", "tab:red"),
        ("extrapolated_steps", "extrapolated", "tab:orange"),
    ):
        if name in history:
            at = np.flatnonzero(np.diff(history[name], prepend=0.0) > 0.0)
            lower.plot(along[at], 1e6 * history["dt"][at], "x", color=colour, label=f"{text} ({len(at)})")
    lower.set(ylabel="time step (µs)")
    lower.set_ylim(0.0, 1.15e6 * float(history["dt"].max()))
    for axes in (upper, lower):
        axes.legend(fontsize="small", ncols=3)
    _finish([upper, lower], along, label)
    return figure


def _ledger(
    history: History,
    income: tuple[Sequence[Account], str],
    outgo: Sequence[Account],
    error: Array,
    limit: float,
    title: str,
) -> Figure:
    along, label = abscissa(history)
    accounts, named = income
    total = sum((history[each.column] for each in accounts if each.column in history), np.zeros_like(along))
    figure, (upper, lower) = _panels(title, 2, (2.2, 1.0))
    parts = [each for each in outgo if each.column in history]
    largest = float(np.abs(total).max())
    large = [each for each in parts if np.abs(history[each.column]).max() > SMALLEST_SHARE * largest]
    floor = np.zeros_like(along)
    for number, each in enumerate(large):
        amount = history[each.column]
        text = f"{each.label} ({amount[-1] / total[-1]:.1%})" if total[-1] else each.label
        upper.fill_between(along, floor, floor + amount, color=f"C{number}", alpha=0.45, label=text, lw=0)
        floor = floor + amount
    upper.plot(along, total, color="black", linewidth=1.2, label=named)
    upper.set(ylabel="mJ/mm")
    upper.legend(fontsize="small", loc="upper left")
    lower.axhspan(-100.0 * limit, 100.0 * limit, color="tab:green", alpha=0.12, label=f"limit {limit:.0%}")
    lower.plot(along, 100.0 * error, color="tab:red", linewidth=1.0, label="left over")
    # At first the work is nearly nothing, and what is left of nothing means nothing.
    later = np.abs(error[along > 0.1 * along[-1]])
    reach = 100.0 * max(1.3 * limit, 1.2 * float(later.max(initial=0.0)))
    lower.set(ylabel="left over (%)", ylim=(-reach, reach))
    lower.legend(fontsize="small", ncols=2, loc="upper right")
    _finish([upper, lower], along, label)
    return figure


def _panels(title: str, count: int, heights: Sequence[float] = ()) -> tuple[Figure, list[Axes]]:
    figure, axes = plt.subplots(
        count,
        1,
        figsize=(6.2, 4.6 if count > 1 else 3.2),
        layout="constrained",
        sharex=True,
        squeeze=False,
        height_ratios=heights or [1.0] * count,
    )
    axes[0, 0].set_title(title)
    return figure, list(axes[:, 0])


def _finish(panels: Sequence[Axes], along: Array, label: str) -> None:
    for axes in panels:
        axes.grid(alpha=0.3)
        axes.set_xlim(0.0, max(float(along[-1]), 1e-12))
    panels[-1].set_xlabel(label)


def _width(along: Array) -> int:
    """Rows that a running mean takes: a fiftieth of them."""
    return max(1, along.size // 50)


def _smooth(values: Array) -> Array:
    """Return the running mean, of fewer rows at the ends."""
    width = _width(values)
    ones = np.ones(width)
    return np.convolve(values, ones, "same") / np.convolve(np.ones_like(values), ones, "same")
