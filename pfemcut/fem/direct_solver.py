"""Sparse direct solution with MUMPS through PETSc."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

Array = NDArray[np.float64]
Int32Array = NDArray[np.int32]


class DirectSolver:
    """One MUMPS factorisation, renewed as the values of the matrix change; owns its PETSc objects.

    Debian's MUMPS has neither METIS nor SCOTCH and its default ordering (PORD) takes longer to analyse than it
    saves, so the approximate minimum degree ordering is set.

    Parameters
    ----------
    comm
        Communicator.
    pointers, columns, values
        Compressed rows of this rank. The ``values`` are read anew in every solve.
    block
        Unknowns of a particle: rows come in blocks of so many with the same columns, which the analysis takes as one.
    symmetric
        Factorise as L D L^T, from the upper triangle; else as L U.
    """

    _PREFIX = "pfemcut_direct_"
    _AMD = 0
    _WORKSPACE_PERCENT = 60  # contact makes pivots move: spare room avoids a second factorisation

    def __init__(
        self,
        comm: MPI.Comm,
        pointers: Int32Array,
        columns: Int32Array,
        values: Array,
        *,
        block: int,
        symmetric: bool,
    ):
        self.rows = (pointers, columns, values)
        self.symmetric = symmetric
        count = len(pointers) - 1
        if comm.size == 1:
            self.matrix = PETSc.Mat().createAIJWithArrays((count, count), self.rows, comm=comm)
        else:
            total = comm.allreduce(count)
            self.matrix = PETSc.Mat().createAIJ(((count, total), (count, total)), csr=self.rows, comm=comm)
        self.matrix.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
        self._right, self._solution = self.matrix.createVecs()
        self.solver = PETSc.KSP().create(comm)
        self.solver.setOptionsPrefix(self._PREFIX)
        self.solver.setType(PETSc.KSP.Type.PREONLY)
        self.solver.setOperators(self.matrix)
        preconditioner = self.solver.getPC()
        preconditioner.setType(PETSc.PC.Type.CHOLESKY if symmetric else PETSc.PC.Type.LU)
        preconditioner.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        # Through the options database: petsc4py's setMumpsIcntl is forgotten before the analysis (PETSc 3.18).
        options = PETSc.Options(self._PREFIX)
        options["mat_mumps_icntl_7"] = self._AMD
        options["mat_mumps_icntl_12"] = 1  # no matching before the ordering of a symmetric matrix
        options["mat_mumps_icntl_14"] = self._WORKSPACE_PERCENT
        options["mat_mumps_icntl_15"] = -block
        self.solver.setFromOptions()

    def solve(self, right_hand_side: Array) -> tuple[Array, bool]:
        """Factorise the matrix as its values are now and solve, for this rank's rows; false if that failed."""
        self.update()
        self._right.array[:] = right_hand_side
        self.solver.solve(self._right, self._solution)
        return self._solution.array_r.copy(), self.solver.getConvergedReason() > 0

    def update(self) -> PETSc.Mat:
        """The matrix, with its values as they are now."""
        if self.matrix.getComm().size == 1:
            self.matrix.stateIncrease()
        else:
            self.matrix.setValuesCSR(*self.rows)
            self.matrix.assemble()
        return self.matrix

    def destroy(self) -> None:
        """Free the PETSc objects."""
        for owned in (self.solver, self._right, self._solution, self.matrix):
            owned.destroy()
