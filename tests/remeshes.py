"""Remeshes of a deformed block: what the tests of remeshing share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st
from problems import RULES, Array, rectangle_mesh

from meshing.mesh import Mesh, boundary_area, signed_areas, unique_edges
from meshing.remesh import RemeshMap, SpacingFactors, SpacingRules, remesh
from meshing.sizes import Capsule, SizeField, SizeZone

SIZE = 0.12
UNIFORM = SizeField((), SIZE)
GRADED = SizeField((SizeZone(Capsule((0.9, 0.9), (0.9, 0.9), 0.1), 0.03, 0.15),), 0.2)


def on_chord(a: Array, b: Array) -> Array:
    return 0.5 * (a + b)


def bulged(a: Array, b: Array) -> Array:
    along = b - a
    return 0.5 * (a + b) + 0.03 * np.column_stack([along[:, 1], -along[:, 0]])


def run(
    mesh: Mesh, sizes: SizeField = UNIFORM, rules: SpacingRules = RULES, place=on_chord, **changes: Array
) -> tuple[Mesh, RemeshMap]:
    free = np.zeros(len(mesh.points), dtype=bool)
    free[mesh.boundary.particles] = True
    arguments = {
        "refine_score": np.zeros(len(mesh.cells)),
        "removal_scale": np.ones(len(mesh.points)),
        "coarsening": SpacingFactors.none(len(mesh.points)),
        "locked": np.zeros(len(mesh.points), dtype=bool),
        "free": free,
    }
    return remesh(mesh, sizes, rules, place_boundary=place, **{**arguments, **changes})


def deformed(seed: int, strength: float) -> Mesh:
    """A block after a smooth random motion that inverts no element."""
    mesh = rectangle_mesh(size=SIZE)
    rng = np.random.default_rng(seed)
    points = mesh.points.copy()
    for _ in range(3):
        wave = rng.uniform(-4.0, 4.0, 2)
        points += strength * np.outer(np.sin(mesh.points @ wave + rng.uniform(0.0, 6.0)), rng.normal(size=2))
    moved = replace(mesh, points=points, ids=mesh.ids + 1000, next_id=mesh.next_id + 1000)
    return moved if signed_areas(points, mesh.cells).min() > 0.0 else deformed(seed, 0.5 * strength)


# Not tiny floats: the robust predicates of the triangulation can't work with subnormal coordinates.
strengths = st.integers(0, 150).map(lambda k: 1e-3 * k)
moved_blocks = st.builds(deformed, st.integers(0, 2**31), strengths)
size_fields = st.sampled_from([UNIFORM, GRADED, SizeField((), 0.08), SizeField((), 0.2)])
placements = st.sampled_from([on_chord, bulged])


def assert_valid(mesh: Mesh) -> None:
    areas = signed_areas(mesh.points, mesh.cells)
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(boundary_area(mesh.points, mesh.boundary), rel=1e-13)
    assert len(np.unique(mesh.ids)) == len(mesh.ids) == len(mesh.points)
    assert mesh.ids.max() < mesh.next_id
    directed = np.vstack([mesh.cells[:, [0, 1]], mesh.cells[:, [1, 2]], mesh.cells[:, [2, 0]]])
    assert {tuple(e) for e in mesh.boundary.edges.tolist()} <= {tuple(e) for e in directed.tolist()}


def interior_edge_lengths(mesh: Mesh) -> Array:
    edges = unique_edges(mesh.cells)
    on_boundary = np.isin(np.arange(len(mesh.points)), mesh.boundary.particles)
    edges = edges[~on_boundary[edges].all(axis=1)]
    return np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T)
