"""The assembled momentum equation of one step: residual, tangent and linear solve behind plain arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from pfemcut.fem import runtime
from pfemcut.fem.couplings import add_blocks, coupled_matrix, pairs_within
from pfemcut.fem.direct_solver import DirectSolver
from pfemcut.fem.distribution import CellSpace, DistributedMesh, NodalSpace
from pfemcut.pfem.momentum import ELEMENT_COMPONENTS, MomentumSymbols, momentum_forms
from pfemcut.timing import Stopwatch

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


class MomentumKernels:
    """The forms and elements of the momentum equation, compiled once a run."""

    def __init__(self, comm: MPI.Comm):
        self.comm = comm
        self.domain = runtime.coordinate_domain()
        self.symbols = MomentumSymbols.on(self.domain)
        residual, jacobian = momentum_forms(self.domain, self.symbols)
        self.residual = tuple(runtime.CompiledForm(comm, part) for part in residual)
        self.jacobian = tuple(runtime.CompiledForm(comm, part) for part in jacobian)
        self.mixed = runtime.CompiledElement(comm, runtime.nodal_element(3))
        self.scalar = runtime.CompiledElement(comm, runtime.nodal_element(1))
        self.element = runtime.CompiledElement(comm, runtime.cell_element(ELEMENT_COMPONENTS))
        self.pair = runtime.CompiledElement(comm, runtime.cell_element(2))


@dataclass(frozen=True)
class NodalForces:
    """Forces on particles outside the weak form (contact, loads, inertia) and their derivative.

    Attributes
    ----------
    particles
        Where they act; shape (k,).
    forces
        Force on the body per mm of width (N/mm); shape (k, 2).
    rows, columns
        Particle pairs that the stiffness couples: edges of the mesh, a particle with itself, or couplings that the
        system was told of; shape (s,).
    stiffness
        Minus the derivative of the force on ``rows`` by the displacement of ``columns``; shape (s, 2, 2).
    """

    particles: IntArray
    forces: Array
    rows: IntArray
    columns: IntArray
    stiffness: Array

    @staticmethod
    def local(particles: IntArray, forces: Array, stiffness: Array) -> NodalForces:
        """Forces that depend on the displacement of their own particle only; ``stiffness`` is (k, 2, 2)."""
        return NodalForces(particles, forces, particles, particles, stiffness)

    @staticmethod
    def sum(parts: Sequence[NodalForces]) -> NodalForces:
        """All forces of ``parts`` together."""
        none = np.empty(0, dtype=np.int64)
        every = [NodalForces.local(none, np.empty((0, 2)), np.empty((0, 2, 2))), *parts]
        return NodalForces(
            np.concatenate([each.particles for each in every]),
            np.concatenate([each.forces for each in every]),
            np.concatenate([each.rows for each in every]),
            np.concatenate([each.columns for each in every]),
            np.concatenate([each.stiffness for each in every]),
        )


class MomentumSystem:
    """Residual and linear solves on one mesh; use as a context manager, it owns PETSc objects.

    Parameters
    ----------
    kernels
        Compiled forms.
    mesh
        The configuration x_n.
    fixed
        Unknowns (u_x, u_y, p) with prescribed increments; shape (n, 3).
    moduli
        Shear and bulk modulus of the elements (MPa); shape (m, 2).
    stabilisation
        Factor alpha_s of the pressure projection.
    thermal_strain
        3 alpha (theta - theta_0) on particles; shape (n,).
    settled_pressure
        What the stabilisation leaves out of the pressure (MPa); shape (n,).
    watch
        Times set-up, assembly and linear solves.
    couplings
        Groups of particles that contact may couple though they share no element.
    """

    def __init__(
        self,
        kernels: MomentumKernels,
        mesh: DistributedMesh,
        fixed: BoolArray,
        moduli: Array,
        stabilisation: float,
        thermal_strain: Array,
        settled_pressure: Array,
        watch: Stopwatch,
        couplings: Sequence[IntArray] = (),
    ):
        self._watch = watch
        with watch.phase("system"):
            self._set_up(
                kernels, mesh, fixed, moduli, stabilisation, thermal_strain, settled_pressure, couplings
            )

    def _set_up(
        self,
        kernels: MomentumKernels,
        mesh: DistributedMesh,
        fixed: BoolArray,
        moduli: Array,
        stabilisation: float,
        thermal_strain: Array,
        settled_pressure: Array,
        couplings: Sequence[IntArray],
    ) -> None:
        symbols = kernels.symbols
        self._count = len(fixed)
        self._mixed = NodalSpace(mesh, kernels.mixed, 3)
        self._global_nodes = self._mixed.global_nodes(self._count)
        self._cells = CellSpace(mesh, kernels.element)
        scalar = NodalSpace(mesh, kernels.scalar, 1)
        self._unknown = runtime.new_function(self._mixed.cpp)
        self._element = runtime.new_function(self._cells.cpp)
        functions = {
            symbols.unknown: self._unknown,
            symbols.element: self._element,
            symbols.thermal_strain: scalar.function(thermal_strain),
            symbols.settled_pressure: scalar.function(settled_pressure),
            symbols.moduli: CellSpace(mesh, kernels.pair).function(moduli),
        }
        constants = {symbols.stabilisation: runtime.new_constant(stabilisation)}
        space = self._mixed.cpp
        self._residual = tuple(
            part.bind(mesh.cpp, [space], functions, constants) for part in kernels.residual
        )
        self._jacobian = tuple(
            part.bind(mesh.cpp, [space, space], functions, constants) for part in kernels.jacobian
        )
        self._fixed_rows = np.flatnonzero(fixed[self._mixed.particles].ravel()).astype(np.int32)
        self._matrix = coupled_matrix(self._jacobian[0], self._mixed, couplings, self._count)
        self._coupled = pairs_within(couplings)
        self._matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self._right, self._solution = self._matrix.createVecs()
        self._solver = DirectSolver(self._matrix)

    def __enter__(self) -> MomentumSystem:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._solver.destroy()
        for owned in (self._right, self._solution, self._matrix):
            owned.destroy()

    def internal_residual(self, unknown: Array, element: Array) -> Array:
        """The form's residual at ``unknown`` (n, 3) with ``element`` data (m, components); shape (n, 3)."""
        with self._watch.phase("assembly"):
            self._mixed.load(self._unknown, unknown)
            self._cells.load(self._element, element)
            local = np.zeros(3 * len(self._mixed.particles))
            for part in self._residual:
                runtime.assemble_vector(local, part)
            return self._accumulate(local)

    def solve(self, residual: Array, nodal: NodalForces) -> tuple[Array, bool]:
        """Newton correction -K^-1 ``residual`` (n, 3) at the point of the last residual; fixed unknowns get none.

        Returns
        -------
        correction
            Shape (n, 3).
        solved
            Whether the factorisation succeeded.
        """
        with self._watch.phase("assembly"):
            matrix = self._matrix
            matrix.zeroEntries()
            for part in self._jacobian:
                runtime.assemble_matrix(matrix, part)
            self._add_nodal_stiffness(nodal)
            matrix.assemble()
            owned_rows = self._fixed_rows[self._fixed_rows < 3 * self._mixed.owned]
            matrix.zeroRowsColumnsLocal(owned_rows, 1.0)
        with self._watch.phase("linear_solve"):
            right = -residual[self._mixed.particles[: self._mixed.owned]].ravel()
            right[owned_rows] = 0.0
            self._right.array[:] = right
            solved = self._solver.solve(self._right, self._solution)
            return self._mixed.gather(self._solution.array_r, self._count), solved

    def _add_nodal_stiffness(self, nodal: NodalForces) -> None:
        if len(nodal.rows):
            add_blocks(self._matrix, self._global_nodes, 3, nodal.rows, nodal.columns, nodal.stiffness)
        if len(self._coupled[0]):
            # An entry that the first assembly does not set is lost to the later ones.
            rows, columns = self._coupled
            add_blocks(self._matrix, self._global_nodes, 3, rows, columns, np.zeros((len(rows), 2, 2)))
            self._coupled = pairs_within(())

    def _accumulate(self, local: Array) -> Array:
        """Sum of all ranks' local contributions, ghosts included, on every rank; shape (n, 3)."""
        total = np.zeros((self._count, 3))
        total[self._mixed.particles] = local.reshape(-1, 3)
        comm = self._matrix.getComm().tompi4py()
        if comm.size > 1:
            # Not Allreduce, whose result may differ in the last bit between ranks: every rank decides on these bits.
            summed = np.empty_like(total)
            comm.Reduce(total, summed, op=MPI.SUM, root=0)
            comm.Bcast(summed, root=0)
            return summed
        return total
