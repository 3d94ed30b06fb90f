"""``figures/tool_profiles.png``: the profiles along the tool, drawn from the output directory alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.output.directory import FIGURES, writing  # noqa: E402
from pfemcut.output.drawing import save  # noqa: E402
from pfemcut.output.tool_profiles import CutProfiles, cut_profiles, write_table  # noqa: E402
from pfemcut.results.derived.tool_profiles import FLANK, Averaged, ToolProfiles  # noqa: E402

Array = NDArray[np.float64]

NAME = "tool_profiles.png"
MICROMETRES_PER_MINUTE = 6e4
"""In a mm/s."""


def write_profile_figure(directory: Path) -> list[Path]:
    """Write the table of the profiles of the run in ``directory`` again and draw it; the picture's path, or none."""
    written = []
    for found in cut_profiles(directory):
        write_table(directory, found.profiles)
        written.append(write_picture(found, directory / FIGURES))
    return written


def write_picture(found: CutProfiles, folder: Path) -> Path:
    """Draw profiles into a ``folder``, made if missing; the picture's path."""
    with writing(folder):
        folder.mkdir(exist_ok=True)
        path = folder / NAME
        figure = draw_tool_profiles(found)
        save(figure, path)
    return path


def draw_tool_profiles(found: CutProfiles) -> Figure:
    """Return pressure and shear, sliding speed, temperature, and wear rate or friction heat along the tool.

    Lines are means over the instants, bands one standard deviation to each side.
    """
    profiles = found.profiles
    figure, panels = plt.subplots(4, 1, figsize=(7.0, 9.0), sharex=True, layout="constrained")
    _draw(panels[0], profiles, ("pressure", "shear"), ("normal pressure", "shear traction"))
    panels[0].set_ylabel("traction (MPa)")
    _draw(panels[1], profiles, ("sliding_speed",), ("sliding speed",), 1e-3)
    panels[1].set_ylabel("sliding speed (m/s)")
    panels[1].axhline(0.0, color="0.5", linewidth=0.6)
    _draw(panels[2], profiles, ("temperature", "tool_temperature"), ("workpiece", "tool"))
    panels[2].set_ylabel("temperature (K)")
    if "wear_rate" in profiles.quantities:
        _draw(panels[3], profiles, ("wear_rate",), ("wear rate (Usui)",), MICROMETRES_PER_MINUTE)
        panels[3].set_ylabel("wear rate (µm/min)")
        panels[3].set_title("; ".join(each.name for each in found.inputs.wear), fontsize="small")
    else:
        _draw(panels[3], profiles, ("heat_flux",), ("friction heat",), 1e-3)
        panels[3].set_ylabel("friction heat (W/mm²)")
    _mark_parts(panels, profiles)
    panels[-1].set_xlabel(
        "distance up the rake face from its tangent point (mm); edge and flank are negative"
    )
    first, last = found.travel
    instants = f"{profiles.instants} instants" if profiles.instants > 1 else "one instant"
    figure.suptitle(f"Along the tool, {instants}, travel {first:.3f} to {last:.3f} mm")
    return figure


def _draw(
    axes: Axes, profiles: ToolProfiles, names: Sequence[str], labels: Sequence[str], scale: float = 1.0
) -> None:
    given = [(name, label) for name, label in zip(names, labels, strict=True) if name in profiles.quantities]
    for (name, label), colour in zip(given, ("tab:blue", "tab:orange"), strict=False):
        averaged: Averaged = profiles.quantities[name]
        mean, std = scale * averaged.mean, scale * averaged.std
        position = profiles.stations.position
        axes.plot(position, mean, color=colour, linewidth=1.4, label=label)
        axes.fill_between(position, mean - std, mean + std, color=colour, alpha=0.25, linewidth=0.0)
    if len(given) > 1:
        axes.legend(fontsize="small")
    axes.grid(alpha=0.3)


def _mark_parts(panels: Sequence[Axes], profiles: ToolProfiles) -> None:
    stations = profiles.stations
    for axes in panels:
        for part in dict.fromkeys(stations.parts):
            axes.axvline(stations.borders[:-1][stations.on(part)].min(), color="0.5", linewidth=0.7)
    for part in dict.fromkeys(stations.parts):
        on = stations.on(part)
        low, high = stations.borders[:-1][on].min(), stations.borders[1:][on].max()
        # The flank is short: its name has more room beside it.
        panels[0].text(
            high if part == FLANK else 0.5 * (low + high),
            1.02,
            part,
            transform=panels[0].get_xaxis_transform(),
            ha="right" if part == FLANK else "center",
            fontsize="small",
            color="0.3",
        )
