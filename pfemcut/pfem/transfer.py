"""Transfer of fields from mesh to mesh, element to element and particle to particle (paper, section 2.1 and Box 1).

Nothing passes through nodal averages, so elements that did not change keep their values bit for bit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from meshing.remesh import RemeshMap
from pfemcut.pfem.state import Fields, Transfer, declarations

Array = NDArray[np.float64]


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
