"""The assembled heat equation of one step behind plain arrays."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from pfemcut.fem import runtime
from pfemcut.fem.element_kernels import Packing, add_matrix, corner_coordinates
from pfemcut.fem.partition import Partition
from pfemcut.fem.sparsity import Sparsity
from pfemcut.pfem.heat import HeatSymbols, heat_forms

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_TOLERANCE = 1e-11


class HeatSolveFailed(Exception):
    """The linear solver of the heat equation did not converge."""


class HeatKernels:
    """The form of the heat equation, compiled once a run."""

    def __init__(self, comm: MPI.Comm):
        domain = runtime.coordinate_domain()
        symbols = HeatSymbols.on(domain)
        form = runtime.CompiledForm(comm, heat_forms(domain, symbols))
        self.matrix = Packing({symbols.conductivity: 1}).kernel(form)


def solve_temperature_increment(
    kernels: HeatKernels,
    partition: Partition,
    points: Array,
    temperature: Array,
    lumped_capacity: Array,
    conductivity: Array,
    heat: Array,
    exchange: Array,
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
    sparsity = Sparsity.of(partition)
    pointers, columns = sparsity.scalar_rows(1)
    values = np.zeros(len(columns))
    add_matrix(
        kernels.matrix.address,
        kernels.matrix.columns,
        conductivity[partition.elements][:, None],
        np.empty(0),
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
    solver = PETSc.KSP().create(matrix.getComm())
    solver.setType(PETSc.KSP.Type.CG)
    solver.getPC().setType(PETSc.PC.Type.JACOBI)
    solver.setTolerances(rtol=_TOLERANCE, max_it=2000)
    solver.setOperators(matrix)
    solver.solve(right, solution)
    reason = solver.getConvergedReason()
    increment = partition.gather(solution.array_r.copy(), 1)[:, 0]
    for owned_object in (solver, right, solution, matrix):
        owned_object.destroy()
    if reason <= 0 or not np.all(np.isfinite(increment)):
        raise HeatSolveFailed(f"the heat equation was not solved (PETSc's reason {reason})")
    return increment
