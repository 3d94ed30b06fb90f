"""What all pictures of the fields share: the view, the body's outline, the tool, and saving."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.tri import Triangulation  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.method import Frame  # noqa: E402
from pfemcut.output.picture_files import write_picture  # noqa: E402
from pfemcut.output.vtu import boundary_loops  # noqa: E402
from pfemcut.results.derived.chip_section import to_rake_frame  # noqa: E402
from pfemcut.tools.rigid_wedge import RigidWedge  # noqa: E402

Array = NDArray[np.float64]

TOOL_COLOUR = "0.75"


def cutting_zone(frame: Frame, depth: float) -> Array:
    """Return the corners of the view (mm): the tool's tip, the whole chip and some material around; shape (2, 2).

    Without a tool, or a depth of cut (nan), that is the whole body.
    """
    if not frame.tool or math.isnan(depth):
        return np.array([frame.points.min(axis=0), frame.points.max(axis=0)])
    tool = frame.tool[0]
    lowest = np.asarray(tool.centre) - [0.0, tool.tip_radius]
    offset = frame.points - lowest
    # The chip: what lies in front of the rake face above the uncut surface.
    chip = (offset[:, 1] > 1.2 * depth) & (to_rake_frame(frame.points, tool)[:, 1] > -0.5 * depth)
    low = np.array([-5.0 * depth, -2.0 * depth])
    high = np.array([3.0 * depth, 4.0 * depth])
    if chip.any():
        low = np.minimum(low, offset[chip].min(axis=0) - depth)
        high = np.maximum(high, offset[chip].max(axis=0) + depth)
    return lowest + np.array([low, high])


def tip_zone(tool: RigidWedge, depth: float) -> Array:
    """Return the corners of the close view (mm): the tip and the shear zone; shape (2, 2)."""
    lowest = np.asarray(tool.centre) - [0.0, tool.tip_radius]
    return lowest + depth * np.array([[-2.2, -0.6], [0.6, 2.0]])


def zone(view: Array, title: str) -> tuple[Figure, Axes]:
    """Return an empty picture of the rectangle ``view`` (mm), with equal scales in both directions."""
    width, height = view[1] - view[0]
    across = 5.6 if width >= height else max(3.8, 5.6 * width / height)
    figure, axes = plt.subplots(
        figsize=(across + 1.0, max(across * height / width, 3.0) + 0.6), layout="constrained"
    )
    axes.set(title=title, xlabel="x (mm)", ylabel="y (mm)", xlim=view[:, 0], ylim=view[:, 1])
    axes.set_aspect("equal")
    return figure, axes


def seen_triangles(frame: Frame, view: Array) -> Triangulation:
    """Return the triangles that the view shows, in part at least."""
    corners = frame.points[frame.cells]
    low, high = corners.min(axis=1), corners.max(axis=1)
    seen = ((high >= view[0]) & (low <= view[1])).all(axis=1)
    return Triangulation(frame.points[:, 0], frame.points[:, 1], frame.cells[seen])


def draw_outline(axes: Axes, frame: Frame) -> None:
    """Draw the boundary of the body."""
    for loop in frame.loops:
        closed = frame.points[np.append(loop, loop[0])]
        axes.plot(closed[:, 0], closed[:, 1], color="black", linewidth=0.6)


def draw_tool(axes: Axes, frame: Frame, view: Array) -> None:
    """Draw the tool, or as much of it as ``view`` may show."""
    length = float(2.0 * np.hypot(*(view[1] - view[0])))
    for block in frame.tool_blocks:
        for loop in boundary_loops(block.cells):
            face = PolyCollection(
                [block.points[loop]], facecolor=TOOL_COLOUR, edgecolor="black", linewidth=0.8
            )
            face.set_zorder(0.5)
            axes.add_collection(face, autolim=False)
    for tool in frame.tool if not frame.tool_blocks else ():
        outline = tool.outline(length)
        far = outline[0] + outline[-1] - tool.centre
        polygon = PolyCollection(
            [np.vstack([outline, far])], facecolor=TOOL_COLOUR, edgecolor="black", linewidth=0.8
        )
        # Behind the body: a particle that penetrates by the penalty's share stays visible.
        polygon.set_zorder(0.5)
        axes.add_collection(polygon, autolim=False)


def save(figure: Figure, path: Path) -> Path:
    """Write a figure, at once, and close it; return its path."""
    write_picture(path, figure)
    plt.close(figure)
    return path
