"""``summary.json``: the figures of a run, each with its unit, and what is needed to trust them."""

from __future__ import annotations

import importlib.metadata
import math
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.results.definition import Definition, Taken
from pfemcut.results.definitions import FIGURES
from pfemcut.results.derived.friction import apparent_friction
from pfemcut.results.derived.specific_energy import specific_energy
from pfemcut.results.derived.steady_window import SteadyWindow, steady_window
from pfemcut.results.summary_file import read_summary_file
from pfemcut.whole_files import write_json

Array = NDArray[np.float64]

LARGEST_ENERGY_ERROR = 0.03
LARGEST_HEAT_ERROR = 0.01
LARGEST_AREA_DRIFT = 0.002
LEAST_SHARE = 0.005
"""Part of the window in which the chip is not complete."""

PACKAGES = {
    "pfemcut": "pfemcut",
    "dolfinx": "fenics-dolfinx",
    "petsc4py": "petsc4py",
    "numpy": "numpy",
    "scipy": "scipy",
    "h5py": "h5py",
}


@dataclass(frozen=True)
class Summary:
    """What a run found.

    Attributes
    ----------
    title
        Title of the case.
    finished
        Whether the run reached its end (or the physical end of the cut) and its figures are those of the case.
    ending
        How the run ended, in a sentence.
    steady
        Whether the cut was steady in the window.
    window
        Travel (mm) at the begin and end of the window.
    figures
        ``{"mean", "std", "unit"}`` or ``{"value", "unit"}`` by name.
    ledgers
        Last row of the cumulative energies (mJ/mm), by column name.
    seconds_per_step
        Mean wall time of a step by phase (s).
    versions
        Versions of the programs that made this.
    warnings
        What a reader of the figures must know.
    """

    title: str
    finished: bool
    ending: str
    steady: bool
    window: tuple[float, float]
    steps: int
    travel: float
    wall_time: float
    figures: Mapping[str, Mapping[str, float | str]]
    ledgers: Mapping[str, float]
    seconds_per_step: Mapping[str, float]
    versions: Mapping[str, str]
    warnings: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """Return the content of ``summary.json``: each figure is a key of its own."""
        other = asdict(self)
        del other["figures"], other["steady"], other["steps"], other["wall_time"]
        return {
            **{name: dict(figure) for name, figure in self.figures.items()},
            "steady": {"value": self.steady, "unit": "-"},
            "steps": {"value": self.steps, "unit": "-"},
            "wall_time": {"value": self.wall_time, "unit": "s"},
            **other,
        }


def summarise(
    history: Mapping[str, Array],
    timing: Mapping[str, Array],
    *,
    title: str,
    finished: bool,
    ending: str,
    depth: float = math.nan,
    rake: float = math.nan,
    warnings: Sequence[str] = (),
    profile_figures: Mapping[str, Mapping[str, float | str]] = MappingProxyType({}),
) -> Summary:
    """Build the summary of a history.

    Parameters
    ----------
    history, timing
        Columns of ``history.csv`` and ``timing.csv``; columns that are missing give no figure.
    title, finished, ending
        See :class:`Summary`.
    depth, rake
        Depth of cut (mm) and rake angle (degrees); nan if the problem isn't a cut.
    warnings
        What the run has to add to the summary's own warnings.
    profile_figures
        Figures of the profiles along the tool, by name.
    """
    columns = dict(history)
    rows = columns["step"].size
    if rows == 0:
        window = SteadyWindow(0.0, 0.0, np.zeros(0), 0.0, 0.0, False, "there is no history")
    else:
        window = steady_window(columns["travel"], columns["cutting_force"])
    if not math.isnan(depth):
        columns["specific_energy"] = specific_energy(columns["cutting_force"], depth)
        columns["apparent_friction"] = apparent_friction(
            columns["cutting_force"], columns["thrust_force"], rake
        )
    figures: dict[str, Mapping[str, float | str]] = {
        item.name: _figure(item, columns[item.name], window)
        for item in FIGURES
        if rows and item.name in columns and np.isfinite(columns[item.name]).any()
    }
    figures |= profile_figures
    total = timing.get("total", np.zeros(0))
    return Summary(
        title=title,
        finished=finished,
        ending=ending,
        steady=window.steady,
        window=(window.begin, window.end),
        steps=int(columns["step"][-1]) if rows else 0,
        travel=float(columns["travel"][-1]) if rows else 0.0,
        wall_time=float(total.sum()),
        figures=figures,
        ledgers={name: float(values[-1]) for name, values in columns.items() if rows and _is_energy(name)},
        seconds_per_step={
            name: float(values.mean()) for name, values in timing.items() if name != "step" and values.size
        },
        versions=versions(),
        warnings=(*warnings, *_warnings(columns, figures, window, cut=not math.isnan(depth))),
    )


