"""Pictures of the definitions, for the documentation: ``python -m pfemcut.output.definitions docs/pictures``.

Drawn with the program's own tool geometry, so that a picture can't disagree with the code about where the tangent
point is or which way an angle counts.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.patches import Arc, Circle  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from pfemcut.tools.rigid_wedge import RigidWedge  # noqa: E402

Array = NDArray[np.float64]

TOOL = RigidWedge((0.0, 0.0), 12.0, 8.0, 0.3)
DEPTH, THICKNESS, CONTACT, CURL, ARC = 1.0, 1.5, 1.6, 6.0, 1.05
LOWEST = np.array([0.0, -TOOL.tip_radius])
SHEAR_ANGLE = 33.0

DIMENSION = {"arrowstyle": "<->", "color": "tab:red", "shrinkA": 0, "shrinkB": 0}


def on_rake(s: float | Array, n: float | Array = 0.0) -> Array:
    """Return the point s up the rake face from its tangent point and n away from it; shape (..., 2)."""
    s, n = np.asarray(s, dtype=np.float64), np.asarray(n, dtype=np.float64)
    return TOOL.rake_tangent_point + s[..., None] * TOOL.rake_direction + n[..., None] * TOOL.rake_normal


def chip_side(radius: float, angle: Array) -> Array:
    """Return points of a circle about the chip's centre of curl, by the angle from the end of contact."""
    return on_rake(CONTACT + radius * np.sin(angle), CURL - radius * np.cos(angle))


