"""Where the solution asks for particles, and which of them may move."""

from __future__ import annotations

import numpy as np
from problems import block_problem, rectangle_mesh

from pfemcut.pfem.loads import part_particles
from pfemcut.pfem.particles import _free_particles
from pfemcut.problem import Axis, fixed


def test_area_is_not_returned_by_moving_supported_particles() -> None:
    problem = block_problem(motions=(fixed("left", Axis.X),))
    mesh = rectangle_mesh()
    locked = np.zeros(len(mesh.points), dtype=bool)
    free = _free_particles(problem, mesh, (), problem.particles.sizes, locked)
    assert not free[part_particles(problem, mesh, "left")].any()
    assert free[np.setdiff1d(mesh.boundary.particles, part_particles(problem, mesh, "left"))].all()
