"""Pictures of a run: ``figures/*.png`` from the history and one frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.tri import Triangulation  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.method import Block, Frame  # noqa: E402
from pfemcut.output.drawing import (  # noqa: E402
    cutting_zone,
    draw_outline,
    draw_tool,
    save,
    seen_triangles,
    tip_zone,
    zone,
)
from pfemcut.output.scales import (  # noqa: E402
    Scales,
    four_decades,
    from_zero,
    temperature_scale,
    with_ends,
)
from pfemcut.results.derived.profiles import tool_profile, tool_surface_temperature  # noqa: E402
from pfemcut.results.derived.steady_window import SteadyWindow  # noqa: E402
from pfemcut.results.derived.tool_state import nodal_stress, principal, von_mises  # noqa: E402
from pfemcut.tools.rigid_wedge import RigidWedge  # noqa: E402

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FieldPicture:
    """How a field is drawn.

    Attributes
    ----------
    name, title, unit
        File name, title and unit.
    values
        From a frame to the values on particles; shape (n,).
    colours
        Colour map.
    scale
        From the values in view to the colour scale, see :mod:`pfemcut.output.scales`.
    """

    name: str
    title: str
    unit: str
    values: Callable[[Frame], Array]
    colours: str
    scale: Callable[[Array], Normalize]


def nodal_average(frame: Frame, values: Array) -> Array:
    """Return element values averaged to the particles with the elements' areas as weights; shape (n,).

    One-point elements of a mixed formulation carry noise from element to element that no particle shows; pictures
    of the average are nearer to what the method knows.
    """
    corners = frame.points[frame.cells]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    count = frame.points.shape[0]
    particles = frame.cells.ravel()
    total = np.bincount(particles, weights=np.repeat(area, 3), minlength=count)
    summed = np.bincount(particles, weights=np.repeat(area * values, 3), minlength=count)
    return np.asarray(summed / np.where(total == 0.0, 1.0, total))


def von_mises_of_average_stress(frame: Frame) -> Array:
    """Return the von Mises stress (MPa) of the nodal average of the stress tensor; shape (n,).

    Averaging the tensor before its norm lets stresses that alternate from element to element cancel, as they do in
    the weak form; the average of the norms would show a stress where there is none.
    """
    xx, yy, zz, xy = (nodal_average(frame, component) for component in frame.cell_fields["cauchy_stress"].T)
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2)


def _of_cells(name: str) -> Callable[[Frame], Array]:
    return lambda frame: nodal_average(frame, frame.cell_fields[name])


@dataclass(frozen=True)
class ToolPicture:
    """How a field of a deformable tool is drawn; ``reach`` of the view in tip radii, the rest as of a body's."""

    name: str
    title: str
    unit: str
    values: Callable[[Block], Array]
    colours: str
    reach: float


TOOL_FIELDS = (
    ToolPicture(
        "tool_von_mises",
        "Von Mises stress",
        "MPa",
        lambda block: von_mises(nodal_stress(block)),
        "turbo",
        12.0,
    ),
    ToolPicture(
        "tool_principal",
        "Largest principal stress",
        "MPa",
        lambda block: principal(nodal_stress(block))[:, 0],
        "coolwarm",
        12.0,
    ),
    ToolPicture(
        "tool_temperature",
        "Temperature",
        "K",
        lambda block: np.asarray(block.point_fields["temperature"], dtype=np.float64),
        "inferno",
        12.0,
    ),
)
FIELDS = (
    FieldPicture(
        "temperature",
        "Temperature",
        "K",
        lambda frame: np.asarray(frame.point_fields["temperature"], dtype=np.float64),
        "inferno",
        temperature_scale,
    ),
    FieldPicture(
        "plastic_strain",
        "Equivalent plastic strain",
        "-",
        _of_cells("equivalent_plastic_strain"),
        "viridis",
        from_zero,
    ),
    FieldPicture(
        "strain_rate",
        "Equivalent plastic strain rate",
        "1/s",
        _of_cells("equivalent_plastic_strain_rate"),
        "magma",
        four_decades,
    ),
    FieldPicture("von_mises", "Von Mises stress", "MPa", von_mises_of_average_stress, "turbo", from_zero),
)

MESHED = next(field for field in FIELDS if field.name == "strain_rate")
"""The field of the close view with the mesh."""


