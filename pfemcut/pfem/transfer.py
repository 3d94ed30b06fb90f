"""Transfer of fields from mesh to mesh, element to element and particle to particle (paper, section 2.1 and Box 1).

Nothing passes through nodal averages, so elements that did not change keep their values bit for bit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from meshing.mesh import Mesh, signed_areas
from meshing.overlap import overlap
from meshing.remesh import RemeshMap
from pfemcut.materials.return_mapping import elastic_strain
from pfemcut.pfem.mechanics import pressure_volume_ratios
from pfemcut.pfem.state import Fields, Transfer, Where, declarations
from pfemcut.problem import ElementTransfer, Problem, VolumetricHistory

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_LEAST_COVER = 1e-3  # of its area that a new element must share with vanished ones to take their values
_COLLINEAR = 1e-6  # relative determinant below which neighbours give no slope


def transfer_fields(
    fields: Fields, old: Mesh, new: Mesh, remesh_map: RemeshMap, rule: ElementTransfer
) -> Fields:
    """``fields`` of the ``old`` mesh on the ``new`` one; particle and element fields each by their declared rule."""
    on_elements = [each for each in declarations() if each.where is Where.ELEMENT]
    values = {each.name: getattr(fields, each.name) for each in declarations()}
    columns = np.column_stack(
        [
            1.0 / values[each.name] if each.transfer is Transfer.INHERIT_INVERSE else values[each.name]
            for each in on_elements
        ]
    )
    carried = transfer_elements(columns, old, new, remesh_map, rule)
    widths = np.cumsum([np.atleast_2d(values[each.name].T).shape[0] for each in on_elements])
    pieces = np.split(carried, widths[:-1], axis=1)
    moved = {
        each.name: transfer_particles(values[each.name], old, remesh_map)
        for each in declarations()
        if each.where is Where.PARTICLE
    }
    for each, piece in zip(on_elements, pieces, strict=True):
        if each.transfer is Transfer.INHERIT_UNIMODULAR:
            piece = _unimodular(piece, ~remesh_map.unchanged)
        elif each.transfer is Transfer.INHERIT_INVERSE:
            kept = values[each.name][remesh_map.cells, None]
            piece = np.where(remesh_map.unchanged[:, None], kept, 1.0 / piece)
        moved[each.name] = np.ascontiguousarray(piece.reshape(len(new.cells), *values[each.name].shape[1:]))
    return Fields(**moved)


def transfer_elements(
    values: Array, old: Mesh, new: Mesh, remesh_map: RemeshMap, rule: ElementTransfer
) -> Array:
    """Element ``values`` (m, c) of the ``old`` mesh on the ``new`` one; (k, c).

    1. An unchanged element keeps its values bit for bit, and so does the integral of what the others tile.
    2. SAMPLE: a changed element takes the values of the old element that contains its Gauss point.
    3. MEAN: it takes the mean over the pieces that it shares with the elements that vanished, by area.
    4. LINEAR: likewise, with values that vary linearly in each old element and have its value as their mean. The
       slope fits the elements around (least squares) and is limited so that no piece gets a value beyond theirs.
    """
    carried = values[remesh_map.cells]
    changed = np.flatnonzero(~remesh_map.unchanged)
    vanished = remesh_map.vanished(len(old.cells))
    if rule is ElementTransfer.SAMPLE or not len(changed) or not len(vanished):
        return carried
    triangles = new.points[new.cells[changed]]
    pieces = overlap(triangles, old.points[old.cells[vanished]])
    parts = values[vanished[pieces.old]]
    if rule is ElementTransfer.LINEAR:
        centroids = old.points[old.cells].mean(axis=1)
        offset = pieces.centroid - centroids[vanished[pieces.old]]
        parts = parts + _limited_changes(values, old.cells, centroids, vanished, pieces.old, offset)
    cover = np.bincount(pieces.new, pieces.area, minlength=len(changed))
    total = np.column_stack(
        [np.bincount(pieces.new, pieces.area * part, minlength=len(changed)) for part in parts.T]
    )
    # What an edit of the boundary added lies outside: the rest of the element stands for it, or the nearest element.
    covered = cover > _LEAST_COVER * signed_areas(new.points, new.cells[changed])
    carried[changed[covered]] = total[covered] / cover[covered, None]
    return carried


def _limited_changes(
    values: Array, cells: IntArray, centroids: Array, vanished: IntArray, owner: IntArray, offset: Array
) -> Array:
    """What the slopes add at ``offset`` (p, 2) from the centroids of the elements ``vanished[owner]``; (p, c)."""
    i, j = _pairs_around(cells, vanished)
    d = centroids[j] - centroids[vanished[i]]
    rise = values[j] - values[vanished[i]]
    weight = 1.0 / np.sum(d**2, axis=1)
    count, columns = len(vanished), values.shape[1]
    xx, yy, xy = (
        np.bincount(i, weight * d[:, a] * d[:, b], minlength=count) for a, b in ((0, 0), (1, 1), (0, 1))
    )
    determinant = xx * yy - xy**2
    solvable = determinant > _COLLINEAR * (xx + yy) ** 2
    scale = np.where(solvable, 1.0 / np.where(solvable, determinant, 1.0), 0.0)
    least = grouped(np.minimum, np.zeros((count, columns)), i, rise)
    most = grouped(np.maximum, np.zeros((count, columns)), i, rise)
    change = np.empty((len(owner), columns))
    for column in range(columns):
        x, y = (np.bincount(i, weight * d[:, a] * rise[:, column], minlength=count) for a in (0, 1))
        slope = np.column_stack([(yy * x - xy * y) * scale, (xx * y - xy * x) * scale])
        change[:, column] = np.sum(slope[owner] * offset, axis=1)
    bound = np.where(change > 0.0, most[owner], least[owner])
    beyond = np.abs(change) > np.abs(bound)
    allowed = np.where(beyond, bound / np.where(beyond, change, 1.0), 1.0)
    return grouped(np.minimum, np.ones((count, columns)), owner, allowed)[owner] * change


def grouped(operation: Any, start: Array, groups: IntArray, values: Array) -> Array:
    """``start`` (n, c) with the ``values`` (k, c) of each of the ``groups`` (k,) taken in; faster than ``ufunc.at``."""
    if not len(groups):
        return start
    order = np.argsort(groups, kind="stable")
    first = np.flatnonzero(np.diff(groups[order], prepend=-1))
    rows = groups[order[first]]
    reduced = start.copy()
    reduced[rows] = operation(start[rows], operation.reduceat(values[order], first, axis=0))
    return reduced


def _pairs_around(cells: IntArray, centres: IntArray) -> tuple[IntArray, IntArray]:
    """Pairs of a place in ``centres`` and another element that shares a particle with that element."""
    shared = np.zeros(int(cells.max()) + 1, dtype=bool)
    shared[cells[centres]] = True
    around = np.flatnonzero(shared[cells].any(axis=1))
    joins = csr_matrix(
        (np.ones(3 * len(around)), (np.repeat(around, 3), cells[around].ravel())),
        shape=(len(cells), len(shared)),
    )
    pairs = (joins[centres] @ joins.T).tocoo()
    apart = centres[pairs.row] != pairs.col
    return pairs.row[apart].astype(np.int64), pairs.col[apart].astype(np.int64)


def _unimodular(tensors: Array, where: BoolArray) -> Array:
    """``tensors`` (m, 4) whose spherical part restores det = 1 ``where`` elements changed: the stress is kept."""
    restored = tensors.copy()
    deviators = tensors[where]
    deviators[:, :3] -= deviators[:, :3].mean(axis=1, keepdims=True)
    restored[where] = elastic_strain(deviators, 1.0)
    return restored


def transfer_particles(values: Array, old: Mesh, remesh_map: RemeshMap) -> Array:
    """Particle ``values`` (n, ...) of the ``old`` mesh: kept on particles, interpolated on inserted ones."""
    corners = values[old.cells[remesh_map.inserted_cells]]
    inserted = np.einsum("ia,ia...->i...", remesh_map.inserted_barycentric, corners)
    return np.concatenate([values[remesh_map.kept], inserted])


def carry_volume(
    problem: Problem,
    mesh: Mesh,
    fields: Fields,
    unchanged: BoolArray,
    elements: IntArray | slice = slice(None),
) -> Fields:
    """``fields`` with the volume ratios that the next step starts from, by the problem's rule.

    Parameters
    ----------
    problem
        Material, and the rule (:class:`pfemcut.problem.VolumetricHistory`).
    mesh, fields
        The new mesh and the fields transferred to it.
    unchanged
        Elements that join the same particles as before; (m,).
    elements
        Those to renew, all by default; others keep what they have.
    """
    renewed = np.zeros(len(mesh.cells), dtype=bool)
    renewed[elements] = True
    renewed &= follows_pressure(problem, unchanged)
    ratio = fields.volume_ratio.copy()
    ratio[renewed] = pressure_volume_ratios(problem.body.material, mesh.cells[renewed], fields)
    return replace(fields, volume_ratio=ratio)


def follows_pressure(problem: Problem, unchanged: BoolArray) -> BoolArray:
    """Elements whose J comes from the particles' pressure, by the problem's rule; (m,)."""
    match problem.particles.volumetric_history:
        case VolumetricHistory.ELEMENT:
            return np.zeros(len(unchanged), dtype=bool)
        case VolumetricHistory.MIXED:
            return ~unchanged
        case _:
            return np.ones(len(unchanged), dtype=bool)