def _pair(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def draw_cut(axes: Axes, half_width: float = 4.2) -> None:
    """Draw workpiece, chip and tool."""
    angle = np.linspace(0.0, ARC, 80)
    rake_side = np.vstack([on_rake(np.linspace(0.0, CONTACT, 20)), chip_side(CURL, angle)])
    free_side = chip_side(CURL - THICKNESS, angle)[::-1]
    phi = np.radians(SHEAR_ANGLE)
    surface = LOWEST[1] + DEPTH
    root = np.array([LOWEST[0] - 0.25 - DEPTH / np.tan(phi), surface])
    tip = TOOL.outline(0.0)[1:-1]
    under = tip[tip[:, 1] <= TOOL.rake_tangent_point[1]]
    under = under[: int(np.argmin(under[:, 1])) + 1]
    ground = np.array([[3.0, LOWEST[1]], [3.0, -2.0], [-half_width, -2.0], [-half_width, surface], root])
    body = np.vstack([ground, free_side[::-1], rake_side[::-1], under])
    axes.fill(*body.T, facecolor="#cfe0f3", edgecolor="black", linewidth=1.0)
    outline = TOOL.outline(9.0)
    far = outline[0] + outline[-1] - np.asarray(TOOL.centre)
    axes.fill(*np.vstack([outline, far]).T, facecolor="0.75", edgecolor="black", linewidth=1.0)
    axes.set(xlim=(-half_width, 2.2), ylim=(-1.2, 5.2))
    axes.set_aspect("equal")
    axes.axis("off")


def dimension(axes: Axes, start: Array, end: Array, text: str, shift: Array) -> None:
    """Draw a double arrow with its name beside the middle."""
    axes.annotate("", _pair(start), _pair(end), arrowprops=DIMENSION)
    axes.text(*_pair(0.5 * (start + end) + shift), text, color="tab:red", ha="center", va="center")


def extension(axes: Axes, start: Array, end: Array) -> None:
    """Draw an extension line of a dimension."""
    axes.plot(*np.array([start, end]).T, color="tab:red", linewidth=0.7)


def dot(axes: Axes, point: Array, text: str, shift: Array) -> None:
    """Mark a point and name it."""
    axes.plot(*point, "o", color="tab:red", markersize=4)
    axes.text(*_pair(point + shift), text, color="tab:red", ha="center", va="center")


def contact_length(axes: Axes) -> None:
    """Contact length and the loaded arc of the tip."""
    draw_cut(axes)
    start, end = on_rake(0.0), on_rake(CONTACT)
    inside = -0.45 * TOOL.rake_normal
    for point in (start, end):
        extension(axes, point, point + 1.2 * inside)
    dimension(axes, start + inside, end + inside, "contact\nlength", -0.6 * TOOL.rake_normal)
    dot(axes, start, "rake tangent point", np.array([-1.15, 0.12]))
    dot(axes, end, "last loaded particle", np.array([-1.2, 0.0]))
    arc = TOOL.outline(0.0, 60)[1:-1][:45]
    axes.plot(*arc.T, color="tab:green", linewidth=4)
    axes.text(0.55, -0.75, "loaded arc\nof the tip", color="tab:green", ha="center")


def chip_thickness(axes: Axes) -> None:
    """Chip thickness and the range in which it is measured."""
    draw_cut(axes)
    inside = -0.5 * TOOL.rake_normal
    for beyond, text in ((0.0, "end of contact"), (DEPTH, "+ 1 depth"), (2.0 * DEPTH, "+ 2 depths")):
        point = on_rake(CONTACT + beyond)
        extension(axes, point, point + inside)
        axes.text(*_pair(point + inside + [0.08, 0.0]), text, color="tab:red", va="center")
    angles = np.arcsin(np.linspace(DEPTH, 2.0 * DEPTH, 7) / CURL)
    outer, inner = chip_side(CURL, angles), chip_side(CURL - THICKNESS, angles)
    for a, b in zip(outer, inner, strict=True):
        axes.plot(*np.array([a, b]).T, color="tab:red", linewidth=0.7)
    axes.annotate("", _pair(outer[3]), _pair(inner[3]), arrowprops=DIMENSION)
    axes.text(
        *_pair(inner[3] + [-0.15, -0.05]), "chip thickness\n(mean)", color="tab:red", ha="right", va="center"
    )
    surface = LOWEST[1] + DEPTH
    dimension(axes, np.array([-3.6, LOWEST[1]]), np.array([-3.6, surface]), "depth", np.array([0.4, 0.0]))
    axes.plot([-4.1, 0.0], [LOWEST[1]] * 2, color="0.4", linewidth=0.7, linestyle="--")


def shear_angle(axes: Axes) -> None:
    """Shear angle as the angle of the band of high strain rate."""
    draw_cut(axes)
    phi = np.radians(SHEAR_ANGLE)
    start = LOWEST + [-0.25, 0.0]
    along = np.array([-np.cos(phi), np.sin(phi)])
    root = start + along * DEPTH / np.sin(phi)
    axes.plot(*np.array([start, root]).T, color="tab:orange", linewidth=12, alpha=0.5, solid_capstyle="round")
    axes.plot(*np.array([start - 0.3 * along, root + 0.5 * along]).T, color="tab:red", linewidth=1.2)
    axes.plot([-3.0, 0.0], [LOWEST[1]] * 2, color="0.4", linewidth=0.7, linestyle="--")
    axes.add_patch(Arc(_pair(start), 1.8, 1.8, angle=180.0, theta1=-SHEAR_ANGLE, theta2=0.0, color="tab:red"))
    axes.text(-1.32, -0.06, "φ", color="tab:red", fontsize="large", ha="center", va="center")
    axes.text(-1.9, 1.5, "ridge of the\nstrain rate", color="tab:red", ha="center")
    for share in (0.3, 0.9):
        height = LOWEST[1] + share * DEPTH
        axes.plot([-3.6, -0.3], [height] * 2, color="0.4", linewidth=0.7, linestyle=":")
        axes.text(-3.65, height, f"{share} depth", color="0.3", ha="right", va="center", fontsize="small")


def tool_geometry(axes: Axes) -> None:
    """Tool angles, tip radius, tangent points, the gap and the arc length along the tool."""
    tool = TOOL
    outline = tool.outline(4.0)
    far = outline[0] + outline[-1] - np.asarray(tool.centre)
    axes.fill(*np.vstack([outline, far]).T, facecolor="0.75", edgecolor="black", linewidth=1.0)
    circle = Circle(tool.centre, tool.tip_radius, fill=False, linestyle="--", color="0.3")
    axes.add_patch(circle)
    axes.plot(
        [tool.rake_tangent_point[0]] * 2, [tool.rake_tangent_point[1], 1.9], "--", color="0.4", linewidth=0.7
    )
    axes.plot([0.0, 1.9], [LOWEST[1]] * 2, "--", color="0.4", linewidth=0.7)
    axes.text(-0.12, 1.55, "γ", color="tab:red", fontsize="large")
    axes.text(1.45, -0.2, "α", color="tab:red", fontsize="large", va="center")
    axes.text(-0.75, 1.95, "rake angle γ", color="tab:red", ha="center")
    axes.text(1.55, -0.45, "clearance α", color="tab:red", ha="center")
    dimension(axes, np.asarray(tool.centre), tool.rake_tangent_point, "", np.zeros(2))
    axes.text(0.05, 0.08, "tip radius", color="tab:red")
    dot(axes, tool.rake_tangent_point, "rake tangent point,\narc length 0", np.array([-0.62, 0.05]))
    dot(axes, tool.flank_tangent_point, "flank tangent point", np.array([0.45, -0.3]))
    particle = tool.rake_tangent_point + 0.9 * tool.rake_direction + 0.35 * tool.rake_normal
    foot = particle - 0.35 * tool.rake_normal
    axes.plot(*particle, "o", color="tab:blue")
    axes.text(*_pair(particle + [-0.1, 0.08]), "particle", color="tab:blue", ha="right")
    dimension(axes, particle, foot, "gap", np.array([0.0, 0.12]))
    inside = -0.2 * tool.rake_normal
    dimension(axes, tool.rake_tangent_point + inside, foot + inside, "arc\nlength", np.array([0.25, 0.0]))
    axes.annotate("", (-1.3, -0.15), (-0.75, -0.15), arrowprops={"arrowstyle": "->", "color": "black"})
    axes.text(-0.75, -0.27, "motion of the tool", ha="right", fontsize="small")
    axes.set(xlim=(-1.6, 2.0), ylim=(-0.6, 2.1))
    axes.set_aspect("equal")
    axes.axis("off")


PICTURES: dict[str, Callable[[Axes], None]] = {
    "contact_length": contact_length,
    "chip_thickness": chip_thickness,
    "shear_angle": shear_angle,
    "tool_geometry": tool_geometry,
}


def write_pictures(directory: Path) -> None:
    """Write all pictures of definitions into ``directory``."""
    directory.mkdir(parents=True, exist_ok=True)
    for name, draw in PICTURES.items():
        figure, axes = plt.subplots(figsize=(6.4, 6.4), layout="constrained")
        draw(axes)
        figure.savefig(directory / f"{name}.png", dpi=90, metadata={"Software": None})
        plt.close(figure)


if __name__ == "__main__":
    write_pictures(Path(sys.argv[1]))
