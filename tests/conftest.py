"""Settings of all tests."""

import signal

from hypothesis import settings

# Before any test imports dolfinx or PETSc, whose wheels find their MPI library through it.
from mpi4py import MPI as MPI

# A shell that starts the tests in the background leaves SIGINT ignored, which runs and their children then respect.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A first example may compile kernels, and the machine may be busy: times are the benchmarks' business.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
