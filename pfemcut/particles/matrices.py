"""Inverses and determinants of many small matrices: several times as fast as LAPACK called for each."""

from __future__ import annotations

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

Array = NDArray[np.float64]


def inverses(matrices: Array) -> tuple[Array, Array]:
    """Inverses (n, d, d) and determinants (n,) of ``matrices`` (n, d, d), d = 2 or 3; inf or nan for none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse, determinant = (_inverses_2d if matrices.shape[1] == 2 else _inverses_3d)(matrices)
    return inverse, determinant


@njit(parallel=True, cache=True, error_model="numpy")
def _inverses_2d(matrices):  # type: ignore[no-untyped-def]
    count = len(matrices)
    inverse, determinant = np.empty((count, 2, 2)), np.empty(count)
    for i in prange(count):
        a, b, c, d = matrices[i, 0, 0], matrices[i, 0, 1], matrices[i, 1, 0], matrices[i, 1, 1]
        found = a * d - b * c
        inverse[i, 0, 0], inverse[i, 0, 1] = d / found, -b / found
        inverse[i, 1, 0], inverse[i, 1, 1] = -c / found, a / found
        determinant[i] = found
    return inverse, determinant


@njit(parallel=True, cache=True, error_model="numpy")
def _inverses_3d(matrices):  # type: ignore[no-untyped-def]
    count = len(matrices)
    inverse, determinant = np.empty((count, 3, 3)), np.empty(count)
    for i in prange(count):
        a, b, c = matrices[i, 0, 0], matrices[i, 0, 1], matrices[i, 0, 2]
        d, e, f = matrices[i, 1, 0], matrices[i, 1, 1], matrices[i, 1, 2]
        g, h, k = matrices[i, 2, 0], matrices[i, 2, 1], matrices[i, 2, 2]
        ek, fg, dh = e * k - f * h, f * g - d * k, d * h - e * g
        found = a * ek + b * fg + c * dh
        one = 1.0 / found
        inverse[i, 0, 0], inverse[i, 0, 1], inverse[i, 0, 2] = (
            one * ek,
            one * (c * h - b * k),
            one * (b * f - c * e),
        )
        inverse[i, 1, 0], inverse[i, 1, 1], inverse[i, 1, 2] = (
            one * fg,
            one * (a * k - c * g),
            one * (c * d - a * f),
        )
        inverse[i, 2, 0], inverse[i, 2, 1], inverse[i, 2, 2] = (
            one * dh,
            one * (b * g - a * h),
            one * (a * e - b * d),
        )
        determinant[i] = found
    return inverse, determinant