def write_figures(
    directory: Path,
    frame: Frame,
    history: Mapping[str, Array],
    window: SteadyWindow,
    depth: float,
    scales: Scales,
) -> list[Path]:
    """Write the figures of one instant, and the forces, into ``directory``; return their paths.

    Parameters
    ----------
    directory
        The folder of the figures; made if missing.
    frame
        The instant to show.
    history
        Columns of ``history.csv``.
    window
        The steady window.
    depth
        Depth of cut (mm), which sets the size of the picture; nan without a cut.
    scales
        Colour scales that replace the fields' own.
    """
    directory.mkdir(exist_ok=True)
    written: list[Path] = []
    if history["travel"].any():
        written.append(save(draw_forces(history, window), directory / "forces.png"))
    if frame.cells.shape[0]:
        view = cutting_zone(frame, depth)
        for field in FIELDS:
            figure = draw_field(frame, field, view, colour_scale(frame, field, view, scales))
            written.append(save(figure, directory / f"{field.name}.png"))
        for tool in frame.tool if not math.isnan(depth) else ():
            near = tip_zone(tool, depth)
            scale = colour_scale(frame, MESHED, view, scales)
            figure = draw_field(frame, MESHED, near, scale, mesh=True)
            written.append(save(figure, directory / "mesh_tip.png"))
        written.append(save(draw_mesh(frame, view), directory / "mesh.png"))
    for tool, block in zip(frame.tool, frame.tool_blocks, strict=False):
        if "cauchy_stress" in block.cell_fields:
            for picture in TOOL_FIELDS:
                figure = draw_tool_field(frame, tool, block, picture)
                written.append(save(figure, directory / f"{picture.name}.png"))
    if tool_profile(frame).arc_length.size:
        written.append(save(draw_profiles(frame), directory / "profiles.png"))
    return written


def draw_forces(history: Mapping[str, Array], window: SteadyWindow) -> Figure:
    """Return the forces against travel, with the steady window shaded."""
    figure, axes = plt.subplots(figsize=(6.2, 3.8), layout="constrained")
    travel = history["travel"]
    label = "steady window" if window.steady else "averaging window (not steady)"
    axes.axvspan(
        window.begin,
        window.end,
        color="tab:green" if window.steady else "tab:orange",
        alpha=0.15,
        label=label,
    )
    for name, label, colour in (
        ("cutting_force", "cutting force", "tab:blue"),
        ("thrust_force", "thrust (feed) force", "tab:red"),
    ):
        mean = window.mean(history[name])
        axes.plot(travel, history[name], color=colour, linewidth=1.0, label=f"{label}, mean {mean:.1f} N/mm")
        axes.hlines(mean, window.begin, window.end, color=colour, linestyle="--", linewidth=1.0)
    axes.set(xlabel="travel (mm)", ylabel="force on the tool (N/mm)", title="Forces against travel")
    axes.set_xlim(0.0, max(float(travel[-1]), 1e-9))
    # A single bad row may not flatten the curves.
    top = max(float(np.percentile(history[name], 99.5)) for name in ("cutting_force", "thrust_force"))
    bottom = min(float(np.percentile(history[name], 0.5)) for name in ("cutting_force", "thrust_force"))
    axes.set_ylim(min(0.0, 1.1 * bottom), 1.25 * top if top > 0.0 else None)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside lower center", ncols=2, fontsize="small")
    return figure


def colour_scale(frame: Frame, field: FieldPicture, view: Array, scales: Scales) -> Normalize:
    """Return the colour scale of a field: the given one, or that of its values in view."""
    values = field.values(frame)
    inside = ((frame.points >= view[0]) & (frame.points <= view[1])).all(axis=1)
    scale = field.scale(values[inside] if inside.any() else values)
    return with_ends(scale, scales[field.name]) if field.name in scales else scale


