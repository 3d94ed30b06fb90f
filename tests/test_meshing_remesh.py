"""A remesh is a pure function that keeps the body's area, says where everything came from, and comes to rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import RULES, Array, rectangle_mesh, star_mesh

from meshing.interior import refinement_points
from meshing.locate import locate
from meshing.mesh import Boundary, Mesh, boundary_area, circumradii, signed_areas, unique_edges
from meshing.remesh import RemeshMap, SpacingFactors, SpacingRules, remesh
from meshing.sizes import Box, Capsule, SizeField, SizeZone
from meshing.triangulation import constrained_delaunay

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
    too_wide, too_close = np.zeros(300, dtype=bool), np.zeros(300, dtype=bool)
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
        too_wide[k] = len(refinement_wishes(mesh, UNIFORM)) > 0
        # Of several crowded pairs only the closest goes at once, so a step may leave some below the rule.
        shortest = interior_edge_lengths(mesh).min() / (RULES.interior_removal * SIZE)
        too_close[k] = shortest < 1.0
        assert shortest > 0.5
    assert edits > 200  # otherwise nothing was tested
    assert boundary_area(mesh.points, mesh.boundary) == pytest.approx(area, rel=1e-11)
    assert outside < 30
    # No element waits long for its particle, and no crowded one for its removal.
    for late in (too_wide, too_close):
        assert np.convolve(late, np.ones(6), "valid").max() < 6


def interior_edge_lengths(mesh: Mesh) -> Array:
    edges = unique_edges(mesh.cells)
    on_boundary = np.isin(np.arange(len(mesh.points)), mesh.boundary.particles)
    edges = edges[~on_boundary[edges].all(axis=1)]
    return np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T)


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


def settled(mesh: Mesh, sizes: SizeField, passes: int = 12) -> Mesh:
    for _ in range(passes):
        mesh, _ = run(mesh, sizes)
    return mesh


@settings(max_examples=15)
@given(moved_blocks, size_fields)
def test_particles_at_rest_settle_within_a_few_passes(mesh, sizes) -> None:
    """After 12 passes nothing changes bit for bit, no edge is below the removal rule, none above the split rule."""
    mesh = settled(mesh, sizes)
    again, where = run(mesh, sizes)
    assert again.points.tobytes() == mesh.points.tobytes()
    assert np.array_equal(again.ids, mesh.ids)
    assert where.unchanged.all()
    edges = unique_edges(mesh.cells)
    on_boundary = np.isin(np.arange(len(mesh.points)), mesh.boundary.particles)
    edges = edges[~on_boundary[edges].all(axis=1)]
    length = np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T)
    spacing = sizes(mesh.points)[edges].min(axis=1)
    assert np.all(length >= RULES.interior_removal * spacing)
    a, b = mesh.points[mesh.boundary.edges.T]
    assert np.all(np.hypot(*(b - a).T) <= RULES.boundary_split * sizes(0.5 * (a + b)))


def test_a_good_mesh_at_rest_is_left_alone() -> None:
    """The initial mesh, whose spacing is the wished one: no particle inserted, removed or moved."""
    mesh = rectangle_mesh(size=SIZE)
    new, where = run(mesh)
    assert new.points.tobytes() == mesh.points.tobytes()
    assert np.array_equal(new.ids, mesh.ids)
    assert where.removed == 0 and len(where.inserted_cells) == 0
    assert where.unchanged.mean() > 0.99  # cocircular pairs may flip


def test_refinement_halves_a_coarse_mesh() -> None:
    """After settling at half the size there are four times the particles, within 25 %."""
    coarse = rectangle_mesh(size=SIZE)
    fine = settled(coarse, SizeField((), 0.5 * SIZE))
    wanted = len(rectangle_mesh(size=0.5 * SIZE).points)
    assert len(fine.points) == pytest.approx(wanted, rel=0.25)
    assert circumradii(fine.points, fine.cells).max() < 1.3 * 0.5 * SIZE


def test_coarsening_thins_a_fine_mesh() -> None:
    fine = rectangle_mesh(size=0.3 * SIZE)
    coarse = settled(fine, UNIFORM, passes=30)
    assert interior_edge_lengths(coarse).min() >= RULES.interior_removal * SIZE
    assert len(coarse.points) < 0.4 * len(fine.points)


def test_coarsening_thins_inside_and_on_the_free_boundary_and_comes_to_rest() -> None:
    """Factors that jump from one to three, beside a boundary that may not shift: nothing is edited for ever."""
    mesh = rectangle_mesh(width=3.0, size=SIZE)
    before = mesh
    for _ in range(40):
        x, y = mesh.points.T
        factor = np.where(x > 1.0, 3.0, 1.0)
        free = np.zeros(len(mesh.points), dtype=bool)
        free[mesh.boundary.particles] = True
        free[y == 0.0] = False
        # As the estimator has it: a particle next to one that wants the wished spacing is not removed.
        near = factor.copy()
        np.minimum.at(near, mesh.cells.ravel(), np.repeat(factor[mesh.cells].min(axis=1), 3))
        mesh, where = run(mesh, free=free, coarsening=SpacingFactors(near, factor))
    assert len(where.inserted_cells) == where.removed == 0
    assert_valid(mesh)

    def counts(of: Mesh) -> tuple[int, int, int]:
        on_boundary = np.isin(np.arange(len(of.points)), of.boundary.particles)
        x, y = of.points.T
        far = x > 1.3
        return (far & ~on_boundary).sum(), (far & (y == 1.0)).sum(), (far & (y == 0.0)).sum()

    inside, free_side, held_side = counts(mesh)
    inside_before, free_before, held_before = counts(before)
    assert inside < 0.35 * inside_before
    assert free_side < 0.65 * free_before
    assert held_side == held_before
    kept = np.isin(before.ids, mesh.ids)
    assert kept[before.points[:, 0] < 0.8].all()


def test_no_boundary_edge_collapses_at_the_cost_of_a_split_beside_it() -> None:
    """Beside a corner that holds the wished spacing a collapse would make an edge too long: one that comes back."""
    spacing = 0.065
    right = np.array([0.0, 0.0667, 0.1334, 0.2335, 0.3335, 0.4335])
    width = np.linspace(0.0, 0.4, 5)
    bottom = np.column_stack([width, np.zeros(5)])
    side = np.column_stack([np.full(6, 0.4), right])
    top = np.column_stack([width[::-1], np.full(5, right[-1])])
    left = np.column_stack([np.zeros(5), np.linspace(right[-1], 0.0, 5)])
    points = np.vstack([each[:-1] for each in (bottom, side, top, left)])
    count = len(points)
    boundary = Boundary(np.arange(count), np.repeat([0, 1, 2, 3], [4, 5, 4, 4]), np.array([0, count]))
    cells = constrained_delaunay(points, boundary.edges)
    mesh = Mesh(points, cells, boundary, np.arange(count), count)
    wide = np.full(count, 3.0)
    free = mesh.points[:, 1] > 0.0
    _, where = run(mesh, SizeField((), spacing), free=free, coarsening=SpacingFactors(wide, wide))
    assert where.removed == 0
    everywhere = np.ones(count, dtype=bool)  # without such a corner the edges go
    _, where = run(mesh, SizeField((), spacing), free=everywhere, coarsening=SpacingFactors(wide, wide))
    assert where.removed > 0


def test_plastic_power_refines_to_the_smallest_spacing_and_not_beyond() -> None:
    mesh = rectangle_mesh(size=SIZE)
    for _ in range(12):
        centroid = mesh.points[mesh.cells].mean(axis=1)
        hot = np.hypot(*(centroid - 0.5).T) < 0.2
        scale = np.ones(len(mesh.points))
        scale[mesh.cells[hot]] = 0.4 * RULES.power_smallest / RULES.interior_removal
        mesh, where = run(mesh, refine_score=2.0 * hot, removal_scale=scale)
    assert len(where.inserted_cells) == where.removed == 0
    radius = circumradii(mesh.points, mesh.cells)[hot]
    assert radius.max() < RULES.interior_radius * SIZE * 0.75
    assert radius.min() > 0.2 * RULES.power_smallest * SIZE


def test_switches_stop_insertion_and_removal() -> None:
    mesh = deformed(3, 0.1)
    for sizes, rules in (
        (SizeField((), 0.05), replace(RULES, insert=False)),
        (SizeField((), 0.4), replace(RULES, remove=False)),
    ):
        new, where = run(mesh, sizes, rules)
        assert np.array_equal(new.ids, mesh.ids)
        assert where.removed == len(where.inserted_cells) == 0


def test_size_field_is_the_smallest_wish_and_moves_along() -> None:
    field = SizeField(
        (
            SizeZone(Capsule((0.0, 0.0), (1.0, 0.0), 0.1), 0.01, 0.5),
            SizeZone(Box((2.0, -np.inf), (np.inf, np.inf)), 0.02, 0.1),
        ),
        0.3,
    )
    points = np.array([(0.5, 0.05), (0.5, 0.3), (3.0, 7.0), (1.9, 5.0), (-9.0, 0.0)])
    expected = np.array([0.01, 0.01 + 0.5 * 0.2, 0.02, 0.03, 0.3])
    assert field(points) == pytest.approx(expected, rel=1e-14)
    shift = np.array([0.7, -0.2])
    assert field.moved(shift)(points + shift) == pytest.approx(expected, rel=1e-13)


def test_a_particle_without_removal_distance_stays() -> None:
    mesh = rectangle_mesh(size=SIZE)
    with np.errstate(all="raise"):
        _, where = run(mesh, sizes=SizeField((), 4.0 * SIZE), removal_scale=np.zeros(len(mesh.points)))
    on_boundary = np.isin(np.arange(len(mesh.points)), mesh.boundary.particles)
    assert np.isin(np.flatnonzero(~on_boundary), where.kept).all()
