"""A mesh distributed over the ranks for one step, and how its nodes and cells map to particles and elements.

Particles and elements are replicated on every rank (they are small); dolfinx distributes cells, and nodal
solutions are gathered once a solve.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from mpi4py import MPI
from numpy.typing import NDArray

from pfemcut.fem import runtime

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class DistributedMesh:
    """The dolfinx mesh of one step.

    Attributes
    ----------
    comm
        Communicator.
    cpp
        The C++ mesh.
    elements
        Global element of each local cell; shape (local cells,).
    """

    def __init__(self, comm: MPI.Comm, points: Array, cells: IntArray, domain: ufl.Mesh):
        self.comm = comm
        self.cpp = runtime.new_mesh(comm, points, cells, domain)
        geometry = self.cpp.geometry
        self.elements = np.asarray(self.cpp.topology.original_cell_index, dtype=np.int64)
        self._node_particles = np.asarray(geometry.input_global_indices, dtype=np.int64)
        self._cell_nodes = np.asarray(geometry.dofmap.array).reshape(-1, 3)

    def move(self, points: Array) -> None:
        """Put the nodes at ``points`` (n, 2), all particles' new positions."""
        self.cpp.geometry.x[:, :2] = points[self._node_particles]

    @property
    def cell_particles(self) -> IntArray:
        """Particles of each local cell, in the cell's node order; shape (local cells, 3)."""
        return self._node_particles[self._cell_nodes]


class NodalSpace:
    """Linear fields with ``components`` values a particle.

    Attributes
    ----------
    cpp
        The C++ function space.
    particles
        Particle of each local node (owned, then ghosts); shape (local,).
    owned
        Number of owned nodes.
    """

    def __init__(self, mesh: DistributedMesh, element: runtime.CompiledElement, components: int):
        self.cpp = element.space(mesh.cpp)
        self.components = components
        self._comm = mesh.comm
        index_map = self.cpp.dofmap.index_map
        self.owned = int(index_map.size_local)
        self.particles = np.empty(self.owned + int(index_map.num_ghosts), dtype=np.int64)
        cell_nodes = np.asarray(self.cpp.dofmap.list().array).reshape(-1, 3)
        self.particles[cell_nodes] = mesh.cell_particles

    def function(self, values: Array) -> Any:
        """A function with the particles' ``values`` (n,) or (n, components)."""
        function = runtime.new_function(self.cpp)
        self.load(function, values)
        return function

    def load(self, function: Any, values: Array) -> None:
        """Set ``function`` to the particles' ``values``."""
        function.x.array[:] = values[self.particles].ravel()

    def global_nodes(self, count: int) -> IntArray:
        """Global node number of each of the ``count`` particles, on every rank; shape (count,)."""
        node = np.empty(count, dtype=np.int64)
        first = 0
        for particles in self._comm.allgather(self.particles[: self.owned]):
            node[particles] = first + np.arange(len(particles))
            first += len(particles)
        return node

    def gather(self, owned_values: Array, count: int) -> Array:
        """All ``count`` particles' values on every rank from each rank's ``owned_values`` (owned * components,)."""
        values = np.empty((count, self.components))
        mine = owned_values.reshape(self.owned, self.components)
        if self._comm.size == 1:
            values[self.particles[: self.owned]] = mine
            return values
        for particles, part in self._comm.allgather((self.particles[: self.owned], mine)):
            values[particles] = part
        return values


class CellSpace:
    """Element-wise constant fields with ``components`` values an element."""

    def __init__(self, mesh: DistributedMesh, element: runtime.CompiledElement):
        self.cpp = element.space(mesh.cpp)
        dofs = np.asarray(self.cpp.dofmap.list().array)
        self._elements = np.empty(len(dofs), dtype=np.int64)
        self._elements[dofs] = mesh.elements[: len(dofs)]

    def function(self, values: Array) -> Any:
        """A function with the elements' ``values`` (m,) or (m, components)."""
        function = runtime.new_function(self.cpp)
        self.load(function, values)
        return function

    def load(self, function: Any, values: Array) -> None:
        """Set ``function`` to the elements' ``values``."""
        function.x.array[:] = values[self._elements].ravel()
