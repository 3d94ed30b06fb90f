"""Remesh: from an old mesh, whose particles have moved, to a new one and the map between them (paper, Box 1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.boundary import Outline, PlaceBoundary, collapse_short_edges, split_long_edges
from meshing.interior import crowded_particles, refinement_points
from meshing.locate import locate
from meshing.mesh import Boundary, Mesh
from meshing.notches import close_notches
from meshing.sizes import SpacingField
from meshing.triangulation import constrained_delaunay

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class SpacingRules:
    """How far particles may be apart and how close, relative to the local spacing h.

    See :class:`pfemcut.problem.ParticleControls` for the meaning of each.
    """

    boundary_split: float
    boundary_removal: float
    interior_radius: float
    interior_area: float
    interior_spacing: float
    interior_removal: float
    power_smallest: float
    insert: bool
    remove: bool


@dataclass(frozen=True)
class SpacingFactors:
    """How far the spacing may exceed the wished one, relative to it; 1 where it may not.

    Attributes
    ----------
    removal
        Particles are removed up to this times the wished spacing; shape (n,).
    insertion
        None are inserted up to this times the wished spacing, which is no less; shape (n,).
    """

    removal: Array
    insertion: Array

    @staticmethod
    def none(count: int) -> SpacingFactors:
        """The wished spacing everywhere."""
        return SpacingFactors(np.ones(count), np.ones(count))


@dataclass(frozen=True)
class RemeshMap:
    """Where everything in a new mesh comes from.

    Attributes
    ----------
    kept
        Old index of each particle that stayed, in the order of the new mesh, whose first particles they are;
        shape (k,).
    inserted_cells, inserted_barycentric
        For each inserted particle the old element that contains it and its coordinates there;
        shapes (i,) and (i, 3).
    cells
        For each new element the old element that contains its Gauss point; shape (m,).
    unchanged
        Whether the element joins the same particles as the old one; shape (m,).
    removed
        Number of particles removed.
    outside
        Number of Gauss points that no old element contains; they take the nearest.
    area_before, area_after
        Area (mm²) enclosed by the boundary before and after its edits.
    """

    kept: IntArray
    inserted_cells: IntArray
    inserted_barycentric: Array
    cells: IntArray
    unchanged: BoolArray
    removed: int
    outside: int
    area_before: float
    area_after: float

    def vanished(self, count: int) -> IntArray:
        """The old elements, of which there are ``count``, that no new one repeats."""
        gone = np.ones(count, dtype=bool)
        gone[self.cells[self.unchanged]] = False
        return np.flatnonzero(gone)


def remesh(
    mesh: Mesh,
    sizes: SpacingField,
    rules: SpacingRules,
    *,
    refine_score: Array,
    removal_scale: Array,
    coarsening: SpacingFactors,
    locked: BoolArray,
    free: BoolArray,
    place_boundary: PlaceBoundary,
) -> tuple[Mesh, RemeshMap]:
    """Remove and insert particles, triangulate, and say where everything came from.

    A pure function: equal input bits give an equal mesh.

    Parameters
    ----------
    mesh
        The old mesh with its particles at their new positions.
    sizes
        Wished spacing h(x).
    rules
        Limits relative to h.
    refine_score
        Plastic power of each element over its tolerance; shape (m,).
    removal_scale
        Factor on the removal distance of each particle, small where refinement must last; shape (n,).
    coarsening
        Factors on the wished spacing, large where the solution needs few particles; on the boundary they hold for
        ``free`` particles.
    locked
        Boundary particles that must stay; shape (n,).
    free
        Boundary particles that may shift slightly to keep the area; shape (n,).
    place_boundary
        Vectorised: ends (k, 2), (k, 2) of boundary edges to the positions (k, 2) of their new particles.

    Raises
    ------
    BoundaryCrossing
        If the body overlaps itself.
    """
    outline_before = _outline(mesh)
    outline, stays = _edit_boundary(
        mesh, sizes, rules, outline_before, coarsening, locked, free, place_boundary
    )
    if rules.remove:
        spacing = sizes(mesh.points)
        stays &= ~crowded_particles(
            mesh.points,
            mesh.cells,
            _on_boundary(mesh),
            rules.interior_removal * removal_scale * coarsening.removal * spacing,
        )

    points, kept, boundary = _assemble(mesh, outline, stays)
    cells = constrained_delaunay(points, boundary.edges)
    if rules.insert:
        unchanged, old_cells = _match_cells(mesh, cells, kept)
        new = refinement_points(
            points,
            cells,
            sizes(points[cells].mean(axis=1)) * _cell_factors(cells, coarsening.insertion[kept], len(points)),
            radius_ratio=rules.interior_radius,
            area_ratio=rules.interior_area,
            clearance_ratio=rules.interior_spacing,
            power_score=np.where(unchanged, refine_score[old_cells], 0.0),
            power_smallest=rules.power_smallest,
        )
        if len(new):
            points = np.vstack([points, new])
            cells = constrained_delaunay(points, boundary.edges)
    points, cells, boundary, kept = _drop_unused(points, cells, boundary, kept)

    inserted = len(points) - len(kept)
    ids = np.concatenate([mesh.ids[kept], mesh.next_id + np.arange(inserted)])
    new_mesh = Mesh(points, cells, boundary, ids, mesh.next_id + inserted)
    return new_mesh, _map(mesh, new_mesh, kept, outline_before.area, outline.area)


def _outline(mesh: Mesh) -> Outline:
    loops = mesh.boundary
    return Outline(mesh.points[loops.particles], loops.particles, loops.parts, loops.starts)


def _on_boundary(mesh: Mesh) -> BoolArray:
    flags = np.zeros(len(mesh.points), dtype=bool)
    flags[mesh.boundary.particles] = True
    return flags


def _edit_boundary(
    mesh: Mesh,
    sizes: SpacingField,
    rules: SpacingRules,
    outline: Outline,
    coarsening: SpacingFactors,
    locked: BoolArray,
    free: BoolArray,
    place_boundary: PlaceBoundary,
) -> tuple[Outline, BoolArray]:
    """The edited boundary, and which old particles are still wanted (n,)."""
    stays = np.ones(len(mesh.points), dtype=bool)
    if rules.remove:
        before = outline.particles
        outline = close_notches(outline, rules.boundary_removal * sizes(outline.points), locked[before])
        inside = outline.particles >= 0
        held = np.where(inside, locked[outline.particles], False)
        factor = _removal_factors(outline, coarsening, free)
        outline = collapse_short_edges(outline, rules.boundary_removal * factor * sizes(outline.points), held)
        stays[before] = False
        stays[outline.particles[outline.particles >= 0]] = True
    if rules.insert:
        middle = 0.5 * (outline.points + outline.points[outline.topology.following])
        may_shift = (outline.particles >= 0) & free[outline.particles]
        at_entries = _entry_factors(outline, np.where(free, coarsening.insertion, 1.0))
        factor = np.minimum(at_entries, at_entries[outline.topology.following])
        outline = split_long_edges(
            outline, rules.boundary_split * factor * sizes(middle), place_boundary, may_shift
        )
    return outline, stays


def _entry_factors(outline: Outline, factors: Array) -> Array:
    """The ``factors`` (n,) of the boundary's entries; a new one has the larger of its neighbours'; shape (b,)."""
    loops = outline.topology
    known = outline.particles >= 0
    at_entries = np.where(known, factors[outline.particles], 1.0)
    neighbours = np.maximum(at_entries[loops.preceding], at_entries[loops.following])
    return np.where(known, at_entries, neighbours)


def _removal_factors(outline: Outline, coarsening: SpacingFactors, free: BoolArray) -> Array:
    """Factor on the length below which each edge is collapsed; shape (b,).

    A collapse lengthens the edges beside it, so no more than what these may have without being split.
    """
    loops = outline.topology
    following = loops.following
    removal = _entry_factors(outline, np.where(free, coarsening.removal, 1.0))
    insertion = _entry_factors(outline, np.where(free, coarsening.insertion, 1.0))
    ends = np.minimum(removal, removal[following])
    beside = np.minimum(insertion[loops.preceding], insertion[following[following]])
    return np.minimum(ends, beside)


def _cell_factors(cells: IntArray, factors: Array, count: int) -> Array:
    """Mean of the ``factors`` (k,) over the particles of each cell that have one: the first of ``count``; (m,)."""
    known = np.zeros(count, dtype=bool)
    known[: len(factors)] = True
    values = np.zeros(count)
    values[: len(factors)] = factors
    owners = known[cells].sum(axis=1)
    return np.where(owners > 0, values[cells].sum(axis=1) / np.maximum(owners, 1), 1.0)


def _assemble(mesh: Mesh, outline: Outline, stays: BoolArray) -> tuple[Array, IntArray, Boundary]:
    """Points (old ones that stay, then new boundary ones), old indices of the former, and the boundary."""
    kept = np.flatnonzero(stays)
    new_entries = np.flatnonzero(outline.particles < 0)
    points = np.vstack([mesh.points[kept], outline.points[new_entries]])
    number = np.full(len(mesh.points), -1)
    number[kept] = np.arange(len(kept))
    particles = np.empty(len(outline.particles), dtype=np.int64)
    old_entries = outline.particles >= 0
    particles[old_entries] = number[outline.particles[old_entries]]
    particles[new_entries] = len(kept) + np.arange(len(new_entries))
    points[particles] = outline.points  # entries that shifted to keep the area
    return points, kept, Boundary(particles, outline.parts, outline.starts)


def _drop_unused(
    points: Array, cells: IntArray, boundary: Boundary, kept: IntArray
) -> tuple[Array, IntArray, Boundary, IntArray]:
    """Drop particles that lie in no triangle: an edit of the boundary left them outside."""
    used = np.zeros(len(points), dtype=bool)
    used[cells] = True
    if used.all():
        return points, cells, boundary, kept
    number = np.cumsum(used) - 1
    boundary = Boundary(number[boundary.particles], boundary.parts, boundary.starts)
    return points[used], number[cells], boundary, kept[used[: len(kept)]]


def _match_cells(mesh: Mesh, cells: IntArray, kept: IntArray) -> tuple[BoolArray, IntArray]:
    """Which of the new ``cells`` join the same particles as an old element, and that element (0 elsewhere)."""
    count = len(mesh.points)
    old_index = np.concatenate([kept, np.full(max(0, int(cells.max()) + 1 - len(kept)), count)])
    old_keys = _cell_keys(mesh.cells, count + 1)
    new_keys = _cell_keys(old_index[cells], count + 1)
    order = np.argsort(old_keys)
    place = np.minimum(np.searchsorted(old_keys[order], new_keys), len(order) - 1)
    candidate = order[place]
    unchanged = old_keys[candidate] == new_keys
    return unchanged, np.where(unchanged, candidate, 0)


def _cell_keys(cells: IntArray, base: int) -> IntArray:
    """One integer for each set of three particles; fits 64 bits up to two million particles."""
    low, middle, high = np.sort(cells, axis=1).T
    return (low * base + middle) * base + high


def _map(mesh: Mesh, new: Mesh, kept: IntArray, area_before: float, area_after: float) -> RemeshMap:
    unchanged, cells = _match_cells(mesh, new.cells, kept)
    vanished = np.ones(len(mesh.cells), dtype=bool)
    vanished[cells[unchanged]] = False
    vanished_cells = np.flatnonzero(vanished)
    changed = np.flatnonzero(~unchanged)
    outside = 0
    if len(changed):
        candidates = vanished_cells if len(vanished_cells) else np.arange(len(mesh.cells))
        gauss_points = new.points[new.cells[changed]].mean(axis=1)
        found = locate(mesh.points, mesh.cells[candidates], gauss_points)
        cells[changed] = candidates[found.cells]
        outside = int(found.outside.sum())
    inserted = locate(mesh.points, mesh.cells, new.points[len(kept) :])
    return RemeshMap(
        kept=kept,
        inserted_cells=inserted.cells,
        inserted_barycentric=inserted.barycentric,
        cells=cells,
        unchanged=unchanged,
        removed=len(mesh.points) - len(kept),
        outside=outside,
        area_before=area_before,
        area_after=area_after,
    )
