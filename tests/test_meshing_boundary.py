"""The boundary is preserved by the triangulation and edited without changing the body's area."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from problems import Array, star_mesh, star_outline

from meshing.boundary import Outline, collapse_short_edges, corners, split_long_edges
from meshing.mesh import Boundary, boundary_area, signed_areas, unique_edges
from meshing.triangulation import BoundaryCrossing, TriangulationFailed, constrained_delaunay

seeds = st.integers(0, 2**31)
stars = st.builds(
    star_mesh,
    seeds,
    count=st.integers(8, 60),
    noise=st.floats(0.0, 0.4),
    interior=st.integers(0, 120),
    hole=st.sampled_from([0, 0, 5, 12]),
)
outlines = st.builds(
    star_outline,
    seeds,
    count=st.integers(16, 200),
    noise=st.floats(0.0, 0.15),
    hole=st.sampled_from([0, 9, 40]),
)


@given(stars)
def test_every_boundary_edge_is_an_edge_of_exactly_one_triangle(mesh) -> None:
    directed = np.vstack([mesh.cells[:, [0, 1]], mesh.cells[:, [1, 2]], mesh.cells[:, [2, 0]]])
    found = {tuple(edge) for edge in directed.tolist()}
    assert len(found) == len(directed)
    outer = {edge for edge in found if edge[::-1] not in found}
    # The body on the left: the triangle has the boundary edge in the loop's own direction.
    assert outer == {tuple(edge) for edge in mesh.boundary.edges.tolist()}


@given(stars)
def test_triangles_are_counter_clockwise_and_fill_the_polygon(mesh) -> None:
    areas = signed_areas(mesh.points, mesh.cells)
    assert np.all(areas > 0.0)
    assert areas.sum() == pytest.approx(boundary_area(mesh.points, mesh.boundary), rel=1e-13)


@given(stars)
def test_every_particle_is_used(mesh) -> None:
    assert len(np.unique(mesh.cells)) == len(mesh.points)


def opposite_angles(points: Array, cells) -> dict[tuple[int, int], list[float]]:
    """Angles (rad) opposite to each edge, by the edge's sorted ends."""
    angles: dict[tuple[int, int], list[float]] = {}
    for cell in cells:
        for k in range(3):
            apex, a, b = cell[k], cell[(k + 1) % 3], cell[(k + 2) % 3]
            u, v = points[a] - points[apex], points[b] - points[apex]
            angle = np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)
            angles.setdefault((min(a, b), max(a, b)), []).append(float(angle))
    return angles


@settings(max_examples=40)
@given(stars)
def test_edges_other_than_the_boundary_are_delaunay(mesh) -> None:
    """The in-circle condition as a sum of opposite angles of at most pi (1e-9 for round-off)."""
    constrained = {(min(e), max(e)) for e in mesh.boundary.edges.tolist()}
    angles = opposite_angles(mesh.points, mesh.cells)
    assert all(len(pair) == 1 for edge, pair in angles.items() if edge in constrained)
    inner = [sum(pair) for edge, pair in angles.items() if edge not in constrained]
    assert max(inner, default=0.0) <= np.pi + 1e-9


def test_unique_edges_obey_eulers_formula() -> None:
    mesh = star_mesh(3, 40, 0.2, 150)
    assert len(mesh.points) - len(unique_edges(mesh.cells)) + len(mesh.cells) == 1


def test_crossing_boundary_is_refused() -> None:
    """Far along the loop it is contact; between neighbours the boundary folds."""
    bow_tie = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
    with pytest.raises(TriangulationFailed, match="folds"):
        constrained_delaunay(bow_tie, np.array([(0, 1), (1, 2), (2, 3), (3, 0)]))
    # The same with six particles on each of the two outer sides.
    right = np.column_stack([np.ones(6), np.linspace(0.9, 0.1, 6)])
    left = np.column_stack([np.zeros(6), np.linspace(0.9, 0.1, 6)])
    points = np.vstack([bow_tie[:2], right, bow_tie[2:], left])
    loop = np.arange(len(points))
    with pytest.raises(BoundaryCrossing, match=r"near \(0.5"):
        constrained_delaunay(points, np.column_stack([loop, np.roll(loop, -1)]))


def test_touching_boundary_is_refused() -> None:
    """A chip's particle that lies exactly on another edge."""
    points = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.0), (0.0, 2.0)])
    with pytest.raises(TriangulationFailed, match="on a boundary edge"):
        constrained_delaunay(points, np.array([(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)]))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_positions_that_are_not_finite_are_refused(bad: float) -> None:
    points = np.array([(0.0, 0.0), (1.0, bad), (1.0, 1.0), (0.0, 1.0)])
    with pytest.raises(TriangulationFailed, match="not finite"):
        constrained_delaunay(points, np.array([(0, 1), (1, 2), (2, 3), (3, 0)]))


