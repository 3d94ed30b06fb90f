"""The assembled heat equation of one step behind plain arrays."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from pfemcut.fem import runtime
from pfemcut.fem.distribution import CellSpace, DistributedMesh, NodalSpace
from pfemcut.pfem.heat import HeatSymbols, heat_forms

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_TOLERANCE = 1e-11


class HeatSolveFailed(Exception):
    """The linear solver of the heat equation did not converge."""


class HeatKernels:
    """The form and elements of the heat equation, compiled once a run."""

    def __init__(self, comm: MPI.Comm):
        self.domain = runtime.coordinate_domain()
        self.symbols = HeatSymbols.on(self.domain)
        self.form = runtime.CompiledForm(comm, heat_forms(self.domain, self.symbols))
        self.scalar = runtime.CompiledElement(comm, runtime.nodal_element(1))
        self.element = runtime.CompiledElement(comm, runtime.cell_element(1))


def solve_temperature_increment(
    kernels: HeatKernels,
    mesh: DistributedMesh,
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
    mesh
        The updated configuration x_{n+1}.
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
    space = NodalSpace(mesh, kernels.scalar, 1)
    cells = CellSpace(mesh, kernels.element)
    element = cells.function(conductivity)
    form = kernels.form.bind(mesh.cpp, [space.cpp, space.cpp], {kernels.symbols.conductivity: element}, {})
    matrix = runtime.new_matrix(form)
    runtime.assemble_matrix(matrix, form)
    matrix.assemble()
    # In increments, so that the solver's tolerance is one of the change and not of some 300 K.
    right, solution = matrix.createVecs()
    owned = space.particles[: space.owned]
    solution.array[:] = temperature[owned]
    matrix.mult(solution, right)
    right.array[:] = heat[owned] - right.array_r
    diagonal = matrix.getDiagonal()
    diagonal.array[:] += (lumped_capacity + exchange)[owned]
    matrix.setDiagonal(diagonal)
    diagonal.destroy()
    rows = np.flatnonzero(fixed[owned]).astype(np.int32)
    solution.array[:] = fixed_increment[owned]
    matrix.zeroRowsColumnsLocal(rows, 1.0, solution, right)
    solver = PETSc.KSP().create(matrix.getComm())
    solver.setType(PETSc.KSP.Type.CG)
    solver.getPC().setType(PETSc.PC.Type.JACOBI)
    solver.setTolerances(rtol=_TOLERANCE, max_it=2000)
    solver.setOperators(matrix)
    solver.solve(right, solution)
    reason = solver.getConvergedReason()
    increment = space.gather(solution.array_r, len(temperature))[:, 0]
    for owned_object in (solver, right, solution, matrix):
        owned_object.destroy()
    if reason <= 0 or not np.all(np.isfinite(increment)):
        raise HeatSolveFailed(f"the heat equation was not solved (PETSc's reason {reason})")
    return increment
