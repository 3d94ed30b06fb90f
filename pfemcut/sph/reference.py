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

SHORTEST_SPRING = 1.0 / 3.0
"""Of the smoothing length: springs of shorter pairs are as stiff as one of this length."""
SMALLEST_MOMENT = 1e-3
"""Determinant of K below which gradients are not corrected; it is one inside of a body."""
STEEPEST = 1.5
"""Bound on sum_j V_j |K⁻¹ gradient|, the largest deformation that displacements of one can cause, over that inside of a
body. A particle's stiffness grows with its square. It is at most 1.3 at corners of lattices.

At 2 explicit steps of half the stability limit were too long: in a cut one particle that was pushed out of a surface,
whose others had drawn together, vibrated and in the end gave a third as much energy as the tool had.
"""
INSIDE = {1: 4.0 / 3.0, 2: 15.0 / 7.0, 3: 14.0 / 5.0}
"""h times that sum inside of a body, in each dimension: the integral of |dW/dr| h."""


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
    spring_length
        L = max(R, h/3) of each entry (mm): particles can meet, and then W / R² has no bound; shape (k,).
    spring_weight
        W / L² of each entry (1/mm^(d+2)); shape (k,).
    correction
        K⁻¹ with K_i = sum_j V_j (X_j - X_i) ⊗ gradient, which makes gradients of linear fields exact
        (Bonet and Lok 1999), where that makes them no steeper than ``STEEPEST``; the identity where it is switched
        off; shape (n, d, d).
    """

    points: Array
    volume: Array
    connectivity: Connectivity
    gradient_weight: Array
    distance: Array
    spring_length: Array
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
    correction = inverse_moments(moments(neighbours, apart, weight, volume), corrected)
    if corrected:
        correction = bounded(correction, neighbours, apart * weight[:, None], volume, smoothing_length)
    length = np.maximum(distance, SHORTEST_SPRING * smoothing_length)
    spring = weights(distance, smoothing_length, dimension) / length**2
    return Reference(points, volume, pairs, weight, distance, length, spring, correction)


def inverse_moments(moments: Array, corrected: bool) -> Array:
    """K⁻¹ (n, d, d) of the ``moments`` K, or the identity where it is not ``corrected`` or can't be.

    Particles on their own, or in a row, have no gradient in some direction to correct.
    """
    found = np.broadcast_to(np.eye(moments.shape[1]), moments.shape).copy()
    if corrected:
        enough = determinant(moments) > SMALLEST_MOMENT
        found[enough] = inverse(moments[enough])
    return found


def bounded(
    correction: Array, neighbours: Neighbours, gradient: Array, volume: Array, smoothing_length: float
) -> Array:
    """``correction`` (n, d, d) with its largest eigenvalues lowered where gradients (k, d) become too steep."""
    found = correction.copy()
    inside = INSIDE[gradient.shape[1]]
    # Each turn ends a little above the bound where other directions count too.
    for _ in range(5):
        steep = smoothing_length * steepness(found, neighbours, gradient, volume) / inside
        over = np.flatnonzero(steep > STEEPEST)
        if not over.size:
            break
        values, vectors = np.linalg.eigh(found[over])
        values = np.minimum(values, values[:, -1:] * (STEEPEST / steep[over])[:, None])
        found[over] = np.einsum("nab,nb,ncb->nac", vectors, values, vectors)
    return found


def steepness(correction: Array, neighbours: Neighbours, gradient: Array, volume: Array) -> Array:
    """sum_j V_j |K⁻¹ gradient_ij| (1/mm; (n,)) of the gradients (k, d) of the kernel."""
    owners = neighbours.owners
    corrected = np.einsum("kab,kb->ka", correction[owners], gradient)
    length = np.sqrt(np.einsum("ka,ka->k", corrected, corrected))
    return np.asarray(np.bincount(owners, weights=length * volume[neighbours.indices], minlength=len(volume)))


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
