"""What broke: damage, parts, where cracks began and how they run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from pfemcut.peridynamics.bonds import Bonds

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

SMALLEST_PART = 0.01
"""Of all sites, below which a loose piece is no part."""


@dataclass(frozen=True)
class Damage:
    """Fraction of a site's bonds that are broken: of all, of those along the fibre, of the others; shapes (n,)."""

    total: Array
    fibre: Array
    matrix: Array


def damage(bonds: Bonds, broken: BoolArray) -> Damage:
    """phi = 1 - sum mu dV / sum dV over a site's bonds; sites have equal volumes.

    Parameters
    ----------
    bonds
        All bonds; those that a line crack cuts count as broken.
    broken
        Of each entry; shape (k,).
    """
    count = len(bonds.neighbours.offsets) - 1

    def fraction(which: BoolArray) -> Array:
        every = np.bincount(bonds.owners[which], minlength=count)
        gone = np.bincount(bonds.owners[which & broken], minlength=count)
        return np.asarray(gone / np.maximum(every, 1))

    return Damage(fraction(np.ones(len(broken), dtype=bool)), fraction(bonds.fibre), fraction(~bonds.fibre))


def parts(bonds: Bonds, broken: BoolArray, inside: BoolArray) -> int:
    """Number of parts that unbroken bonds hold together, of at least ``SMALLEST_PART`` of the sites.

    Parameters
    ----------
    bonds, broken
        All bonds, and which entries are broken; shape (k,).
    inside
        Whether a site counts; shape (n,).
    """
    count = len(bonds.neighbours.offsets) - 1
    whole = bonds.once & ~broken & inside[bonds.owners] & inside[bonds.neighbours.indices]
    ends = (bonds.owners[whole], bonds.neighbours.indices[whole])
    graph = coo_matrix((np.ones(int(whole.sum()), dtype=np.int8), ends), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    return int((np.bincount(labels[inside]) >= SMALLEST_PART * inside.sum()).sum())


@dataclass(frozen=True)
class Crack:
    """A connected row of broken matrix bonds.

    Attributes
    ----------
    start, time
        Middle of its first broken bond (mm), and when it broke (s).
    angle
        Of the straight line that fits its bonds best, from the pull, in (-90, 90] (degrees).
    length
        Along that line (mm).
    bonds
        Their number.
    """

    start: tuple[float, float]
    time: float
    angle: float
    length: float
    bonds: int


def cracks(bonds: Bonds, sites: Array, broken_at: Array, spacing: float) -> tuple[Crack, ...]:
    """Cracks by their start, the first first.

    Broken matrix bonds whose middles are not farther apart than 1.1 spacings belong to one crack. The line is the
    principal axis of the middles.

    Parameters
    ----------
    bonds
        All bonds.
    sites
        At the start (mm); shape (n, 2).
    broken_at
        Times of breaking of the entries (s), infinite if whole; shape (k,).
    spacing
        R (mm).
    """
    chosen = bonds.once & ~bonds.fibre & ~bonds.cut & np.isfinite(broken_at)
    middles = 0.5 * (sites[bonds.owners[chosen]] + sites[bonds.neighbours.indices[chosen]])
    times = broken_at[chosen]
    if not len(times):
        return ()
    pairs = cKDTree(middles).query_pairs(1.1 * spacing, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(times), len(times)))
    number, labels = connected_components(graph, directed=False)
    found = []
    for label in range(number):
        points, when = middles[labels == label], times[labels == label]
        first = points[when == when.min()].mean(axis=0)
        centred = points - points.mean(axis=0)
        axis = np.linalg.svd(centred, full_matrices=False)[2][0]
        angle = float(np.degrees(np.arctan2(axis[1], axis[0])))
        angle = angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
        along = centred @ axis
        found.append(
            Crack(
                (float(first[0]), float(first[1])),
                float(when.min()),
                angle,
                float(np.ptp(along)),
                len(points),
            )
        )
    return tuple(sorted(found, key=lambda crack: (crack.time, crack.start)))
