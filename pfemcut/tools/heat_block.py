"""The block of a rigid tool that conducts heat: its mesh, and heat steps of it that need only a factorised matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix, diags
from scipy.sparse.linalg import SuperLU, splu

from meshing.initial import Arc, outline_mesh
from meshing.mesh import Mesh, signed_areas
from meshing.sizes import Capsule, SizeField, SizeZone
from pfemcut.problem import Conductor
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_TIP, _FLANK, _HOLDER, _RAKE = range(4)


def block_mesh(tool: RigidWedge, conductor: Conductor) -> Mesh:
    """Mesh of the block: tip arc, flank face, the holder's side, rake face; finest at the tip and up the rake face."""
    rake, flank = tool.rake_tangent_point, tool.flank_tangent_point
    reach = conductor.length
    corners = np.array(
        [rake, flank, flank + reach * tool.flank_direction, rake + reach * tool.rake_direction]
    )
    face = rake + conductor.fine_length * tool.rake_direction
    zone = Capsule((float(rake[0]), float(rake[1])), (float(face[0]), float(face[1])), tool.tip_radius)
    sizes = SizeField((SizeZone(zone, conductor.tip_size, conductor.growth),), reach / 4.0)
    return outline_mesh(corners, sizes, np.arange(4), (Arc(_TIP, tool.centre),))


@dataclass(frozen=True)
class _Factor:
    """Factorised matrix of a step, and the responses of the surface to power on it, computed as they are needed."""

    step: float
    solver: SuperLU
    response: Array
    known: BoolArray


class HeatBlock:
    """A tool's block in the tool's own frame, at time zero.

    Backward Euler with lumped capacity and constant properties, so that the matrix changes with the step length only.
    The holder's side keeps its temperature; all other sides are adiabatic but for what contact brings.

    Attributes
    ----------
    mesh
        The block with the tool at time zero.
    surface
        Particles on rake face, tip and flank face by falling arc length; shape (s,).
    arc_length
        Their arc length on the tool (mm); shape (s,).
    """

    def __init__(self, tool: RigidWedge, conductor: Conductor, mesh: Mesh) -> None:
        self.mesh = mesh
        points, cells, count = mesh.points, mesh.cells, len(mesh.points)
        areas = signed_areas(points, cells)
        capacity = np.bincount(cells.ravel(), np.repeat(areas / 3.0, 3), minlength=count)
        self._capacity: Array = conductor.density * conductor.capacity * capacity
        edge = np.roll(points[cells], -2, axis=1) - np.roll(points[cells], -1, axis=1)
        local = (
            np.einsum("max,mbx->mab", edge, edge) * (conductor.conductivity / (4.0 * areas))[:, None, None]
        )
        rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel()
        self._conduction = csr_matrix((local.ravel(), (rows, columns)), shape=(count, count))
        held = np.unique(mesh.boundary.edges[mesh.boundary.parts == _HOLDER])
        self._free: IntArray = np.setdiff1d(np.arange(count), held)
        faces = np.unique(mesh.boundary.edges[mesh.boundary.parts != _HOLDER])
        arc = tool.arc_length(points[faces])
        order = np.argsort(-arc, kind="stable")
        self.surface: IntArray = faces[order]
        self.arc_length: Array = arc[order]
        self._factors: list[_Factor] = []

    def content(self, temperature: Array, start: float) -> float:
        """Heat above the temperature ``start`` (K), mJ/mm."""
        return float(self._capacity @ (temperature - start))

    def places(self, arc_length: Array) -> csr_matrix:
        """Linear interpolation from the surface's particles to the points at ``arc_length`` (k,); shape (k, s).

        Rows sum to one, so that its transpose hands power on without loss. Points beyond the block take its end.
        """
        at = np.clip(arc_length, self.arc_length[-1], self.arc_length[0])
        following = np.clip(np.searchsorted(-self.arc_length, -at), 1, len(self.arc_length) - 1)
        start, end = self.arc_length[following - 1], self.arc_length[following]
        weight = (start - at) / (start - end)
        rows = np.repeat(np.arange(len(at)), 2)
        columns = np.column_stack([following - 1, following]).ravel()
        values = np.column_stack([1.0 - weight, weight]).ravel()
        return csr_matrix((values, (rows, columns)), shape=(len(at), len(self.arc_length)))

    def advanced(self, temperature: Array, surface_power: Array, step: float) -> tuple[Array, float]:
        """Temperature (n,) after ``step`` (s) of ``surface_power`` (s,) in mW/mm, and the power lost to the holder."""
        power = np.zeros_like(temperature)
        power[self.surface] = surface_power
        right = power - self._conduction @ temperature
        increment = np.zeros_like(temperature)
        increment[self._free] = self._factor(step).solver.solve(right[self._free])
        after = temperature + increment
        balance = power - self._conduction @ after - self._capacity * increment / step
        return after, float(balance.sum())

    def response(self, places: csr_matrix, step: float) -> Array:
        """Temperature at the points after ``step`` (s) by a unit of power at each of them; shape (k, k), mm K/mW."""
        factor = self._factor(step)
        wanted = np.unique(places.indices)
        new = wanted[~factor.known[wanted]]
        if len(new):
            number = np.full(len(self.mesh.points), -1)
            number[self._free] = np.arange(len(self._free))
            unit = np.zeros((len(self._free), len(new)))
            rows = number[self.surface[new]]
            free = rows >= 0
            unit[rows[free], np.flatnonzero(free)] = 1.0
            answers = np.zeros((len(self.mesh.points), len(new)))
            answers[self._free] = factor.solver.solve(unit)
            factor.response[:, new] = answers[self.surface]
            factor.known[new] = True
        return np.asarray(places @ (places @ factor.response.T).T)

    def _factor(self, step: float) -> _Factor:
        """The factorisation for ``step`` (s); the last one is kept."""
        if not self._factors or self._factors[-1].step != step:
            matrix = csc_matrix(diags(self._capacity / step) + self._conduction)
            free = matrix[self._free][:, self._free]
            count = len(self.surface)
            self._factors = [_Factor(step, splu(free), np.zeros((count, count)), np.zeros(count, dtype=bool))]
        return self._factors[-1]
