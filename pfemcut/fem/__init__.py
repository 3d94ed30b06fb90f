"""Assembly and solution. MPI is loaded first: dolfinx and PETSc of a wheel find their MPI library through it."""

from mpi4py import MPI as MPI
