"""A step must not let a particle of the boundary pass the next one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from problems import cut_problem, rectangle_mesh

from pfemcut.pfem.mechanics import require_unfolded
from pfemcut.pfem.method import PfemMethod
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


def test_default_sizes_with_long_steps_do_not_fold_the_boundary_at_the_tip() -> None:
    """Step 29 of this cut, tried whole, lets a particle at the tip pass the next one; two steps on nothing could be
    triangulated. It is halved instead. It was 150 K hotter then, from one step to the next.
    """
    problem = cut_problem(
        workpiece={"length": 3.0, "height": 2.0},
        cutting={"speed": 200e3 / 60.0, "travel": 1.0},
        mesh={"tip_size": 0.005, "shear_zone_size": 0.012, "chip_size": 0.02, "surface_size": 0.02}
        | {"far_size": 0.4, "growth": 0.08},
        time={"step": 1.5e-7, "largest_step": 4.5e-7},
    )
    method = PfemMethod.start(problem)
    hottest = []
    while method.measure().step < 32:
        method.advance()
        hottest.append(method.measure().max_temperature)
    assert method.own_measures()["step_cuts"] >= 1
    assert np.diff(hottest).max() < 30.0
