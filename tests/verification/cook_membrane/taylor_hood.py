"""Cook's membrane, neo-Hookean, with Taylor-Hood elements in dolfinx: the reference for the finite-strain case.

Total Lagrangian, quadratic displacement and linear pressure, the same energy as the solver under test:
W = mu/2 (tr b_iso - 3) + kappa/2 ln² J. Run as a script, with dolfinx 0.5, it writes ``reference/neo_hookean.csv``.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import ufl
from dolfinx import fem, mesh, nls
from mpi4py import MPI

YOUNG, POISSON = 240.565, 0.4999
MU = YOUNG / (2.0 * (1.0 + POISSON))
KAPPA = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
REFERENCE = Path(__file__).parent / "reference"


def tip_displacement(divisions: int, force: float, steps: int) -> tuple[float, float]:
    """Displacement (mm) of the corner (48, 60) under the dead load ``force`` (N/mm) on the right edge."""
    domain = mesh.create_unit_square(MPI.COMM_SELF, divisions, divisions)
    x = domain.geometry.x
    x[:, 1] = 44.0 * x[:, 0] + x[:, 1] * (44.0 - 28.0 * x[:, 0])
    x[:, 0] *= 48.0
    space = fem.FunctionSpace(
        domain,
        ufl.MixedElement(
            ufl.VectorElement("Lagrange", domain.ufl_cell(), 2),
            ufl.FiniteElement("Lagrange", domain.ufl_cell(), 1),
        ),
    )
    displacements, _ = space.sub(0).collapse()
    zero = fem.Function(displacements)
    clamped = fem.locate_dofs_geometrical((space.sub(0), displacements), lambda x: np.isclose(x[0], 0.0))
    edges = mesh.locate_entities_boundary(domain, 1, lambda x: np.isclose(x[0], 48.0))
    tags = mesh.meshtags(domain, 1, np.sort(edges), np.ones(len(edges), dtype=np.int32))
    loaded = ufl.Measure("ds", domain=domain, subdomain_data=tags)(1)

    unknown = fem.Function(space)
    u, p = ufl.split(unknown)
    v, q = ufl.TestFunctions(space)
    load = fem.Constant(domain, 0.0)
    gradient = ufl.Identity(2) + ufl.grad(u)
    jacobian = ufl.det(gradient)
    b = jacobian ** (-2.0 / 3.0) * gradient * gradient.T
    third = (ufl.tr(b) + jacobian ** (-2.0 / 3.0)) / 3.0
    kirchhoff = MU * (b - third * ufl.Identity(2)) + jacobian * p * ufl.Identity(2)
    metadata = {"quadrature_degree": 5}
    volume = ufl.Measure("dx", domain=domain, metadata=metadata)
    form = ufl.inner(kirchhoff, ufl.grad(v) * ufl.inv(gradient)) * volume
    form += q * (ufl.ln(jacobian) - jacobian * p / KAPPA) * volume - load / 16.0 * v[1] * loaded
    problem = fem.petsc.NonlinearProblem(form, unknown, [fem.dirichletbc(zero, clamped, space.sub(0))])
    solver = nls.petsc.NewtonSolver(MPI.COMM_SELF, problem)
    solver.rtol, solver.atol, solver.convergence_criterion = 1e-9, 1e-12, "incremental"
    solver.krylov_solver.setType("preonly")
    solver.krylov_solver.getPC().setType("lu")
    solver.krylov_solver.getPC().setFactorSolverType("mumps")
    for step in range(1, steps + 1):
        load.value = force * step / steps
        solver.solve(unknown)
    moved = unknown.sub(0).collapse()
    at = np.argmin(np.hypot(*(displacements.tabulate_dof_coordinates()[:, :2] - (48.0, 60.0)).T))
    ux, uy = moved.x.array.reshape(-1, 2)[at]
    return float(ux), float(uy)


def main() -> None:
    REFERENCE.mkdir(exist_ok=True)
    with (REFERENCE / "neo_hookean.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["force", "divisions", "ux", "uy"])
        for force, steps in ((0.1, 1), (100.0, 10)):
            for divisions in (8, 16, 32, 64):
                ux, uy = tip_displacement(divisions, force, steps)
                writer.writerow([force, divisions, f"{ux:.7g}", f"{uy:.7g}"])
                print(force, divisions, ux, uy)


if __name__ == "__main__":
    main()
