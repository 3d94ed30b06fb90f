"""Keeps the memory that a run frees, instead of giving it back to the system and asking for it again.

Every step allocates and frees the same large arrays and factors. The C library hands such blocks back at once, and each
first touch of a new page then costs a fault: in a virtual machine, several times the first factorisation of a matrix.
"""

from __future__ import annotations

import ctypes

# Parameters of glibc's mallopt (malloc.h).
_TRIM_THRESHOLD = -1
_TOP_PAD = -2
_MMAP_MAX = -4
_KEPT = 2**31 - 1  # bytes; the largest that mallopt takes
_GROWTH = 2**26  # bytes by which the heap grows at least


def keep_freed_memory() -> bool:
    """Set up this process's allocator; false if its C library has none of these settings."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return False
    settings = ((_MMAP_MAX, 0), (_TRIM_THRESHOLD, _KEPT), (_TOP_PAD, _GROWTH))
    return all([bool(mallopt(parameter, value)) for parameter, value in settings])
