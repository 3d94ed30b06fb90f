"""Largest values of a frame and where they are: strain rate, temperature."""

from __future__ import annotations

import math

import numpy as np

from pfemcut.method import Frame
from pfemcut.results.derived.chip_section import to_rake_frame
from pfemcut.results.derived.contact_length import temperature
from pfemcut.tools.rigid_wedge import RigidWedge


def peak_strain_rate(frame: Frame) -> float:
    """Return the largest equivalent plastic strain rate (1/s) of the elements."""
    return _largest(frame, "equivalent_plastic_strain_rate")


def hottest_point(frame: Frame, tool: RigidWedge) -> tuple[float, float]:
    """Return where the workpiece is hottest (mm): up the rake face from its tangent point, and away from it."""
    hottest = int(np.argmax(temperature(frame)))
    along, away = to_rake_frame(frame.points[hottest : hottest + 1], tool)[0]
    return float(along), float(away)


def _largest(frame: Frame, name: str) -> float:
    values = frame.cell_fields[name]
    return float(values.max()) if values.size else math.nan
