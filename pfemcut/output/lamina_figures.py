"""Pictures of a lamina in tension: load against elongation, and damage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.collections import PathCollection  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.method import Frame  # noqa: E402
from pfemcut.output.drawing import save  # noqa: E402

Array = NDArray[np.float64]

_SHOWN = 0.015
"""Size of the largest displacement in a picture, over the plate's."""


def write_lamina_figures(
    directory: Path, frame: Frame, history: Mapping[str, Array], given: Mapping[str, Any]
) -> list[Path]:
    """Write the pictures of a lamina into ``directory``; return their paths.

    Parameters
    ----------
    directory
        Folder of the pictures.
    frame
        The instant to show.
    history
        Columns of ``history.csv``.
    given
        The resolved case file.
    """
    directory.mkdir(exist_ok=True)
    return [
        save(draw_load(history), directory / "load.png"),
        save(draw_damage(frame, given), directory / "damage.png"),
        save(draw_energies(history), directory / "energies.png"),
    ]


def draw_load(history: Mapping[str, Array]) -> Figure:
    """Return the load against the elongation, with its peak."""
    figure, axes = plt.subplots(figsize=(6.2, 3.8), layout="constrained")
    axes.plot(history["travel"], 1e-3 * history["load"], color="tab:blue", linewidth=1.0)
    at = int(np.argmax(history["load"]))
    axes.plot(history["travel"][at], 1e-3 * history["load"][at], "o", color="tab:red", markersize=4)
    axes.annotate(
        f"{1e-3 * history['load'][at]:.3g} kN",
        (history["travel"][at], 1e-3 * history["load"][at]),
        xytext=(-6, 2),
        textcoords="offset points",
        ha="right",
    )
    axes.set(xlabel="elongation (mm)", ylabel="load (kN)", title="Load against elongation")
    axes.grid(alpha=0.3)
    return figure


def draw_energies(history: Mapping[str, Array]) -> Figure:
    """Return what the grips' work and the start's kinetic energy became."""
    figure, axes = plt.subplots(figsize=(6.2, 3.8), layout="constrained")
    accounts = {
        "elastic": history["elastic_energy"],
        "kinetic": history["kinetic_energy"],
        "broken bonds": history["fracture_energy"],
        "dashpots": history["damping_energy"],
    }
    shown = {name: values for name, values in accounts.items() if values.any()}
    axes.stackplot(history["travel"], *shown.values(), labels=list(shown), alpha=0.6)
    axes.plot(
        history["travel"], history["tool_work"], color="black", linewidth=1.0, label="work of the grips"
    )
    axes.set(xlabel="elongation (mm)", ylabel="energy (mJ)", title="Energies")
    axes.legend(loc="upper left", fontsize="small")
    axes.grid(alpha=0.3)
    return figure


def draw_damage(frame: Frame, given: Mapping[str, Any]) -> Figure:
    """Return the sites coloured by damage at their displaced places."""
    figure, axes = plt.subplots(figsize=(8.0, 4.4), layout="constrained")
    shown = damage_map(axes, frame, given, "damage")
    figure.colorbar(shown, ax=axes, label="damage (fraction of bonds)", shrink=0.7)
    return figure


def damage_map(axes: Axes, frame: Frame, given: Mapping[str, Any], name: str) -> PathCollection:
    """Draw the field ``name`` of the sites into ``axes``, displaced, with lines along the fibre; what was drawn."""
    displacement = np.asarray(frame.point_fields["displacement"], dtype=np.float64)[:, :2]
    values = np.asarray(frame.point_fields[name], dtype=np.float64)
    sites = frame.points - displacement
    # Loose sites fly far.
    largest = float(np.percentile(np.hypot(*displacement.T), 98.0))
    size = np.ptp(sites, axis=0)
    scale = _SHOWN * float(size.max()) / largest if largest else 0.0
    places = sites + scale * displacement
    order = np.argsort(values, kind="stable")
    # Dots that just touch: the axes are about 7 inches wide.
    dot = (0.9 * 7.0 * 72.0 / float(size[0]) * float(given["lattice"]["spacing"])) ** 2
    shown = axes.scatter(
        places[order, 0],
        places[order, 1],
        c=values[order],
        s=dot,
        cmap="inferno_r",
        vmin=0.0,
        vmax=0.67,
        linewidths=0,
        marker="o",
    )
    turn = math.radians(float(given["lamina"]["fibre_angle"]))
    along = 0.5 * float(np.hypot(*size)) * np.array([math.cos(turn), math.sin(turn)])
    view = axes.axis()
    for cut in [*given.get("hole", ()), *given.get("crack", ())]:
        ends = np.array([np.asarray(cut["centre"]) - along, np.asarray(cut["centre"]) + along])
        axes.plot(*ends.T, color="tab:cyan", linestyle="--", linewidth=0.7)
    axes.axis(view)
    axes.set_aspect("equal")
    enlarged = f", displacement × {scale:.0f}" if scale else ""
    axes.set(xlabel=f"x (mm){enlarged}", ylabel="y (mm)")
    return shown