def draw_field(
    frame: Frame, field: FieldPicture, view: Array, scale: Normalize, *, mesh: bool = False
) -> Figure:
    """Return the picture of one field in the cutting zone, with the mesh over it if asked for."""
    values = field.values(frame)
    figure, axes = zone(view, f"{field.title}, travel {frame.travel:.3f} mm")
    seen = seen_triangles(frame, view)
    shown = np.clip(values, scale.vmin, scale.vmax)
    image = axes.tripcolor(seen, shown, shading="gouraud", cmap=field.colours, norm=scale)
    if mesh:
        axes.triplot(seen, color="white", linewidth=0.35, alpha=0.7)
    draw_outline(axes, frame)
    draw_tool(axes, frame, view)
    inside = ((frame.points >= view[0]) & (frame.points <= view[1])).all(axis=1)
    low, high = float(scale.vmin or 0.0), float(scale.vmax or 0.0)
    above = float(values[inside].max(initial=-np.inf)) > high
    # Averaging of linear values may undershoot zero by nothing worth an arrow.
    below = float(values[inside].min(initial=np.inf)) < low - 0.01 * (high - low) * (
        field.scale is not four_decades
    )
    extend = {(True, True): "both", (True, False): "max", (False, True): "min"}.get((above, below), "neither")
    figure.colorbar(image, ax=axes, label=f"{field.title} ({field.unit})", shrink=0.85, extend=extend)
    return figure


def draw_mesh(frame: Frame, view: Array) -> Figure:
    """Return the picture of the mesh in the cutting zone."""
    count = frame.points.shape[0]
    figure, axes = zone(view, f"Mesh, {count} particles, travel {frame.travel:.3f} mm")
    axes.triplot(seen_triangles(frame, view), color="tab:blue", linewidth=0.3)
    draw_outline(axes, frame)
    draw_tool(axes, frame, view)
    return figure


def draw_tool_field(frame: Frame, tool: RigidWedge, block: Block, field: ToolPicture) -> Figure:
    """Return the picture of one field in a deformable tool, near its tip, with the largest value marked."""
    values = field.values(block)
    reach = field.reach * tool.tip_radius
    foot = tool.rake_tangent_point
    view = foot + np.array([[-0.4 * reach, -0.4 * reach], [reach, reach]])
    figure, axes = zone(view, f"{field.title} in the tool, travel {frame.travel:.3f} mm")
    inside = ((block.points >= view[0]) & (block.points <= view[1])).all(axis=1)
    triangles = Triangulation(block.points[:, 0], block.points[:, 1], block.cells)
    low, high = float(values[inside].min()), float(values[inside].max())
    levels = np.linspace(low, max(high, low + 1e-9), 25)
    image = axes.tricontourf(triangles, np.clip(values, low, high), levels=levels, cmap=field.colours)
    draw_outline(axes, frame)
    at = int(np.argmax(np.abs(values)))
    axes.plot(*block.points[at], "k+", markersize=9, label=f"{values[at]:.4g} {field.unit}")
    axes.legend(loc="upper right", fontsize="small")
    figure.colorbar(image, ax=axes, label=f"{field.title} ({field.unit})", shrink=0.85)
    return figure


def draw_profiles(frame: Frame) -> Figure:
    """Return pressure, shear traction and temperature along the tool."""
    profile = tool_profile(frame)
    figure, axes = plt.subplots(figsize=(6.2, 3.8), layout="constrained")
    axes.plot(profile.arc_length, profile.pressure, ".-", color="tab:blue", label="pressure")
    axes.plot(profile.arc_length, profile.shear, ".-", color="tab:green", label="shear traction")
    axes.axvline(0.0, color="0.5", linewidth=0.8)
    axes.set(
        title=f"Along the tool, travel {frame.travel:.3f} mm",
        xlabel="distance up the rake face from its tangent point (mm); tip and flank are negative",
        ylabel="traction (MPa)",
    )
    right = axes.twinx()
    right.plot(profile.arc_length, profile.temperature, ".-", color="tab:red", label="temperature")
    arc, warmth = tool_surface_temperature(frame)
    if arc.size and profile.arc_length.size:
        span = np.ptp(profile.arc_length)
        near = (arc > profile.arc_length.min() - 0.5 * span) & (arc < profile.arc_length.max() + 0.5 * span)
        right.plot(arc[near], warmth[near], "-", color="tab:orange", label="temperature of the tool")
    right.set_ylabel("temperature (K)")
    lines = [*axes.get_lines()[:2], *right.get_lines()]
    axes.legend(lines, [str(line.get_label()) for line in lines], fontsize="small")
    axes.grid(alpha=0.3)
    return figure
