"""The view of a run for terminals, and plain lines where there is none."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from pfemcut.output.progress import duration
from pfemcut.watch.state import RunReader, RunState, Status

Array = NDArray[np.float64]

BARS = "▁▂▃▄▅▆▇█"
WIDTH = 44
CURVES = (
    ("cutting_force", "Fc", "N/mm"),
    ("thrust_force", "Ft", "N/mm"),
    ("max_temperature", "Tmax", "K"),
    ("nodes", "particles", ""),
)


def follow(
    reader: RunReader, console: Console, every: float, sleep: Callable[[float], None] = time.sleep
) -> None:
    """Show the state of a run every so many seconds until it ends, or for ever if it never does."""
    if console.is_terminal:
        with Live(console=console, auto_refresh=False) as live:
            while True:
                state = reader.state()
                live.update(view(state, reader.history()), refresh=True)
                if state.status is Status.ENDED:
                    return
                sleep(every)
    while True:
        state = reader.state()
        console.print(Text(line(state)), soft_wrap=True)
        if state.status is Status.ENDED:
            return
        sleep(every)


def view(state: RunState, history: Mapping[str, Array]) -> Panel:
    """Return what a terminal shows."""
    table = Table.grid(padding=(0, 2))
    for name, label, unit in CURVES:
        if name in state.latest:
            curve = sparkline(history[name], history["step"])
            table.add_row(label, f"{state.latest[name]:.5g} {unit}", Text(curve, style="cyan"))
    share = 0.0 if math.isnan(state.share) else state.share
    bar = Table.grid(padding=(0, 2))
    bar.add_row(ProgressBar(100.0, 100.0 * share, width=40), f"{share:.0%}", f"to go {to_go(state)}")
    parts: list[RenderableType] = [Text(progress(state)), bar, table, Text(checkpoint(state), style="dim")]
    parts += [Text(f"warning: {text}", style="yellow") for text in state.warnings]
    # As text: what stands in square brackets in a title is no markup.
    return Panel(Group(*parts), title=Text(state.title or "run"), title_align="left", width=80)


def line(state: RunState) -> str:
    """Return the state in one line of a log."""
    found = [
        f"{label} {state.latest[name]:.5g} {unit}".rstrip()
        for name, label, unit in CURVES
        if name in state.latest
    ]
    return "  ".join([progress(state), *found, f"to go {to_go(state)}"])


def progress(state: RunState) -> str:
    """Return how the run is and how far it is."""
    if not state.latest:
        return state.words
    travel = f"travel {state.latest.get('travel', 0.0):.4f}"
    end = "" if math.isnan(state.travel_end) else f" of {state.travel_end:g}"
    return f"{state.words}; {travel}{end} mm, step {state.latest['step']:.0f}"


def to_go(state: RunState) -> str:
    """Return the time to go as text."""
    return "?" if math.isnan(state.to_go) else duration(state.to_go)


def checkpoint(state: RunState) -> str:
    """Return what there is to say of checkpoints and requests."""
    age = "no checkpoint yet"
    if not math.isnan(state.checkpoint_age):
        age = f"last checkpoint {duration(state.checkpoint_age)} ago"
    return f"{age}; asked: {', '.join(state.requests)}" if state.requests else age


def sparkline(values: Array, along: Array, width: int = WIDTH) -> str:
    """Return a curve as a line of bars from zero to its highest value, means over equal parts of the abscissa.

    Parameters
    ----------
    values, along
        Ordinate, and rising abscissa; shape (n,).
    width
        Characters.
    """
    finite = np.isfinite(values)
    values, along = values[finite], along[finite]
    if values.size == 0:
        return ""
    width = min(width, values.size)
    parts = np.minimum(((along - along[0]) / max(np.ptp(along), 1e-300) * width).astype(int), width - 1)
    counts = np.bincount(parts, minlength=width)
    means = np.bincount(parts, weights=values, minlength=width) / np.maximum(counts, 1)
    top = max(float(means.max()), 1e-300)
    levels = np.clip(np.round(means / top * (len(BARS) - 1)), 0, len(BARS) - 1).astype(int)
    return "".join(BARS[level] if count else " " for level, count in zip(levels, counts, strict=True))
