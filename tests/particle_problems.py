"""Small problems for tests of explicit particle methods."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.problem import ParticleProblem

Array = NDArray[np.float64]

ELASTIC = {
    "name": "elastic",
    "source": "none",
    "young_modulus": 200e3,
    "poisson_ratio": 0.0,
    "density": 7.8e-9,
    "capacity": 470e6,
    "conductivity": 50.0,
    "expansion": 0.0,
    "reference_temperature": 293.0,
    "taylor_quinney": 0.9,
    "hardening": {"law": "elastic"},
}
"""With a Poisson's ratio of zero a bar is a column too: waves run with sqrt(E / rho)."""


def block(
    size: tuple[float, ...] = (1.0, 0.5),
    *,
    method: str = "tlsph",
    material: Any = "aisi4340",
    spacing: float = 0.1,
    end: float = 1e-6,
    hold: list[dict[str, Any]] | None = None,
    **particles: Any,
) -> ParticleProblem:
    """A block with one corner at the origin, at rest and without tool or walls."""
    case = {
        "problem": "solids",
        "method": method,
        "body": [{"name": "block", "box": [[0.0] * len(size), list(size)], "material": material}],
        "particles": {"spacing": spacing, **particles},
        "time": {"end": end},
        "hold": hold or [],
    }
    problem = problem_of(*validated(case, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    return problem


def moving(problem: ParticleProblem, velocity: Callable[[Array], Array]) -> ParticleProblem:
    """The problem of one body with an initial ``velocity`` (mm/s) that depends on the place."""
    (body,) = problem.bodies
    return replace(problem, bodies=(replace(body, velocity=velocity(body.points)),))


TAYLOR = {
    "problem": "solids",
    "body": [
        {
            "name": "bar",
            "cylinder": {"radius": 3.8, "length": 15.0},
            "velocity": [0.0, 0.0, -181e3],
            "material": "aisi4340",
        }
    ],
    "wall": [{"point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}],
    "particles": {"spacing": 1.9, "alpha": 1.5, "beta": 1.5, "batch": 10},
    "time": {"end": 2e-5},
    "output": {"every": 10, "checkpoint_every": 3, "figures": False},
}
"""A short Taylor bar of few particles."""

CUT = {
    "workpiece": {"length": 0.4, "height": 0.2, "material": "aisi4340"},
    "tool": {"rake": 6.0, "clearance": 5.0, "tip_radius": 0.02},
    "cutting": {"speed": 50e3, "depth": 0.1, "travel": 0.02},
    "contact": {"friction": 0.2},
    "particles": {"spacing": 0.02},
    "time": {"step": 1e-7},
    "output": {"every": 2, "checkpoint_every": 2, "figures": False},
}
"""A short cut with few particles, as a case file; the method is to be given."""

PRESSING: dict[str, Any] = {
    "problem": "solids",
    "body": [
        {"name": "block", "box": [[0.0, 0.0], [0.5, 0.3]], "material": "aisi4340"},
        {
            "name": "tool",
            "box": [[0.5, -0.1], [0.6, 0.4]],
            "material": "aisi4340",
            "velocity": [-200e3, 0.0],
            "rigid": True,
        },
    ],
    "hold": [{"box": [[0.0, 0.0], [0.05, 0.3]]}],
    "particles": {"spacing": 0.05},
    "time": {"end": 5e-7},
}
"""A rigid body that presses another one, held at its far side."""


def impact(method: ParticleMethod[Any], problem: ParticleProblem) -> tuple[list[float], list[float]]:
    """Run two bodies to the end: their gap along x after each batch, and their mean velocities at the end."""
    gaps = []
    one, other = problem.ranges
    while not method.finished:
        method.advance()
        x = method.current.positions[:, 0]
        gaps.append(float(x[other].min() - x[one].max()))
    return gaps, [float(method.current.velocities[part, 0].mean()) for part in (one, other)]
