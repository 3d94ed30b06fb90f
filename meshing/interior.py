"""Particles inside the body: which go because they crowd, where new ones come (paper, section 2.1, Figs. 2 and 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshing.mesh import circumradii, signed_areas, unique_edges

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_LOWEST_HEIGHT = 0.5  # of the removal distance: an interior particle closer to a boundary edge goes


def crowded_particles(points: Array, cells: IntArray, on_boundary: BoolArray, distance: Array) -> BoolArray:
    """Interior particles to remove because another one, or the boundary, is closer than ``distance`` (n,).

    Crowding particles are joined by an edge of the (nearly Delaunay) old mesh. Of a crowded pair the interior
    particle goes, the younger one if both are interior; of several pairs that share particles only the closest.
    """
    edges = unique_edges(cells)
    i, j = edges[:, 0], edges[:, 1]
    with np.errstate(divide="ignore"):  # a zero distance keeps a particle: it is never crowded
        ratio = np.hypot(*(points[j] - points[i]).T) / np.minimum(distance[i], distance[j])
    close = (ratio < 1.0) & ~(on_boundary[i] & on_boundary[j])
    i, j, ratio = i[close], j[close], ratio[close]
    closest = np.full(len(points), np.inf)
    np.minimum.at(closest, i, ratio)
    np.minimum.at(closest, j, ratio)
    chosen = (ratio == closest[i]) & (ratio == closest[j])
    victims = np.where(on_boundary[j], i, j)[chosen]
    removed = np.zeros(len(points), dtype=bool)
    removed[victims] = True
    removed[_squeezed_particles(points, cells, on_boundary, distance)] = True
    return removed


def _squeezed_particles(points: Array, cells: IntArray, on_boundary: BoolArray, distance: Array) -> IntArray:
    """Interior particles that nearly touch an opposite edge between two boundary particles."""
    flags = on_boundary[cells]
    facing = np.flatnonzero(flags.sum(axis=1) == 2)
    apex_slot = np.argmin(flags[facing], axis=1)
    row = np.arange(len(facing))
    triangles = cells[facing]
    apex = triangles[row, apex_slot]
    base = points[triangles[row, (apex_slot + 2) % 3]] - points[triangles[row, (apex_slot + 1) % 3]]
    height = 2.0 * signed_areas(points, triangles) / np.hypot(*base.T)
    return apex[height < _LOWEST_HEIGHT * distance[apex]]


def refinement_points(
    points: Array,
    cells: IntArray,
    spacing: Array,
    *,
    radius_ratio: float,
    area_ratio: float,
    clearance_ratio: float,
    power_score: Array,
    power_smallest: float,
) -> Array:
    """Centroids of elements that are too large for ``spacing`` or dissipate too much plastic power (eq. 1).

    Parameters
    ----------
    spacing
        Wished spacing h at the element centroids (mm); shape (m,).
    radius_ratio, area_ratio
        An element is too large if its circumradius exceeds ``radius_ratio`` h or its area ``area_ratio`` h².
    clearance_ratio
        A new particle keeps this times h from all others, and new ones from each other.
    power_score
        Plastic power over its tolerance; above one the element is refined; shape (m,).
    power_smallest
        The spacing that plastic power may ask for, as a fraction of h.

    Returns
    -------
    new
        Positions of the new particles (mm); shape (k, 2).
    """
    area = signed_areas(points, cells)
    radius = circumradii(points, cells)
    too_large = (radius > radius_ratio * spacing) | (area > area_ratio * spacing**2)
    hot_spacing = power_smallest * spacing
    hot = (power_score > 1.0) & (radius > radius_ratio * hot_spacing)
    chosen = np.flatnonzero(too_large | hot)
    if len(chosen) == 0:
        return np.empty((0, 2))
    corners = points[cells[chosen]]
    centroids = corners.mean(axis=1)
    clearance = clearance_ratio * np.where(too_large, spacing, hot_spacing)[chosen]
    # Large flat elements beside the boundary have their vertices far away but an edge near: check the heights too.
    nearest = np.hypot(*(corners - centroids[:, None, :]).transpose(2, 0, 1)).min(axis=1)
    longest = np.hypot(*(corners - np.roll(corners, 1, axis=1)).transpose(2, 0, 1)).max(axis=1)
    height = 2.0 * area[chosen] / longest / 3.0
    allowed = (nearest > clearance) & (height > 0.3 * clearance)
    centroids, clearance, excess = centroids[allowed], clearance[allowed], (radius / spacing)[chosen][allowed]
    return centroids[_mutually_distant(centroids, clearance, excess)]


def _mutually_distant(points: Array, clearance: Array, priority: Array) -> BoolArray:
    """A subset in which no two points are closer than their clearance; where two clash, the higher priority stays."""
    keep = np.ones(len(points), dtype=bool)
    if len(points) < 2:
        return keep
    pairs = cKDTree(points).query_pairs(float(clearance.max()), output_type="ndarray")
    gap = np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T)
    pairs = pairs[gap < np.maximum(clearance[pairs[:, 0]], clearance[pairs[:, 1]])]
    order = np.lexsort((np.arange(len(points)), -priority))
    rank = np.empty(len(points), dtype=np.int64)
    rank[order] = np.arange(len(points))
    loser = np.where(rank[pairs[:, 0]] > rank[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    keep[loser] = False
    return keep