def edge_lengths(outline: Outline) -> Array:
    return np.hypot(*(outline.points[outline.topology.following] - outline.points).T)


def part_runs(outline: Outline) -> list[list[int]]:
    """Order of the parts along each loop."""
    runs = []
    for first, last in zip(outline.starts[:-1], outline.starts[1:], strict=True):
        parts = outline.parts[first:last]
        runs.append(parts[np.r_[True, parts[1:] != parts[:-1]]].tolist())
    return runs


@given(outlines, seeds, st.floats(0.2, 1.5))
def test_collapse_conserves_the_area_and_leaves_locked_particles_and_corners(outline, seed, factor) -> None:
    rng = np.random.default_rng(seed)
    locked = rng.random(len(outline.points)) < 0.2
    shortest = factor * edge_lengths(outline).mean() * rng.uniform(0.5, 1.5, len(outline.points))
    held = locked | corners(outline)
    edited = collapse_short_edges(outline, shortest, locked)

    assert edited.area == pytest.approx(outline.area, rel=1e-12)
    stayed = edited.particles[edited.particles >= 0]
    assert np.all(np.isin(np.flatnonzero(held), stayed))
    assert np.array_equal(edited.points[edited.particles >= 0], outline.points[stayed])
    assert part_runs(edited) == part_runs(outline)
    # Each collapse replaces two particles by one.
    assert len(edited.points) - len(stayed) == len(outline.points) - len(edited.points)
    assert np.all(np.diff(edited.starts) >= np.minimum(np.diff(outline.starts), 6))


def circle(count: int, jitter: float = 0.0, seed: int = 0) -> Outline:
    rng = np.random.default_rng(seed)
    angle = 2.0 * np.pi * (np.arange(count) + jitter * rng.uniform(-0.5, 0.5, count)) / count
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    return Outline(points, np.arange(count), np.zeros(count, dtype=np.int64), np.array([0, count]))


def test_short_edges_vanish_within_a_few_collapses() -> None:
    """Repeated on an unevenly spaced circle, no edge stays shorter than the limit."""
    outline = circle(200, jitter=0.9)
    limit = 0.6 * edge_lengths(outline).mean()
    assert edge_lengths(outline).min() < 0.3 * limit
    for _ in range(6):
        count = len(outline.points)
        outline = collapse_short_edges(outline, np.full(count, limit), np.zeros(count, dtype=bool))
        outline = Outline(outline.points, np.arange(len(outline.points)), outline.parts, outline.starts)
    assert edge_lengths(outline).min() >= limit


def test_a_corner_does_not_keep_short_edges_from_collapsing() -> None:
    """Edges shorten towards a corner, whose own edge stays: the others must go within a few passes."""
    x = np.r_[0.0, np.cumsum(np.linspace(1.0, 0.1, 30))]
    points = np.vstack([np.column_stack([x, 0.0 * x]), [(x[-1], 30.0), (0.0, 30.0)]])
    parts = np.r_[np.zeros(30, dtype=np.int64), 1, 2, 3]
    outline = Outline(points, np.arange(33), parts, np.array([0, 33]))
    for _ in range(10):
        count = len(outline.points)
        outline = collapse_short_edges(outline, np.full(count, 0.5), np.zeros(count, dtype=bool))
        outline = Outline(outline.points, np.arange(len(outline.points)), outline.parts, outline.starts)
    assert (edge_lengths(outline) < 0.5).sum() <= 1


def test_collapse_keeps_a_straight_side_straight() -> None:
    points = np.array([(0, 0), (1, 0), (2, 0), (2.1, 0), (3, 0), (4, 0), (4, 3), (0, 3)], dtype=float)
    outline = Outline(points, np.arange(8), np.array([0, 0, 0, 0, 0, 1, 2, 3]), np.array([0, 8]))
    edited = collapse_short_edges(outline, np.full(8, 0.5), np.zeros(8, dtype=bool))
    assert len(edited.points) == 7
    assert np.allclose(edited.points[2], (2.05, 0.0), atol=1e-15)


def test_a_particle_on_a_straight_line_is_collapsed_onto_its_corner() -> None:
    points = np.array(
        [(0.0, 0.0), (2.0, 0.0), (3.9, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 4.0), (0.0, 4.0), (0.0, 2.0)]
    )
    parts = np.array([0, 0, 0, 1, 2, 2, 3, 3])
    mirrored = (points * [-1.0, 1.0])[::-1], np.arange(8)[::-1], np.roll(parts[::-1], -1)
    for at, particles, on in ((points, np.arange(8), parts), mirrored):
        outline = Outline(at, particles, on, np.array([0, 8]))
        edited = collapse_short_edges(outline, np.full(8, 0.5), np.zeros(8, dtype=bool))
        assert sorted(edited.particles) == [0, 1, 3, 4, 5, 6, 7]
        assert edited.area == pytest.approx(16.0)