def write_summary(path: Path, summary: Summary) -> None:
    """Write ``summary.json``, at once."""
    # JSON has no nan: figures without a value aren't there.
    write_json(path, summary.to_json())


def update_summary(path: Path, figures: Mapping[str, Mapping[str, float | str]]) -> None:
    """Put ``figures`` into an existing ``summary.json``, first those that were not there."""
    content = read_summary_file(path)
    if any(content.get(name) != figure for name, figure in figures.items()):
        write_json(path, {**figures, **content, **figures})


def figure_mean(summary: Mapping[str, Any], name: str) -> float:
    """Window mean, or last value, of a figure in the content of ``summary.json``; nan without one."""
    figure = summary.get(name, {})
    return float(figure.get("mean", figure.get("value", math.nan)))


def figure_std(summary: Mapping[str, Any], name: str) -> float:
    """Standard deviation of a figure over the window, in the content of ``summary.json``; nan without one."""
    return float(summary.get(name, {}).get("std", math.nan))


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that a result may depend on."""
    found = {"python": platform.python_version()}
    for name, distribution in PACKAGES.items():
        try:
            found[name] = importlib.metadata.version(distribution)
        except importlib.metadata.PackageNotFoundError:
            # A wheel of dolfinx brings petsc4py along and has a name of its own.
            version = getattr(sys.modules.get(name), "__version__", None)
            if version is not None:
                found[name] = version
    return found


def _figure(item: Definition, values: Array, window: SteadyWindow) -> dict[str, float | str]:
    if item.taken in (Taken.LAST, Taken.END):
        return {"value": float(values[np.isfinite(values)][-1]), "unit": item.unit}
    mean, std = window.mean(values), window.std(values)
    if math.isnan(mean):
        # Defined somewhere, but not in the window: the last value is better than none, and has no scatter.
        return {"value": float(values[np.isfinite(values)][-1]), "unit": item.unit}
    return {"mean": mean, "std": std, "unit": item.unit}


def _is_energy(name: str) -> bool:
    return name.endswith(("_work", "_energy")) and name != "specific_energy"


def _warnings(
    columns: Mapping[str, Array],
    figures: Mapping[str, Mapping[str, float | str]],
    window: SteadyWindow,
    *,
    cut: bool,
) -> list[str]:
    found: list[str] = []
    if cut and not window.steady:
        found.append(f"not steady: {window.reason}")
    complete = columns.get("chip_complete", np.zeros(0))
    # Less is round-off, or the edge of the window.
    if cut and complete.size and (share := 1.0 - window.mean(complete)) >= LEAST_SHARE:
        found.append(
            f"in {share:.0%} of the window the chip was too short for the whole chip thickness range"
        )
    force = columns.get("self_contact_force", np.zeros(0))
    touching = np.flatnonzero(np.nan_to_num(force) > 0.0)
    if touching.size:
        found.append(
            f"the body touches itself from travel {columns['travel'][touching[0]]:.3f} mm on, "
            f"with up to {force[touching].max():.3g} N/mm"
        )
    limits = {
        "energy_error": LARGEST_ENERGY_ERROR,
        "heat_error": LARGEST_HEAT_ERROR,
        "area_drift": LARGEST_AREA_DRIFT,
    }
    for name, limit in limits.items():
        value = abs(float(figures[name]["value"])) if name in figures else 0.0
        if value > limit:
            found.append(f"{name} is {value:.2%} (limit {limit:.1%})")
    return found
