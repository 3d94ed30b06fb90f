"""The pieces in which triangles overlap tile both meshes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import Array, rectangle_mesh

from meshing.mesh import signed_areas
from meshing.overlap import overlap


def summed(index: Array, values: Array, count: int) -> Array:
    return np.bincount(index, values, minlength=count)


@settings(max_examples=20, deadline=None)
@given(size=st.floats(0.08, 0.3), jitter=st.floats(0.0, 0.35))
def test_pieces_tile_both_meshes_of_a_body_with_the_same_centroids(size: float, jitter: float) -> None:
    new, old = rectangle_mesh(size=size, jitter=jitter), rectangle_mesh(size=0.13)
    pieces = overlap(new.points[new.cells], old.points[old.cells])
    for mesh, index in ((new, pieces.new), (old, pieces.old)):
        area = signed_areas(mesh.points, mesh.cells)
        np.testing.assert_allclose(summed(index, pieces.area, len(area)), area, rtol=1e-10)
        for axis in (0, 1):
            moment = summed(index, pieces.area * pieces.centroid[:, axis], len(area))
            np.testing.assert_allclose(moment / area, mesh.points[mesh.cells, axis].mean(axis=1), atol=1e-10)


def test_a_mesh_overlaps_itself_in_its_own_triangles() -> None:
    mesh = rectangle_mesh(size=0.2)
    triangles = mesh.points[mesh.cells]
    pieces = overlap(triangles, triangles)
    real = pieces.area > 1e-15
    np.testing.assert_array_equal(pieces.new[real], pieces.old[real])
    np.testing.assert_allclose(pieces.area[real], signed_areas(mesh.points, mesh.cells), rtol=1e-13)


def test_the_overlap_of_two_crossed_triangles_is_a_hexagon() -> None:
    angles = 2.0 * np.pi * np.arange(3) / 3.0
    one = np.column_stack([np.cos(angles), np.sin(angles)])[None]
    pieces = overlap(one, -one)
    assert pieces.area == pytest.approx([0.75 * np.sqrt(3.0) * 4.0 / 6.0])
    np.testing.assert_allclose(pieces.centroid, 0.0, atol=1e-15)


def test_triangles_apart_share_nothing() -> None:
    one = np.array([[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]])
    assert len(overlap(one, one + [2.0, 0.0]).area) == 0
    assert len(overlap(one, one + [0.6, 0.6]).area) == 0  # only their bounding boxes overlap
    assert len(overlap(one[:0], one).area) == 0
