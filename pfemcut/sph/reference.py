"""The reference configuration of total-Lagrangian SPH: particles, neighbours and corrected kernel gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.kernel import SUPPORT, slopes, weights
from pfemcut.particles.neighbours import Neighbours
from pfemcut.particles.small_matrices import determinant, inverse
from pfemcut.sph.connectivity import Connectivity, connectivity

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

SMALLEST_MOMENT = 1e-3
"""Determinant of K below which gradients are not corrected; it is one inside of a body."""
SMALLEST_EIGENVALUE = 0.12
"""Eigenvalue of K from which on it is inverted in a reference; at a corner of a lattice it is 0.13 and more.

A particle's stiffness grows with the square of the inverse, so small ones make the time steps too long. In a cut a
particle pushed out of a surface whose others had drawn together had 0.09: it vibrated, and in the end gave the cut a
third as much energy as the tool had.
"""


@dataclass(frozen=True)
class Reference:
    """Particles at the time of the last reference update.

    The gradient of the kernel at particle i towards its neighbour j is ``gradient_weight`` (X_j - X_i): it points to
    the neighbour, so that sum_j V_j (u_j - u_i) ⊗ gradient is the displacement gradient.

    Attributes
    ----------
    points
        X (mm); shape (n, d).
    volume
        Of the particles in this configuration (mm^d); shape (n,).
    connectivity
        Pairs within the support of the kernel: neighbours, and those of one body that are not connected.
    gradient_weight
        |dW/dr| / r of each entry (1/mm^(d+2)); shape (k,).
    distance
        R of each entry (mm); shape (k,).
    spring_weight
        W / R² of each entry (1/mm^(d+2)); shape (k,).
    correction
        K⁻¹ with K_i = sum_j V_j (X_j - X_i) ⊗ gradient, which makes gradients of linear fields exact
        (Bonet and Lok 1999), bounded by ``SMALLEST_EIGENVALUE``; the identity where it is switched off; shape
        (n, d, d).
    """

    points: Array
    volume: Array
    connectivity: Connectivity
    gradient_weight: Array
    distance: Array
    spring_weight: Array
    correction: Array

    @property
    def neighbours(self) -> Neighbours:
        """Pairs of neighbours."""
        return self.connectivity.neighbours


def reach(smoothing_length: float) -> float:
    """Distance (mm) of the farthest neighbours.

    Pairs just as far apart as the support reaches, of which lattices have many, add nothing.
    """
    return (1.0 - 1e-9) * SUPPORT * smoothing_length


def reference_of(
    points: Array, volume: Array, group: IntArray, smoothing_length: float, corrected: bool
) -> Reference:
    """The reference configuration at ``points`` (n, d) with ``volume`` (n,) and ``group`` (n,), all of it connected.

    Particles of different groups are no neighbours. ``smoothing_length`` in mm.
    """
    none = np.empty((0, 2), dtype=np.int64)
    pairs = connectivity(points, reach(smoothing_length), group, none)
    return reference_with(points, volume, pairs, smoothing_length, corrected)


def reference_with(
    points: Array, volume: Array, pairs: Connectivity, smoothing_length: float, corrected: bool
) -> Reference:
    """The reference configuration at ``points`` (n, d) with ``volume`` (n,) and known ``pairs``."""
    dimension = points.shape[1]
    neighbours = pairs.neighbours
    apart = points[neighbours.indices] - points[neighbours.owners]
    distance = np.sqrt(np.einsum("ka,ka->k", apart, apart))
    weight = -slopes(distance, smoothing_length, dimension) / distance
    correction = bounded_inverse_moments(moments(neighbours, apart, weight, volume), corrected)
    spring = weights(distance, smoothing_length, dimension) / distance**2
    return Reference(points, volume, pairs, weight, distance, spring, correction)


def inverse_moments(moments: Array, corrected: bool) -> Array:
    """K⁻¹ (n, d, d) of the ``moments`` K, or the identity where it is not ``corrected`` or can't be.

    Particles on their own, or in a row, have no gradient in some direction to correct.
    """
    found = np.broadcast_to(np.eye(moments.shape[1]), moments.shape).copy()
    if corrected:
        enough = determinant(moments) > SMALLEST_MOMENT
        found[enough] = inverse(moments[enough])
    return found


def bounded_inverse_moments(moments: Array, corrected: bool) -> Array:
    """The same with eigenvalues of K of at least ``SMALLEST_EIGENVALUE``."""
    found = inverse_moments(moments, corrected)
    # K is symmetric and not negative, so the trace of the inverse is at least its largest eigenvalue.
    stiff = np.trace(found, axis1=1, axis2=2) > 1.0 / SMALLEST_EIGENVALUE
    values, vectors = np.linalg.eigh(moments[stiff])
    bounded = 1.0 / np.maximum(values, SMALLEST_EIGENVALUE)
    small = values[:, 0] < SMALLEST_EIGENVALUE
    found[np.flatnonzero(stiff)[small]] = np.einsum("nab,nb,ncb->nac", vectors, bounded, vectors)[small]
    return found


def moments(neighbours: Neighbours, apart: Array, weight: Array, volume: Array) -> Array:
    """K_i = sum_j V_j (X_j - X_i) ⊗ gradient; shape (n, d, d)."""
    scaled = weight * volume[neighbours.indices]
    dimension = apart.shape[1]
    count = len(neighbours.offsets) - 1
    moment = np.empty((count, dimension, dimension))
    for a in range(dimension):
        for b in range(dimension):
            terms = scaled * apart[:, a] * apart[:, b]
            moment[:, a, b] = np.bincount(neighbours.owners, weights=terms, minlength=count)
    return moment
