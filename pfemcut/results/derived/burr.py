"""The burr that a tool leaves where it goes out through a free end of the workpiece.

A roll-over burr (Gillespie and Blotter, J. Eng. Ind. 98, 1976, 66-74): what is left of the edge bends about a point on
the end face below the machined surface. As Ko and Dornfeld (J. Eng. Mater. Technol. 113, 1991, 75-87) its height is how
far it stands out of the end face, and its thickness that of its root. There is no fracture here, so the chip still
hangs on the burr: it begins at the neck, the first section that is thinnest on both sides, and doesn't count. The root
is where, going out from the bulging block, the sections are first about as thick as most of the burr.
docs/surface_integrity.md has the picture.

Sections are vertical; of each only the topmost stretch of material counts, as the chip may hang in front of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.problem import Problem
from pfemcut.results.derived.rays import loop_edges

Array = NDArray[np.float64]

FACE = 0.0
"""Where the end face of a cut's workpiece is (mm in x)."""
SECTIONS = 400
ROOT = 1.15
"""The root is the first section less thick than this times the median up to the neck."""
GROWN = 1.5
"""A section this much thicker than the thinnest before it lies beyond the neck."""


@dataclass(frozen=True)
class Burr:
    """The burr on the end face x = 0 (lengths in mm; x counts from the end face outwards).

    Attributes
    ----------
    root, root_thickness, root_top
        Where the burr begins, its thickness and the height of its upper side there.
    neck, neck_thickness, neck_top
        The same of its end, the neck from which the chip hangs.
    overhang
        The farthest that any material, the chip too, is from the end face.
    """

    root: float
    root_thickness: float
    root_top: float
    neck: float
    neck_thickness: float
    neck_top: float
    overhang: float

    @property
    def height(self) -> float:
        """How far the burr stands out of the end face (mm)."""
        return self.neck


def has_left(problem: Problem) -> bool:
    """Whether the tool of a cut has left through the end face at the end of its travel."""
    return any(problem.tool[0].at(problem.time.end).centre[0] <= FACE for _ in problem.cut)


def exit_burr(frame: Frame, face: float) -> tuple[Burr, ...]:
    """The burr on the end face x = ``face`` (mm); none if nothing stands out of it."""
    overhang = face - float(frame.points[:, 0].min())
    if overhang <= 0.0:
        return ()
    away = overhang * (np.arange(SECTIONS) + 0.5) / SECTIONS
    top, thickness = topmost(frame, face - away)
    empty = np.flatnonzero(~np.isfinite(top))
    reached = int(empty[0]) if empty.size else SECTIONS
    if reached == 0:
        return ()
    neck = _neck(thickness[:reached])
    within = thickness[: neck + 1]
    root = int(np.argmax(within < ROOT * np.median(within)))
    return (
        Burr(
            root=float(away[root]),
            root_thickness=float(thickness[root]),
            root_top=float(top[root]),
            neck=float(away[neck]),
            neck_thickness=float(thickness[neck]),
            neck_top=float(top[neck]),
            overhang=overhang,
        ),
    )


def burr_figures(burr: Burr) -> dict[str, dict[str, float | str]]:
    """The figures of the summary; see :mod:`pfemcut.results.definitions`."""
    return {
        name: {"value": value, "unit": "mm"}
        for name, value in (
            ("burr_height", burr.height),
            ("burr_root_thickness", burr.root_thickness),
            ("burr_neck_thickness", burr.neck_thickness),
            ("burr_overhang", burr.overhang),
        )
    }


def topmost(frame: Frame, x: Array) -> tuple[Array, Array]:
    """Height of the upper end and length of the topmost stretch of material on verticals at ``x`` (k,); nan if none."""
    edges = loop_edges(frame.loops)
    start, end = frame.points[edges[:, 0]], frame.points[edges[:, 1]]
    top, length = np.full(len(x), np.nan), np.full(len(x), np.nan)
    for i, at in enumerate(x):
        crossing = (start[:, 0] <= at) != (end[:, 0] <= at)
        a, b = start[crossing], end[crossing]
        heights = np.sort(a[:, 1] + (at - a[:, 0]) * (b[:, 1] - a[:, 1]) / (b[:, 0] - a[:, 0]))
        if len(heights) >= 2:
            top[i], length[i] = heights[-1], heights[-1] - heights[-2]
    return top, length


def _neck(thickness: Array) -> int:
    """The thinnest section before they grow thicker again by half; the thinnest of all if they never do."""
    thinnest = np.minimum.accumulate(thickness)
    thicker = np.flatnonzero(thickness > GROWN * thinnest)
    return int(np.argmin(thickness[: thicker[0]] if thicker.size else thickness))
