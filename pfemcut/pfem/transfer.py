"""Transfer of fields from mesh to mesh, element to element and particle to particle (paper, section 2.1 and Box 1).

Nothing passes through nodal averages, so elements that did not change keep their values bit for bit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from meshing.remesh import RemeshMap
from pfemcut.pfem.mechanics import pressure_volume_ratios
from pfemcut.pfem.state import Fields, Transfer, declarations
from pfemcut.problem import Problem, VolumetricHistory

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def transfer_fields(fields: Fields, old: Mesh, remesh_map: RemeshMap) -> Fields:
    """``fields`` of the ``old`` mesh on the new one, each by its declared rule."""
    rules = {Transfer.INTERPOLATE: _interpolate, Transfer.INHERIT: _inherit}
    moved = {
        each.name: rules[each.transfer](getattr(fields, each.name), old, remesh_map)
        for each in declarations()
    }
    return Fields(**moved)


def _interpolate(values: Array, old: Mesh, remesh_map: RemeshMap) -> Array:
    corners = values[old.cells[remesh_map.inserted_cells]]
    inserted = np.einsum("ia,ia...->i...", remesh_map.inserted_barycentric, corners)
    return np.concatenate([values[remesh_map.kept], inserted])


def _inherit(values: Array, old: Mesh, remesh_map: RemeshMap) -> Array:
    return values[remesh_map.cells]


def carry_volume(problem: Problem, mesh: Mesh, fields: Fields, unchanged: BoolArray) -> Fields:
    """``fields`` with the volume ratios that the next step starts from, by the problem's rule.

    Parameters
    ----------
    problem
        Material, and the rule (:class:`pfemcut.problem.VolumetricHistory`).
    mesh, fields
        The new mesh and the fields transferred to it.
    unchanged
        Elements that join the same particles as before; (m,).
    """
    rule = problem.particles.volumetric_history
    if rule is VolumetricHistory.ELEMENT:
        return fields
    ratio = pressure_volume_ratios(problem.body.material, mesh, fields)
    if rule is VolumetricHistory.MIXED:
        ratio = np.where(unchanged, fields.volume_ratio, ratio)
    return replace(fields, volume_ratio=ratio)
