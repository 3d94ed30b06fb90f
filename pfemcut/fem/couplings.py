"""Couplings between particles that share no element: contact between bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from pfemcut.fem import runtime
from pfemcut.fem.distribution import NodalSpace

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def coupled_matrix(form: Any, space: NodalSpace, groups: Sequence[IntArray], count: int) -> Any:
    """A matrix for the bilinear ``form`` with room for couplings within each of ``groups`` of particles.

    ``count`` is the number of all particles. Groups that reach over ranks get their room when they are filled.
    """
    if not groups:
        return runtime.new_matrix(form)
    node = np.full(count, -1, dtype=np.int32)
    node[space.particles] = np.arange(len(space.particles))
    local = (node[group] for group in groups)
    matrix = runtime.new_coupled_matrix(space.cpp, (each[each >= 0] for each in local))
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    return matrix


def add_blocks(
    matrix: Any, global_nodes: IntArray, size: int, rows: IntArray, columns: IntArray, blocks: Array
) -> None:
    """Add ``blocks`` (s, b, b) for the particles ``rows`` (s,) and ``columns`` (s,), where this rank owns the rows.

    The first b of the ``size`` unknowns of a particle take part.
    """
    first, last = matrix.getOwnershipRange()
    width = blocks.shape[1]
    mine = (size * global_nodes[rows] >= first) & (size * global_nodes[rows] < last)
    i = (size * global_nodes[rows[mine]][:, None] + np.arange(width)).astype(np.int32)
    j = (size * global_nodes[columns[mine]][:, None] + np.arange(width)).astype(np.int32)
    matrix.setValuesIJV(
        np.arange(0, width * i.size + 1, width, dtype=np.int32),
        np.repeat(j, width, axis=0).ravel(),
        blocks[mine].ravel(),
        addv=PETSc.InsertMode.ADD_VALUES,
        rowmap=i.ravel(),
    )


def pairs_within(groups: Sequence[IntArray]) -> tuple[IntArray, IntArray]:
    """Rows and columns of all pairs of particles within each of ``groups``."""
    if not groups:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    return (
        np.concatenate([np.repeat(group, len(group)) for group in groups]),
        np.concatenate([np.tile(group, len(group)) for group in groups]),
    )
