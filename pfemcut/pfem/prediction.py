"""First iterate of a step: the motion that the tool's neighbourhood had in the last step.

Chip formation is nearly steady as seen from the tool, while a particle's own velocity changes quickly as it passes the
shear zone. So a particle is predicted to move as the one did that was in its place, relative to the tool, a step ago.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.interpolate import interpolate
from meshing.mesh import Mesh
from pfemcut.pfem.state import Fields, State
from pfemcut.problem import Problem

Array = NDArray[np.float64]

_OVERHANG = 0.5  # barycentric: how far outside its triangles the last motion is continued


def predict(problem: Problem, last: State, mesh: Mesh, fields: Fields, step: float, *, steady: bool) -> Array:
    """Displacement over ``step`` (s) and pressure at its end, a guess; shape (n, 3).

    Parameters
    ----------
    problem
        With the cut and its tool.
    last
        State at the end of the last step, before the particles were edited.
    mesh, fields
        The new mesh, and the fields carried to it.
    step
        Step length (s).
    steady
        Whether to believe that the motion is steady as seen from the tool; else, and in problems that are no cuts, a
        particle's own last motion is repeated.
    """
    ratio = step / last.clock.last_dt
    guess = np.column_stack([fields.last_displacement * ratio, fields.pressure])
    if not (steady and problem.cut and fields.last_displacement.any()):
        return guess
    advance = np.asarray(problem.tool[0].velocity)
    old = last.mesh
    before = old.points - last.fields.last_displacement
    motion, known = interpolate(
        before,
        old.cells,
        last.fields.last_displacement,
        mesh.points - advance * last.clock.last_dt,
        _OVERHANG,
    )
    guess[known, :2] = motion[known] * ratio
    pressure, known = interpolate(
        old.points,
        old.cells,
        last.fields.pressure[:, None],
        mesh.points + guess[:, :2] - advance * step,
        _OVERHANG,
    )
    guess[known, 2] = pressure[known, 0]
    return guess
