"""Element values recovered at the particles by patches, which reach the surface without losing a gradient.

Zienkiewicz and Zhu, The superconvergent patch recovery and a posteriori error estimates, part 1, Int. J. Numer. Meth.
Eng. 33, 1992, 1331-1364: a polynomial, here linear, is fitted to the values at the elements' centres around a
particle. A mean over the elements around a particle of the surface would be a value a third of an element below it. The
patch of a particle of the boundary, which has few elements, takes those of its neighbours in.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix

from pfemcut.method import Frame

Array = NDArray[np.float64]

NEIGHBOURS = 0.2
"""Weight of the elements of its neighbours in the patch of a particle of the boundary."""
_REGULAR = (
    1e-9  # of the patch's size squared, added to the moments: a patch of collinear centres gives its mean
)


def recovered(frame: Frame, values: Array) -> Array:
    """Linear fit of element ``values`` (m, c) around each particle, there; shape (n, c)."""
    count, cells = len(frame.points), frame.cells
    corners = frame.points[cells]
    centre, area = corners.mean(axis=1), triangle_areas(corners)
    members = coo_matrix(
        (np.ones(cells.size), (cells.ravel(), np.repeat(np.arange(len(cells)), 3))), (count, len(cells))
    ).tocsr()
    on_boundary = np.zeros(count, dtype=bool)
    for loop in frame.loops:
        on_boundary[loop] = True
    # Elements of the neighbours too, each once.
    wider = (members @ members.T @ members).tocsr()
    wider.data[:] = NEIGHBOURS
    patch = coo_matrix((1.0 - NEIGHBOURS) * members + wider.multiply(on_boundary[:, None].astype(float)))
    at, element, share = patch.row, patch.col, patch.data
    offset = centre[element] - frame.points[at]
    size = np.sqrt(np.bincount(at, area[element], minlength=count))
    basis = np.column_stack([np.ones(len(at)), offset / size[at, None]])
    weight = share * area[element] / size[at] ** 2

    def sums(rows: Array) -> Array:
        return np.column_stack([np.bincount(at, weight * each, minlength=count) for each in rows.T])

    moments = sums(np.einsum("ki,kj->kij", basis, basis).reshape(len(at), 9)).reshape(count, 3, 3)
    moments[:, 1, 1] += _REGULAR
    moments[:, 2, 2] += _REGULAR
    loads = np.stack([sums(basis * each[element][:, None]) for each in values.T], axis=2)
    return np.asarray(np.linalg.solve(moments, loads)[:, 0, :])


def triangle_areas(corners: Array) -> Array:
    """Areas (mm²) of triangles with ``corners`` (m, 3, 2); shape (m,)."""
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
