"""Sparse direct solution with MUMPS through PETSc."""

from __future__ import annotations

from petsc4py import PETSc


class DirectSolver:
    """One MUMPS factorisation, renewed as the matrix changes; owns its PETSc solver.

    Debian's MUMPS has neither METIS nor SCOTCH and its default ordering (PORD) takes longer to analyse than it
    saves, so the approximate minimum degree ordering is set.
    """

    _PREFIX = "pfemcut_direct_"
    _AMD = 0
    _WORKSPACE_PERCENT = 60  # contact makes pivots move: spare room avoids a second factorisation

    def __init__(self, matrix: PETSc.Mat):
        self._solver = PETSc.KSP().create(matrix.getComm())
        self._solver.setOptionsPrefix(self._PREFIX)
        self._solver.setType(PETSc.KSP.Type.PREONLY)
        self._solver.setOperators(matrix)
        preconditioner = self._solver.getPC()
        preconditioner.setType(PETSc.PC.Type.LU)
        preconditioner.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        # Through the options database: petsc4py's setMumpsIcntl is forgotten before the analysis (PETSc 3.18).
        options = PETSc.Options(self._PREFIX)
        options["mat_mumps_icntl_7"] = self._AMD
        options["mat_mumps_icntl_14"] = self._WORKSPACE_PERCENT
        self._solver.setFromOptions()

    def solve(self, right_hand_side: PETSc.Vec, solution: PETSc.Vec) -> bool:
        """Factorise the matrix as it is now and solve; false if the factorisation failed."""
        self._solver.solve(right_hand_side, solution)
        return self._solver.getConvergedReason() > 0

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self._solver.destroy()
