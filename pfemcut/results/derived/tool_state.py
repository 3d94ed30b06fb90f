"""Where and how much a meshed tool is heated, stressed and bent.

Positions are those of the tool without load: up the rake face from its tangent point, and below the face. Stresses are
averages of the tensor around each particle, of which von Mises' and the principal ones are taken.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Block, Frame
from pfemcut.results.derived.chip_section import to_rake_frame
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]

_UNIFORM = 1e-9  # relative range of a field that does not vary
_ON_TIP = 1e-3  # mm off the tip circle


def without_load(block: Block) -> Array:
    """Positions of the block's particles without its displacement (mm); shape (n, 2)."""
    if "displacement" not in block.point_fields:
        return block.points
    return block.points - np.asarray(block.point_fields["displacement"], dtype=np.float64)


def nodal_stress(block: Block) -> Array:
    """Area-weighted average of the stress around each particle (MPa; xx, yy, zz, xy); shape (n, 4)."""
    a, b, c = (block.points[block.cells[:, i]] for i in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    particles, count = block.cells.ravel(), len(block.points)
    total = np.bincount(particles, np.repeat(area, 3), minlength=count)
    return np.column_stack(
        [
            np.bincount(particles, np.repeat(area * component, 3), minlength=count) / total
            for component in block.cell_fields["cauchy_stress"].T
        ]
    )


def von_mises(stress: Array) -> Array:
    """Von Mises stress of tensors xx, yy, zz, xy (n, 4); shape (n,)."""
    xx, yy, zz, xy = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2)


def principal(stress: Array) -> Array:
    """Largest and smallest principal stress of tensors xx, yy, zz, xy (n, 4); shape (n, 2)."""
    xx, yy, zz, xy = stress.T
    mean, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return np.column_stack([np.maximum(mean + radius, zz), np.minimum(mean - radius, zz)])


def tool_columns(frame: Frame) -> dict[str, float]:
    """History columns of a deformable tool; none without one."""
    columns: dict[str, float] = {}
    for tool, block in zip(frame.tool, frame.tool_blocks, strict=False):
        if "cauchy_stress" not in block.cell_fields:
            continue
        stress = nodal_stress(block)
        largest, smallest = principal(stress).T
        for name, short, values in (
            ("tool_max_temperature", "tool_hottest", np.asarray(block.point_fields["temperature"])),
            ("tool_max_von_mises", "tool_von_mises", von_mises(stress)),
            ("tool_max_principal", "tool_principal", largest),
            ("tool_min_principal", "tool_compression", -smallest),
        ):
            at = int(np.argmax(values))
            columns[name] = float(values[at] if short != "tool_compression" else -values[at])
            along, away = to_rake_frame(without_load(block)[at : at + 1], tool)[0]
            # What is the same everywhere is largest nowhere.
            varies = np.ptp(values) > _UNIFORM * np.abs(values).max()
            columns[f"{short}_along_rake"] = float(along) if varies else math.nan
            columns[f"{short}_depth"] = float(-away) if varies else math.nan
        columns["tool_tip_deflection_x"], columns["tool_tip_deflection_y"] = tip_deflection(tool, block)
    return columns


def tip_deflection(tool: RigidWedge, block: Block) -> tuple[float, float]:
    """Mean displacement (mm) of the particles on the tip circle."""
    places = without_load(block)
    arc = tool.arc_length(places)
    closest = tool.closest(places)
    on_tip = (np.abs(closest.gap) < _ON_TIP) & (arc <= 0.0) & (arc >= -tool.tip_radius * tool.arc_angle)
    x, y = np.asarray(block.point_fields["displacement"], dtype=np.float64)[on_tip].mean(axis=0)
    return float(x), float(y)
