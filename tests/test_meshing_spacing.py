"""Remeshing brings particles to the wished spacing, wherever that comes from, and then rests."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from problems import RULES, rectangle_mesh
from remeshes import SIZE, UNIFORM, assert_valid, interior_edge_lengths, moved_blocks, run, size_fields

from meshing.mesh import Boundary, Mesh, circumradii, unique_edges
from meshing.remesh import SpacingFactors
from meshing.sizes import Box, Capsule, SizeField, SizeZone
from meshing.triangulation import constrained_delaunay


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
