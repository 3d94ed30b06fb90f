"""Several bodies in one mesh: joining their meshes and taking them apart.

Bodies share no particles. A body alone numbers its boundary parts from zero; identities are those of the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Boundary, Mesh

IntArray = NDArray[np.int64]


def joined(meshes: Sequence[Mesh], first_parts: Sequence[int]) -> Mesh:
    """One mesh of all bodies, whose parts get numbers from ``first_parts`` on; a single one stays as it is."""
    if len(meshes) == 1:
        return meshes[0]
    first_particles = _starts([len(mesh.points) for mesh in meshes])
    first_cells = _starts([len(mesh.cells) for mesh in meshes])
    first_entries = _starts([len(mesh.boundary.particles) for mesh in meshes])
    boundary = Boundary(
        np.concatenate(
            [mesh.boundary.particles + a for mesh, a in zip(meshes, first_particles, strict=True)]
        ),
        np.concatenate([mesh.boundary.parts + a for mesh, a in zip(meshes, first_parts, strict=True)]),
        np.concatenate(
            [[0], *(mesh.boundary.starts[1:] + a for mesh, a in zip(meshes, first_entries, strict=True))]
        ),
    )
    return Mesh(
        points=np.vstack([mesh.points for mesh in meshes]),
        cells=np.vstack([mesh.cells + a for mesh, a in zip(meshes, first_particles, strict=True)]),
        boundary=boundary,
        ids=np.concatenate([mesh.ids for mesh in meshes]),
        next_id=max(mesh.next_id for mesh in meshes),
        first_particles=first_particles,
        first_cells=first_cells,
    )


def separated(mesh: Mesh, first_parts: Sequence[int]) -> tuple[Mesh, ...]:
    """The mesh of each body; the inverse of :func:`joined`."""
    if len(mesh.first_particles) == 1:
        return (mesh,)
    return tuple(
        Mesh(
            mesh.points[particles],
            mesh.cells[cells] - particles.start,
            _boundary_within(mesh.boundary, particles, first_part),
            mesh.ids[particles],
            mesh.next_id,
        )
        for particles, cells, first_part in zip(
            mesh.particle_ranges, mesh.cell_ranges, first_parts, strict=True
        )
    )


def renumbered(mesh: Mesh, first_id: int) -> Mesh:
    """``mesh`` with identities that begin at the given one."""
    return replace(mesh, ids=mesh.ids + first_id, next_id=mesh.next_id + first_id)


def _boundary_within(boundary: Boundary, particles: slice, first_part: int) -> Boundary:
    first = boundary.particles[boundary.starts[:-1]]
    loops = np.flatnonzero((first >= particles.start) & (first < particles.stop))
    a, b = boundary.starts[loops[0]], boundary.starts[loops[-1] + 1]
    return Boundary(
        boundary.particles[a:b] - particles.start,
        boundary.parts[a:b] - first_part,
        boundary.starts[loops[0] : loops[-1] + 2] - a,
    )


def _starts(counts: Sequence[int]) -> IntArray:
    return np.concatenate([[0], np.cumsum(counts[:-1])]).astype(np.int64)
