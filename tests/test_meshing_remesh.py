"""A remesh is a pure function that keeps the body's area and says where everything came from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import RULES, Array, rectangle_mesh, star_mesh
from remeshes import (
    SIZE,
    UNIFORM,
    assert_valid,
    bulged,
    deformed,
    interior_edge_lengths,
    moved_blocks,
    placements,
    run,
    size_fields,
)

from meshing.interior import refinement_points
from meshing.locate import locate
from meshing.mesh import Mesh, boundary_area, signed_areas
from meshing.remesh import RemeshMap
from meshing.sizes import SizeField


@given(moved_blocks, size_fields, placements)
def test_a_remesh_is_valid_and_conserves_the_area(mesh, sizes, place) -> None:
    new, where = run(mesh, sizes, place=place)
    assert_valid(new)
    before = signed_areas(mesh.points, mesh.cells).sum()
    assert signed_areas(new.points, new.cells).sum() == pytest.approx(before, rel=1e-12)
    assert where.area_before == pytest.approx(before, rel=1e-13)
    assert where.area_after == pytest.approx(before, rel=1e-12)


def arrays_of(mesh: Mesh, where: RemeshMap) -> list[Array]:
    boundary = mesh.boundary
    return [
        np.asarray(each)
        for each in (mesh.points, mesh.cells, mesh.ids, boundary.particles, boundary.parts, boundary.starts)
        + tuple(vars(where).values())
    ]


@given(moved_blocks, size_fields)
def test_a_remesh_is_a_pure_function(mesh, sizes) -> None:
    inputs = [mesh.points, mesh.cells, mesh.ids, mesh.boundary.particles, mesh.boundary.parts]
    copies = [each.copy() for each in inputs]
    first, second = (arrays_of(*run(mesh, sizes, place=bulged)) for _ in range(2))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(first, second, strict=True))
    assert all(np.array_equal(a, b) for a, b in zip(inputs, copies, strict=True))


@given(moved_blocks, size_fields, placements)
def test_the_map_says_where_everything_came_from(mesh, sizes, place) -> None:
    new, where = run(mesh, sizes, place=place)
    kept = len(where.kept)
    assert np.array_equal(new.ids[:kept], mesh.ids[where.kept])
    assert np.all(new.ids[kept:] >= mesh.next_id)
    assert where.removed == len(mesh.points) - kept
    assert len(where.cells) == len(where.unchanged) == len(new.cells)
    same = where.unchanged
    old_ids = np.sort(mesh.ids[mesh.cells[where.cells[same]]], axis=1)
    assert np.array_equal(np.sort(new.ids[new.cells[same]], axis=1), old_ids)
    # And no element that is in both meshes counts as changed.
    before = {tuple(ids) for ids in np.sort(mesh.ids[mesh.cells], axis=1).tolist()}
    after = np.sort(new.ids[new.cells], axis=1)
    assert same.tolist() == [tuple(ids) in before for ids in after.tolist()]


@given(moved_blocks, size_fields, placements)
def test_gauss_points_lie_in_the_old_element_they_inherit_from(mesh, sizes, place) -> None:
    new, where = run(mesh, sizes, place=place)
    changed = ~where.unchanged
    gauss = new.points[new.cells[changed]].mean(axis=1)
    smallest = barycentric(mesh.points[mesh.cells[where.cells[changed]]], gauss).min(axis=1)
    assert (smallest < -1e-9).sum() == where.outside
    # Those counted outside lie in no old element but outside the old body, or where a boundary particle shifted.
    everywhere = locate(mesh.points, mesh.cells, gauss[smallest < -1e-9])
    assert place is bulged or everywhere.outside.all()


def barycentric(corners: Array, points: Array) -> Array:
    """Barycentric coordinates of ``points`` (k, 2) in triangles ``corners`` (k, 3, 2), by solving 3 x 3 systems."""
    system = np.concatenate([corners.transpose(0, 2, 1), np.ones((len(points), 1, 3))], axis=1)
    right = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    return np.linalg.solve(system, right[..., None])[..., 0]


@given(moved_blocks, size_fields)
def test_barycentric_coordinates_reproduce_inserted_particles(mesh, sizes) -> None:
    """To 1e-12 of the body's size, as splits on the chord and centroids lie inside the old body.

    Where a collapse has moved the boundary outwards the coordinates are those of the nearest old point.
    """
    new, where = run(mesh, sizes, replace(RULES, boundary_removal=1e-9))
    inserted = new.points[len(where.kept) :]
    found = np.einsum("ia,iax->ix", where.inserted_barycentric, mesh.points[mesh.cells[where.inserted_cells]])
    assert np.allclose(found, inserted, rtol=0.0, atol=1e-12)


@given(st.integers(0, 2**31), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_locate_finds_the_triangle_that_holds_a_point(seed, a, b) -> None:
    mesh = star_mesh(seed % 1000, 30, 0.3, 80, hole=8)
    rng = np.random.default_rng(seed)
    cells = rng.integers(0, len(mesh.cells), 20)
    weights = np.array([1.0 - max(a, b), abs(a - b), min(a, b)])
    queries = np.einsum("a,iax->ix", weights, mesh.points[mesh.cells[cells]])
    found = locate(mesh.points, mesh.cells, queries)
    assert not found.outside.any()
    assert np.all(found.barycentric >= 0.0)
    again = np.einsum("ia,iax->ix", found.barycentric, mesh.points[mesh.cells[found.cells]])
    assert np.allclose(again, queries, rtol=0.0, atol=1e-8)


def test_points_in_a_hole_and_beyond_the_body_are_outside() -> None:
    mesh = star_mesh(5, 30, 0.1, 80, hole=8)
    assert locate(mesh.points, mesh.cells, np.array([(0.0, 0.0), (9.0, 0.0)])).outside.all()


@given(moved_blocks, size_fields, st.integers(0, 2**31))
def test_locked_particles_and_corners_stay(mesh, sizes, seed) -> None:
    """Corners are locked here as they are by supports: neither removed nor shifted, bit for bit."""
    flat = np.random.default_rng(seed).random(len(mesh.points)) < 0.3
    locked = np.zeros(len(mesh.points), dtype=bool)
    locked[mesh.boundary.particles] = flat[mesh.boundary.particles]
    starts = mesh.boundary.parts != mesh.boundary.parts[mesh.boundary.preceding]
    locked[mesh.boundary.particles[starts]] = True
    free = np.zeros(len(mesh.points), dtype=bool)
    free[mesh.boundary.particles] = ~locked[mesh.boundary.particles]
    new, where = run(mesh, sizes, place=bulged, locked=locked, free=free)
    number = {particle: i for i, particle in enumerate(where.kept.tolist())}
    held = np.flatnonzero(locked)
    assert np.array_equal(new.points[[number[i] for i in held.tolist()]], mesh.points[held])
    # Part boundaries are at the same particles.
    loops = new.boundary
    changes = loops.parts != loops.parts[loops.preceding]
    assert np.array_equal(new.ids[loops.particles[changes]], mesh.ids[mesh.boundary.particles[starts]])


def rotated_and_sheared(k: int) -> Array:
    """Deformation after ``k`` steps: two turns and a shear to and fro, three times up to 2.5; isochoric."""
    angle, shear = 4.0 * np.pi * k / 300.0, 2.5 * np.sin(6.0 * np.pi * k / 300.0)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return rotation @ np.array([[1.0, shear], [0.0, 1.0]])


def test_hundreds_of_remeshes_of_a_rotating_shearing_block() -> None:
    """Linear isochoric motion keeps a polygon's area exactly, so the drift (1e-11) is that of 300 remeshes."""
    mesh = rectangle_mesh(size=SIZE)
    area = boundary_area(mesh.points, mesh.boundary)
    seen, outside, edits = set(mesh.ids.tolist()), 0, 0
    too_wide, too_close = [], np.zeros(300, dtype=bool)
    for k in range(300):
        step = rotated_and_sheared(k + 1) @ np.linalg.inv(rotated_and_sheared(k))
        mesh = replace(mesh, points=mesh.points @ step.T)
        assert signed_areas(mesh.points, mesh.cells).min() > 0.0
        new, where = run(mesh)
        assert_valid(new)
        born = new.ids[len(where.kept) :]
        assert not seen & set(born.tolist())
        seen |= set(born.tolist())
        outside += where.outside
        edits += where.removed + len(born)
        mesh = new
        too_wide.append(refinement_wishes(mesh, UNIFORM) @ np.linalg.inv(rotated_and_sheared(k + 1)).T)
        # Of several crowded pairs only the closest goes at once, so a step may leave some below the rule.
        shortest = interior_edge_lengths(mesh).min() / (RULES.interior_removal * SIZE)
        too_close[k] = shortest < 1.0
        assert shortest > 0.5
    assert edits > 200  # otherwise nothing was tested
    assert boundary_area(mesh.points, mesh.boundary) == pytest.approx(area, rel=1e-11)
    assert outside < 30
    # No element waits long for its particle, and no crowded one for its removal.
    assert longest_wait(too_wide) < 6
    assert np.convolve(too_close, np.ones(6), "valid").max() < 6


