"""The assembled heat equation of one step behind plain arrays."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from pfemcut.contact.heat import HeatCoupling
from pfemcut.fem import runtime
from pfemcut.fem.element_kernels import Packing, add_matrix, corner_coordinates
from pfemcut.fem.partition import Partition
from pfemcut.pfem.heat import HeatSymbols, heat_forms

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

_TOLERANCE = 1e-11


class HeatSolveFailed(Exception):
    """The linear solver of the heat equation did not converge."""


class _ExchangeShell:
    """PETSc's view of a sparse matrix plus a small dense one between a few particles."""

    def __init__(self, matrix: PETSc.Mat, dense: Array, places: IntArray, rows: IntArray) -> None:
        self._matrix = matrix
        self._dense = dense
        self._places = places  # of the owned particles among those of the dense matrix
        self._rows = rows  # their owned rows

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """y = (matrix + dense) x."""
        self._matrix.mult(x, y)
        values = np.zeros(len(self._dense))
        values[self._places] = x.array_r[self._rows]
        values = self._matrix.getComm().tompi4py().allreduce(values)
        y.array[self._rows] += (self._dense @ values)[self._places]

    def getDiagonal(self, _: PETSc.Mat, diagonal: PETSc.Vec) -> None:  # noqa: N802 - the name that PETSc calls
        """The diagonal, for the preconditioner."""
        self._matrix.getDiagonal(diagonal)
        diagonal.array[self._rows] += np.diag(self._dense)[self._places]


def _with_exchange(matrix: PETSc.Mat, owned: IntArray, interface: HeatCoupling) -> PETSc.Mat:
    row = np.full(int(max(owned.max(initial=0), interface.particles.max())) + 1, -1)
    row[owned] = np.arange(len(owned))
    rows = row[interface.particles]
    here = np.flatnonzero(rows >= 0)
    context = _ExchangeShell(matrix, interface.matrix, here, rows[here])
    shell = PETSc.Mat().createPython(matrix.getSizes(), context, comm=matrix.getComm())
    shell.setUp()
    return shell


class HeatKernels:
    """The form of the heat equation, compiled once a run."""

    def __init__(self, comm: MPI.Comm):
        domain = runtime.coordinate_domain()
        symbols = HeatSymbols.on(domain)
        form = runtime.CompiledForm(comm, heat_forms(domain, symbols))
        self.matrix = Packing({symbols.conductivity: 1}).kernel([form])


def solve_temperature_increment(
    kernels: HeatKernels,
    partition: Partition,
    points: Array,
    temperature: Array,
    lumped_capacity: Array,
    conductivity: Array,
    heat: Array,
    exchange: Array,
    interface: HeatCoupling,
    fixed: BoolArray,
    fixed_increment: Array,
) -> Array:
    """Temperature increment of one backward-Euler step.

    Parameters
    ----------
    partition
        Shares of the ranks.
    points
        The updated configuration x_{n+1} (mm); shape (n, 2).
    temperature
        Temperature at the start of the step (K); shape (n,).
    lumped_capacity
        Heat capacity of the particles over the step, the integral of rho_0 c / (J dt) (mW/(mm K)); shape (n,).
    conductivity
        Conductivity (N/(s K)); shape (m,).
    heat
        Heating power on particles per mm of width (mW/mm); shape (n,).
    exchange
        Heat given off per kelvin of the particle's temperature (mW/(mm K)), whose part at the start of the step is in
        ``heat`` already; shape (n,).
    interface
        Exchange between particles, none of them ``fixed``; like ``exchange``, its part at the start of the step is in
        ``heat`` already.
    fixed, fixed_increment
        Particles with prescribed temperature, and their increment; shape (n,).

    Returns
    -------
    increment
        Shape (n,).

    Raises
    ------
    HeatSolveFailed
        If the solver does not converge.
    """
    sparsity = partition.sparsity
    pointers, columns = sparsity.scalar_rows(1)
    values = np.zeros(len(columns))
    add_matrix(
        kernels.matrix.addresses,
        kernels.matrix.columns,
        conductivity[partition.elements][:, None],
        kernels.matrix.constants({}),
        corner_coordinates(points, partition.corners),
        partition.cells,
        1,
        False,
        sparsity.first,
        sparsity.starts,
        sparsity.places,
        values,
    )
    own = partition.particles[partition.first : partition.last]
    size = (len(own), partition.count)
    matrix = PETSc.Mat().createAIJ((size, size), csr=(pointers, columns, values), comm=partition.comm)
    # In increments, so that the solver's tolerance is one of the change and not of some 300 K.
    right, solution = matrix.createVecs()
    solution.array[:] = temperature[own]
    matrix.mult(solution, right)
    right.array[:] = heat[own] - right.array_r
    diagonal = matrix.getDiagonal()
    diagonal.array[:] += (lumped_capacity + exchange)[own]
    matrix.setDiagonal(diagonal)
    diagonal.destroy()
    rows = (partition.first + np.flatnonzero(fixed[own])).astype(np.int32)
    solution.array[:] = fixed_increment[own]
    matrix.zeroRowsColumns(rows, 1.0, solution, right)
    shell = _with_exchange(matrix, own, interface) if len(interface.particles) else matrix
    solver = PETSc.KSP().create(matrix.getComm())
    solver.setType(PETSc.KSP.Type.CG)
    solver.getPC().setType(PETSc.PC.Type.JACOBI)
    solver.setTolerances(rtol=_TOLERANCE, max_it=2000)
    solver.setOperators(shell)
    solver.solve(right, solution)
    reason = solver.getConvergedReason()
    increment = partition.gather(solution.array_r.copy(), 1)[:, 0]
    for owned_object in (solver, right, solution, matrix, shell):
        owned_object.destroy()
    if reason <= 0 or not np.all(np.isfinite(increment)):
        raise HeatSolveFailed(f"the heat equation was not solved (PETSc's reason {reason})")
    return increment