def on_chord(a: Array, b: Array) -> Array:
    return 0.5 * (a + b)


def off_chord(height: float) -> Callable[[Array, Array], Array]:
    """Bulging outwards (or, negative, inwards) by ``height`` times the edge's length."""

    def place(a: Array, b: Array) -> Array:
        along = b - a
        return 0.5 * (a + b) + height * np.column_stack([along[:, 1], -along[:, 0]])

    return place


@given(outlines, seeds, st.floats(0.5, 2.0), st.floats(-0.1, 0.1))
def test_split_conserves_the_area_also_off_the_chord(outline, seed, factor, height) -> None:
    rng = np.random.default_rng(seed)
    count = len(outline.points)
    free = rng.random(count) < 0.8
    if free.sum() < 12:
        free[:] = True
    longest = factor * edge_lengths(outline).mean() * np.ones(count)
    edited = split_long_edges(outline, longest, off_chord(height), free)

    assert edited.area == pytest.approx(outline.area, rel=1e-12)
    old = edited.particles >= 0
    assert np.array_equal(edited.particles[old], np.arange(count))  # none lost, in order
    assert np.array_equal(edited.points[old][~free], outline.points[~free])  # only free ones shift
    assert part_runs(edited) == part_runs(outline)
    split = np.flatnonzero(edge_lengths(outline) > longest)
    assert (~old).sum() == len(split)
    # The new particle lies where it was put, in the part of the edge that it split.
    ends = outline.points[outline.topology.following]
    assert np.array_equal(edited.points[~old], off_chord(height)(outline.points[split], ends[split]))
    assert np.array_equal(edited.parts[~old], outline.parts[split])


@given(outlines, st.floats(0.5, 2.0))
def test_split_on_the_chord_moves_nothing(outline, factor) -> None:
    """Shifts of the old particles stay near round-off (1e-12): middles enclose no area."""
    longest = np.full(len(outline.points), factor * edge_lengths(outline).mean())
    edited = split_long_edges(outline, longest, on_chord, np.ones(len(outline.points), dtype=bool))
    assert np.allclose(edited.points[edited.particles >= 0], outline.points, rtol=0.0, atol=1e-12)
    assert edited.area == pytest.approx(outline.area, rel=1e-13)


@example(30, 0.0625, 0.0)
@given(st.integers(30, 60), st.floats(0.01, 0.1), st.floats(-1.0, 1.0))
def test_opposite_insertions_move_the_boundary_no_more_than_their_sagitta(count, height, imbalance) -> None:
    """One bulges out and one in, so that their areas cancel to second order: no shift may grow out of that."""
    outline = circle(count)
    longest = np.full(count, np.inf)
    longest[[5, 20]] = 0.0
    inward = height * (1.0 + imbalance * height)

    def place(a: Array, b: Array) -> Array:
        return np.vstack([off_chord(height)(a[:1], b[:1]), off_chord(-inward)(a[1:], b[1:])])

    edited = split_long_edges(outline, longest, place, np.ones(count, dtype=bool))
    shift = np.hypot(*(edited.points[edited.particles >= 0] - outline.points).T)
    assert shift.max() <= inward * edge_lengths(outline).max()
    assert edited.area == pytest.approx(outline.area, rel=1e-12)


def test_area_of_an_insertion_is_returned_nearby_and_gently() -> None:
    """On a circle of 100, one insertion moves only the 12 nearest free particles, by less than the sagitta."""
    outline = circle(100)
    longest = np.full(100, np.inf)
    longest[50] = 0.0
    edited = split_long_edges(outline, longest, off_chord(0.05), np.ones(100, dtype=bool))
    shift = np.hypot(*(edited.points[edited.particles >= 0] - outline.points).T)
    assert set(np.flatnonzero(shift)) <= set(range(45, 57))
    assert 0.0 < shift.max() < 0.05 * edge_lengths(outline)[50]


def test_loops_are_cyclic() -> None:
    loops = Boundary(np.array([4, 5, 6, 0, 1, 2]), np.zeros(6, dtype=np.int64), np.array([0, 3, 6]))
    assert loops.edges.tolist() == [[4, 5], [5, 6], [6, 4], [0, 1], [1, 2], [2, 0]]
    assert np.array_equal(loops.preceding[loops.following], np.arange(6))
    assert [loop.tolist() for loop in loops.loops] == [[4, 5, 6], [0, 1, 2]]
