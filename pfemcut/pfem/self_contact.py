"""Contact of a body with itself in a time step: the search, and the spacing of particles beside it.

Every point of the boundary is held off the surface that it faces, with half the penalty, so that both sides are treated
alike; forces and moments of each pair of point and surface balance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshing.mesh import Mesh
from meshing.sizes import SpacingField
from pfemcut.contact.node_to_segment import ContactPoints
from pfemcut.contact.self_search import FacingPoints, facing_points
from pfemcut.pfem.body_contact import SurfaceInterface
from pfemcut.pfem.newton import StepFailed
from pfemcut.problem import Problem, SelfContact

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_REACH = 1.0  # thicknesses beyond the contact thickness within which a point is watched
_TOO_NEAR = 0.5  # of the contact thickness: a point so near to what it was not held off has been missed
_FACING = 3.0  # spacings within which surfaces face each other for the spacing of particles
_GROWTH = 0.3  # increase of the spacing per distance from there


@dataclass(frozen=True)
class SelfInterface(SurfaceInterface):
    """Contact of bodies with themselves in one step, and which points of the boundary it watches."""

    rule: SelfContact
    facing: FacingPoints


def self_contact_search(problem: Problem, mesh: Mesh, motion: Array) -> tuple[SelfInterface, ...]:
    """Where bodies may touch themselves in a step that is predicted to move the particles by ``motion`` (n, 2)."""
    return tuple(_search(rule, mesh, mesh.points, motion) for rule in problem.self_contact)


def _search(rule: SelfContact, mesh: Mesh, points: Array, motion: Array) -> SelfInterface:
    boundary = mesh.boundary
    found = facing_points(points, boundary, _bodies(mesh), motion, rule.thickness, _REACH * rule.thickness)
    contact_points = ContactPoints(
        particles=boundary.edges[found.edges],
        shares=np.column_stack([1.0 - found.place, found.place]),
        # Half from either side.
        lengths=0.5 * found.lengths,
        candidates=found.candidates,
        thickness=found.thickness(rule.thickness),
    )
    return SelfInterface(found.curve, contact_points, rule, found)


def require_apart(mesh: Mesh, interface: SelfInterface, positions: Array) -> None:
    """Fail if at the end of a step, with the particles at ``positions`` (n, 2), surfaces meet that were not watched.

    Raises
    ------
    StepFailed
        The step is too long for the search.
    """
    rule = interface.rule
    found = _search(rule, mesh, positions, np.zeros_like(positions)).facing
    near = found.distance < _TOO_NEAR * found.thickness(rule.thickness)
    if not np.isin(found.numbers[near], interface.facing.numbers).all():
        raise StepFailed("the body touches itself out of the reach of the contact search")


@dataclass(frozen=True)
class FacingSizes:
    """A size field that is at most ``spacing`` (mm) near the ``places`` (k, 2), growing from there."""

    sizes: SpacingField
    places: Array
    spacing: float

    def __call__(self, points: Array) -> Array:
        """Spacing (mm) at ``points`` (n, 2); shape (n,)."""
        distance, _ = self._tree.query(points)
        return np.minimum(self.sizes(points), self.spacing + _GROWTH * distance)

    @cached_property
    def _tree(self) -> cKDTree:
        """Search tree of the places."""
        return cKDTree(self.places)


def sizes_beside_contact(problem: Problem, mesh: Mesh, sizes: SpacingField) -> SpacingField:
    """``sizes``, refined where surfaces of a body face each other."""
    for rule in problem.self_contact:
        boundary = mesh.boundary
        still = np.zeros_like(mesh.points)
        reach = _FACING * rule.spacing
        found = facing_points(mesh.points, boundary, _bodies(mesh), still, rule.thickness, reach)
        if len(found.edges):
            sizes = FacingSizes(sizes, mesh.points[np.unique(boundary.edges[found.edges])], rule.spacing)
    return sizes


def _bodies(mesh: Mesh) -> IntArray:
    """Number of the body of each boundary entry; shape (b,)."""
    return np.searchsorted(mesh.first_particles, mesh.boundary.particles, side="right")
