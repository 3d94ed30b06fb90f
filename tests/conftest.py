"""Settings of all tests."""

from hypothesis import settings

# A first example may compile kernels, and the machine may be busy: times are the benchmarks' business.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