def longest_wait(wishes: list[Array]) -> int:
    """Most steps in a row with wishes (k, 2) within a spacing of those before, in coordinates of the body.

    Which elements become too wide, and whether some do in every step, depends on the mesh that gmsh began with.
    """
    longest, before, ages = 0, np.zeros((0, 2)), np.zeros(0, dtype=int)
    for wished in wishes:
        near = np.linalg.norm(wished[:, None] - before, axis=2) < SIZE
        before, ages = wished, 1 + np.where(near, ages, 0).max(axis=1, initial=0)
        longest = max(longest, ages.max(initial=0))
    return longest


def refinement_wishes(mesh: Mesh, sizes: SizeField, score: Array | None = None) -> Array:
    return refinement_points(
        mesh.points,
        mesh.cells,
        sizes(mesh.points[mesh.cells].mean(axis=1)),
        radius_ratio=RULES.interior_radius,
        area_ratio=RULES.interior_area,
        clearance_ratio=RULES.interior_spacing,
        power_score=np.zeros(len(mesh.cells)) if score is None else score,
        power_smallest=RULES.power_smallest,
    )


def test_switches_stop_insertion_and_removal() -> None:
    mesh = deformed(3, 0.1)
    for sizes, rules in (
        (SizeField((), 0.05), replace(RULES, insert=False)),
        (SizeField((), 0.4), replace(RULES, remove=False)),
    ):
        new, where = run(mesh, sizes, rules)
        assert np.array_equal(new.ids, mesh.ids)
        assert where.removed == len(where.inserted_cells) == 0
