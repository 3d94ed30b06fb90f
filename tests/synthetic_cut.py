"""A cut drawn with ruler and compass: frames whose derived figures are known exactly."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from pfemcut.method import Array, ContactView, Frame
from pfemcut.problem import Cut
from pfemcut.tools.rigid_wedge import RigidWedge

DEPTH = 0.1
TIP = 0.025
CUT = Cut(DEPTH, 3000.0, DEPTH - TIP)


def tool_of(rake: float) -> RigidWedge:
    return RigidWedge((0.0, 0.0), rake, 5.0, TIP)


def from_rake_frame(tool: RigidWedge, s: Array, n: Array) -> Array:
    return tool.rake_tangent_point + np.outer(s, tool.rake_direction) + np.outer(n, tool.rake_normal)


def chip_outline(
    tool: RigidWedge, thickness: float, contact: float, length: float, curl: float, pieces: int = 400
) -> Array:
    """Loop of a workpiece with a chip that leaves the rake face at ``contact``, on an arc of radius ``curl``.

    ``curl`` is the radius of the rake side; inf for a straight chip. The loop runs counter-clockwise.
    """
    s_in = np.linspace(0.0, contact, 60)
    free_beyond = np.linspace(0.0, length, pieces)[1:]
    if np.isinf(curl):
        outer = from_rake_frame(tool, contact + free_beyond, 0.0 * free_beyond)
        inner = from_rake_frame(tool, contact + free_beyond, thickness + 0.0 * free_beyond)
    else:
        angle = free_beyond / curl
        outer, inner = (
            from_rake_frame(tool, contact + r * np.sin(angle), curl - r * np.cos(angle))
            for r in (curl, curl - thickness)
        )
    rake_side = from_rake_frame(tool, s_in, 0.0 * s_in)
    free_in = from_rake_frame(tool, s_in, thickness + 0.0 * s_in)
    free_in = free_in[free_in[:, 1] > CUT.surface + 1e-6]
    angles = np.linspace(np.pi * 1.5, np.arctan2(tool.rake_normal[1], tool.rake_normal[0]) % (2 * np.pi), 30)
    tip = np.array(tool.centre) + TIP * np.column_stack([np.cos(angles), np.sin(angles)])[:-1]
    block = np.array([[-3.0, CUT.surface], [-3.0, -1.0], [3.0, -1.0], [3.0, -TIP]])
    return np.vstack([block, tip, rake_side, outer, inner[::-1], free_in[::-1]])


def contact_of(points: Array, tool: RigidWedge, contact: float) -> ContactView:
    """Contact of all points on the tip's upper half and on the rake face up to ``contact``."""
    closest = tool.closest(points)
    arc = tool.arc_length(points)
    touching = np.flatnonzero(
        (np.abs(closest.gap) < 1e-9) & (arc <= contact + 1e-9) & (arc >= -0.5 * TIP * tool.arc_angle)
    )
    pressure = 1000.0 * (1.2 * contact - arc[touching])
    return ContactView(touching, arc[touching], pressure, 0.1 * pressure)


def outline_frame(
    rake: float, thickness: float, contact: float = 0.15, length: float = 0.8, curl: float = np.inf
) -> Frame:
    """A frame with a boundary loop and no elements."""
    tool = tool_of(rake)
    points = chip_outline(tool, thickness, contact, length, curl)
    fields = {
        "velocity": np.zeros_like(points),
        "pressure": np.zeros(len(points)),
        "temperature": 300.0 + 100.0 * np.arange(len(points)) / len(points),
        "particle_id": np.arange(len(points)),
    }
    names = ("equivalent_plastic_strain", "equivalent_plastic_strain_rate", "von_mises", "plastic_power")
    cells = {name: np.empty(0) for name in names} | {"cauchy_stress": np.empty((0, 4))}
    loop = np.arange(len(points))
    no_cells = np.empty((0, 3), dtype=np.int64)
    view = contact_of(points, tool, contact)
    return Frame(1, 1e-4, 0.3, points, no_cells, (loop,), fields, cells, (tool,), view)


def filled_frame(
    rake: float,
    thickness: float,
    curl: float = np.inf,
    shear_angle: float = 35.0,
    spacing: float = 0.02,
    step: int = 100,
) -> Frame:
    """A frame with elements: particles on a lattice inside the outline, a shear band at ``shear_angle``."""
    tool = tool_of(rake)
    outline = chip_outline(tool, thickness, 0.15, 0.8, curl, pieces=60)
    from matplotlib.path import Path as Polygon

    inside = Polygon(outline)
    x, y = np.meshgrid(np.arange(-1.2, 1.0, spacing), np.arange(-0.6, 1.2, spacing))
    x = x + 0.25 * spacing * (np.arange(x.shape[0]) % 2)[:, None]
    grid = np.column_stack([x.ravel(), y.ravel()])
    grid = grid[
        inside.contains_points(grid, radius=-0.4 * spacing) & (tool.closest(grid).gap > 0.4 * spacing)
    ]
    points = np.vstack([outline, grid])
    cells = Delaunay(points).simplices
    corners = points[cells]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    cells = np.where(area[:, None] < 0.0, cells[:, [0, 2, 1]], cells)
    keep = inside.contains_points(corners.mean(axis=1)) & (np.abs(area) > 1e-9)
    cells, centroid = cells[keep].astype(np.int64), corners[keep].mean(axis=1)

    distance = band_distance(centroid, shear_angle)
    rate = 1e5 * np.exp(-((distance / 0.012) ** 2))
    behind = np.clip(0.5 + distance / 0.03, 0.0, 1.0)
    noise = np.random.default_rng(1).normal(size=len(cells))
    zeros = np.zeros(len(cells))
    mises = 900.0 * np.exp(-((np.hypot(*centroid.T) / 0.4) ** 2)) + 200.0 * np.abs(noise)
    cell_fields = {
        "equivalent_plastic_strain": 1.4 * behind * (centroid[:, 1] > -TIP),
        "equivalent_plastic_strain_rate": rate,
        "von_mises": mises,
        "cauchy_stress": np.column_stack([-mises, mises, zeros, zeros]),
        "plastic_power": 600.0 * rate,
    }
    view = contact_of(points, tool, 0.15)
    hot = 293.0 + 500.0 * np.exp(-np.abs(tool.closest(points).gap) / 0.05) * (points[:, 1] > -TIP)
    velocity = np.column_stack([np.full(len(points), 0.0), 2000.0 * (points[:, 1] > 0.0)])
    point_fields = {
        "velocity": velocity,
        "pressure": np.sin(points[:, 0]),
        "temperature": hot,
        "particle_id": np.arange(len(points)),
    }
    return Frame(
        step,
        1e-7 * step,
        0.5,
        points,
        cells,
        (np.arange(len(outline)),),
        point_fields,
        cell_fields,
        (tool,),
        view,
    )


def band_distance(points: Array, shear_angle: float) -> Array:
    """Signed distance from the shear plane through the lower front of the tip, positive on the chip's side."""
    phi = np.radians(shear_angle)
    return (points - [-0.7 * TIP, -0.7 * TIP]) @ np.array([np.sin(phi), np.cos(phi)])
