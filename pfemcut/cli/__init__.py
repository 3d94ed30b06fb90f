"""Command line.

One BLAS thread unless the environment says otherwise: the fronts of a cut are too small to gain from more, and on a
machine with other work threads that wait for each other are ten times slower. BLAS reads this as it is loaded.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
