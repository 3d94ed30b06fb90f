"""The assembled momentum equation of one step: residual, tangent and linear solve behind plain arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from pfemcut.fem import runtime
from pfemcut.fem.direct_solver import DirectSolver
from pfemcut.fem.element_kernels import (
    Packing,
    add_matrix,
    add_vector,
    corner_coordinates,
    pack_corners,
)
from pfemcut.fem.partition import Partition
from pfemcut.fem.sparsity import add_blocks, fix_unknowns
from pfemcut.pfem.momentum import ELEMENT_COMPONENTS, MomentumSymbols, momentum_forms
from pfemcut.timing import Stopwatch

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

COMPONENTS = 3  # unknowns of a particle: u_x, u_y, p


class MomentumKernels:
    """The forms of the momentum equation, compiled once a run."""

    def __init__(self, comm: MPI.Comm):
        domain = runtime.coordinate_domain()
        symbols = self.symbols = MomentumSymbols.on(domain)
        residual, jacobian = momentum_forms(domain, symbols)
        corners = 3
        self.packing = Packing(
            {
                symbols.unknown: corners * COMPONENTS,
                symbols.thermal_strain: corners,
                symbols.settled_pressure: corners,
                symbols.element: ELEMENT_COMPONENTS,
                symbols.moduli: 2,
            }
        )
        self.residual, self.jacobian = (
            self.packing.kernel([runtime.CompiledForm(comm, part) for part in parts])
            for parts in (residual, jacobian)
        )


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

    def symmetric_part(self) -> NodalForces:
        """The same forces with the symmetric part of their stiffness."""
        transposed = np.swapaxes(self.stiffness, 1, 2)
        return NodalForces(
            self.particles,
            self.forces,
            np.concatenate([self.rows, self.columns]),
            np.concatenate([self.columns, self.rows]),
            0.5 * np.concatenate([self.stiffness, transposed]),
        )

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
    """Residual and linear solves on one mesh; use as a context manager, it owns a PETSc solver.

    Parameters
    ----------
    kernels
        Compiled forms.
    partition
        Shares of the ranks.
    points
        The configuration x_n (mm); shape (n, 2).
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
    symmetric
        Whether to solve with the symmetric part of the tangent, which is cheaper. Without friction the tangent is
        symmetric but for a few per cent, and Newton's method converges as fast.
    watch
        Times set-up, assembly and linear solves.
    couplings
        Groups of particles that contact may couple though they share no element.
    """

    def __init__(
        self,
        kernels: MomentumKernels,
        partition: Partition,
        points: Array,
        fixed: BoolArray,
        moduli: Array,
        stabilisation: float,
        thermal_strain: Array,
        settled_pressure: Array,
        *,
        symmetric: bool,
        watch: Stopwatch,
        couplings: Sequence[IntArray] = (),
    ):
        self._watch = watch
        self._kernels = kernels
        self._partition = partition
        with watch.phase("system"):
            symbols, packing = kernels.symbols, kernels.packing
            values = {symbols.stabilisation: stabilisation}
            self._residual_constants = kernels.residual.constants(values)
            self._jacobian_constants = kernels.jacobian.constants(values)
            self._coordinates = corner_coordinates(points, partition.corners)
            self._data = np.empty((len(partition.elements), packing.width))
            for symbol, field in (
                (symbols.thermal_strain, thermal_strain),
                (symbols.settled_pressure, settled_pressure),
            ):
                self._pack(symbol, field[:, None])
            self._data[:, packing.columns(symbols.moduli)] = moduli[partition.elements]
            self._fixed = np.empty(fixed.shape, dtype=bool)
            self._fixed[partition.number] = fixed
            self._sparsity = partition.sparsity.coupled([partition.number[each] for each in couplings])
            self._pointers, self._columns = self._sparsity.scalar_rows(COMPONENTS)
            self._values = np.zeros(len(self._columns))
            self._symmetric = symmetric
            self._solver = DirectSolver(
                partition.comm,
                self._pointers,
                self._columns,
                self._values,
                block=COMPONENTS,
                symmetric=symmetric,
            )

    def __enter__(self) -> MomentumSystem:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._solver.destroy()

    def internal_residual(self, unknown: Array, element: Array) -> Array:
        """The form's residual at ``unknown`` (n, 3) with ``element`` data (m, components); shape (n, 3)."""
        partition = self._partition
        with self._watch.phase("assembly"):
            self._pack(self._kernels.symbols.unknown, unknown)
            self._data[:, self._kernels.packing.columns(self._kernels.symbols.element)] = element[
                partition.elements
            ]
            total = np.zeros(COMPONENTS * partition.count)
            kernel = self._kernels.residual
            add_vector(
                kernel.addresses,
                kernel.columns,
                self._data,
                self._residual_constants,
                self._coordinates,
                partition.cells,
                COMPONENTS,
                total,
            )
            own = total[COMPONENTS * partition.first : COMPONENTS * partition.last]
            return partition.gather(own, COMPONENTS)

    def solve(self, residual: Array, nodal: NodalForces) -> tuple[Array, bool]:
        """Newton correction -K^-1 ``residual`` (n, 3) at the point of the last residual; fixed unknowns get none.

        Returns
        -------
        correction
            Shape (n, 3).
        solved
            Whether the factorisation succeeded.
        """
        partition = self._partition
        with self._watch.phase("assembly"):
            self.assemble(nodal)
        with self._watch.phase("linear_solve"):
            right = np.empty((partition.count, COMPONENTS))
            right[partition.number] = -residual
            right[self._fixed] = 0.0
            own, solved = self._solver.solve(right[partition.first : partition.last].ravel())
            return partition.gather(own, COMPONENTS), solved

    def assemble(self, nodal: NodalForces) -> None:
        """Put the tangent at the point of the last residual, with the stiffness of ``nodal``, into the matrix."""
        partition, sparsity = self._partition, self._sparsity
        self._values[:] = 0.0
        kernel = self._kernels.jacobian
        add_matrix(
            kernel.addresses,
            kernel.columns,
            self._data,
            self._jacobian_constants,
            self._coordinates,
            partition.cells,
            COMPONENTS,
            self._symmetric,
            sparsity.first,
            sparsity.starts,
            sparsity.places,
            self._values,
        )
        if self._symmetric:
            nodal = nodal.symmetric_part()
        rows, columns = partition.number[nodal.rows], partition.number[nodal.columns]
        mine = (partition.first <= rows) & (rows < partition.last)
        rows, columns = rows[mine], columns[mine]
        blocks = sparsity.blocks(rows, columns)
        stiffness = nodal.stiffness[mine]
        add_blocks(sparsity.starts, self._values, COMPONENTS, blocks, rows - partition.first, stiffness)
        fix_unknowns(
            self._pointers, self._columns, self._values, self._fixed.ravel(), COMPONENTS * partition.first
        )

    def matrix(self) -> Any:
        """The PETSc matrix of the last :meth:`assemble`, which this object keeps."""
        return self._solver.update()

    def _pack(self, symbol: object, values: Array) -> None:
        column = self._kernels.packing.columns(symbol).start
        pack_corners(self._data, column, np.ascontiguousarray(values), self._partition.corners)
