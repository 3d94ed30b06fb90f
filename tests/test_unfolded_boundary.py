"""A step must not let a particle of the boundary pass the next one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from problems import rectangle_mesh

from pfemcut.pfem.mechanics import require_unfolded
from pfemcut.pfem.newton import StepFailed


def test_a_particle_that_passes_the_next_fails_the_step() -> None:
    mesh = rectangle_mesh()
    a, b = mesh.boundary.edges[3]
    displacement = np.zeros_like(mesh.points)
    along = mesh.points[b] - mesh.points[a]
    displacement[a] = 0.9 * along
    require_unfolded(mesh, displacement)
    displacement[a] = 1.1 * along
    with pytest.raises(StepFailed, match="turn round"):
        require_unfolded(mesh, displacement)


@pytest.mark.parametrize("degrees", [-80.0, 80.0])
def test_a_body_may_turn(degrees: float) -> None:
    mesh = rectangle_mesh()
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    require_unfolded(mesh, mesh.points @ np.array([[c, s], [-s, c]]) - mesh.points)
