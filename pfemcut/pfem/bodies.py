"""Values that depend on the material of the body: computed body by body, one after the other in the mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from pfemcut.problem import Body, Problem

Array = NDArray[np.float64]


def over_cells(problem: Problem, mesh: Mesh, of: Callable[[Body, slice], Array]) -> Array:
    """Element values of all bodies from ``of(body, its elements)``."""
    return _joined([of(*each) for each in zip(problem.bodies, mesh.cell_ranges, strict=True)])


def over_particles(problem: Problem, mesh: Mesh, of: Callable[[Body, slice], Array]) -> Array:
    """Particle values of all bodies from ``of(body, its particles)``."""
    return _joined([of(*each) for each in zip(problem.bodies, mesh.particle_ranges, strict=True)])


def moduli(problem: Problem, mesh: Mesh) -> Array:
    """Shear and bulk modulus of the elements (MPa); shape (m, 2)."""

    def of(body: Body, cells: slice) -> Array:
        pair = (body.material.shear_modulus, body.material.bulk_modulus)
        return np.tile(pair, (len(mesh.cells[cells]), 1))

    return over_cells(problem, mesh, of)


def densities(problem: Problem, mesh: Mesh) -> Array:
    """Referential density of the elements (tonne/mm³); shape (m,)."""
    return over_cells(problem, mesh, lambda body, c: np.full(len(mesh.cells[c]), body.material.density))


def thermal_strains(problem: Problem, mesh: Mesh, temperature: Array) -> Array:
    """e = 3 alpha (theta - theta_0) of the particles at the ``temperature`` (n,) (K); shape (n,)."""
    return over_particles(problem, mesh, lambda body, p: body.material.thermal_strain(temperature[p]))


def _joined(parts: list[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
