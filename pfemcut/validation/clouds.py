"""Clouds of particles read back from a run's fields, in the plane and in space."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import load_case, solid
from pfemcut.case.particles import SolidsCase
from pfemcut.case.solids import solids_problem
from pfemcut.output.directory import INPUTS
from pfemcut.output.vtu import BODY_PART, body_points, read_collection
from pfemcut.particles.problem import ParticleProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cloud:
    """Particles of a run's first body at one time.

    Attributes
    ----------
    problem
        The problem that was run.
    time
        s.
    start, points
        Positions at time zero and now (mm); shape (n, d).
    fields
        Values on the particles by name.
    others
        Positions of the particles of the other bodies (mm); shape (k, d).
    """

    problem: ParticleProblem
    time: float
    start: Array
    points: Array
    fields: Mapping[str, NDArray[Any]]
    others: Array


def last_cloud(directory: Path) -> Cloud:
    """The last frame of a run of solids."""
    return cloud_at(directory, math.inf)


def cloud_at(directory: Path, time: float) -> Cloud:
    """The frame of a run of solids that is nearest to a ``time`` (s)."""
    case, material = load_case(directory / INPUTS)
    if not isinstance(case, SolidsCase):
        raise TypeError(f"{directory}: no case of solids")
    problem = solids_problem(case, solid(material), directory)
    entries = [entry for entry in read_collection(directory) if entry.part == BODY_PART]
    last = max(entry.time for entry in entries)
    entry = min(entries, key=lambda entry: abs(entry.time - min(time, last)))
    points, fields = body_points(directory, entry)
    points = points[:, : problem.dimension]
    first = problem.ranges[0]
    return Cloud(
        problem,
        entry.time,
        problem.points[first],
        points[first],
        {name: values[first] for name, values in fields.items()},
        points[first.stop :],
    )
