"""The chip's formation as an animated picture, from the frames that a run has written."""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from numpy.typing import NDArray  # noqa: E402
from PIL import Image  # noqa: E402

from pfemcut.method import Frame  # noqa: E402
from pfemcut.output.drawing import cutting_zone, draw_outline, draw_tool, seen_triangles  # noqa: E402
from pfemcut.output.figures import FIELDS, FieldPicture, colour_scale  # noqa: E402
from pfemcut.output.scales import Scales  # noqa: E402
from pfemcut.output.vtu import read_collection, read_frame  # noqa: E402
from pfemcut.whole_files import replacing  # noqa: E402

Array = NDArray[np.float64]

NAME = "chip.webp"
MOST_FRAMES = 40
WIDTH = 640
"""Pixels."""

DURATION = 120
"""Milliseconds a frame; the last one stays longer."""

PAUSE = 2000
QUALITY = 70
FIELD = next(field for field in FIELDS if field.name == "temperature")


def write_animation(directory: Path, figures: Path, depth: float, scales: Scales) -> list[Path]:
    """Write the animation of the frames in ``directory`` into the folder ``figures``; return its path.

    The view moves with the tool and all frames have the colour scale of the last, so that what changes is the chip.
    A run of fewer than three frames, or without a tool, has no animation.

    Parameters
    ----------
    directory
        Output directory of a run.
    figures
        Folder of the pictures.
    depth
        Depth of cut (mm), which sets the size of the view.
    scales
        Colour scales that replace the fields' own.

    Raises
    ------
    FieldsError
        If a frame is damaged.
    """
    entries = read_collection(directory)
    steps = sorted({entry.step for entry in entries})
    if len(steps) < 3:
        return []
    # The first and the last, and as many between as there may be, evenly.
    chosen = [steps[i] for i in np.unique(np.linspace(0, len(steps) - 1, MOST_FRAMES).round().astype(int))]
    frames = [read_frame(directory, [entry for entry in entries if entry.step == step]) for step in chosen]
    if not all(frame.tool and frame.cells.size for frame in frames):
        return []
    view = _common_view(frames, depth)
    scale_view = view + np.asarray(frames[-1].tool[0].centre)
    scale = colour_scale(frames[-1], FIELD, scale_view, scales)
    pictures = [_drawn(frame, FIELD, view + np.asarray(frame.tool[0].centre), scale) for frame in frames]
    path = figures / NAME
    with replacing(path) as temporary:
        pictures[0].save(
            temporary,
            format="WEBP",
            save_all=True,
            append_images=pictures[1:],
            duration=[DURATION] * (len(pictures) - 1) + [PAUSE],
            loop=0,
            quality=QUALITY,
            method=4,
        )
    return [path]


def _common_view(frames: list[Frame], depth: float) -> Array:
    """Return the corners of the view (mm) from the tip circle's centre, that shows every frame's chip; shape (2, 2)."""
    views = [cutting_zone(frame, depth) - np.asarray(frame.tool[0].centre) for frame in frames]
    return np.array(
        [np.min([view[0] for view in views], axis=0), np.max([view[1] for view in views], axis=0)]
    )


def _drawn(frame: Frame, field: FieldPicture, view: Array, scale: matplotlib.colors.Normalize) -> Image.Image:
    """Return one frame of the animation; all have the same size."""
    width, height = view[1] - view[0]
    figure, axes = plt.subplots(
        figsize=(6.4, min(6.4 * height / width * 0.85 + 0.3, 8.0)), layout="constrained"
    )
    axes.set(xlim=view[:, 0], ylim=view[:, 1], xticks=[], yticks=[])
    axes.set_title(f"travel {frame.travel:.3f} mm", fontsize="medium")
    axes.set_aspect("equal")
    shown = np.clip(field.values(frame), scale.vmin, scale.vmax)
    image = axes.tripcolor(
        seen_triangles(frame, view), shown, shading="gouraud", cmap=field.colours, norm=scale
    )
    draw_outline(axes, frame)
    draw_tool(axes, frame, view)
    figure.colorbar(image, ax=axes, label=f"{field.title} ({field.unit})", shrink=0.85)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=WIDTH / 6.4)
    plt.close(figure)
    return Image.open(buffer).convert("RGB")
