"""Heat through the interface between particles and a tool, with the tool's own warming taken in (paper, eqs. 29-35)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class HeatCoupling:
    """What a kelvin more on particles takes from them through interfaces.

    Attributes
    ----------
    particles
        Particles in contact, each once; shape (k,).
    matrix
        Symmetric, positive semi-definite (mW/(mm K)); shape (k, k).
    """

    particles: IntArray
    matrix: Array


@dataclass(frozen=True)
class HeatExchange(HeatCoupling):
    """Heat that an interface takes from particles: matrix (theta - ambient), in mW/mm.

    Attributes
    ----------
    ambient
        Temperature that each particle sees (K); shape (k,).
    """

    ambient: Array

    @staticmethod
    def none() -> HeatExchange:
        """No contact."""
        return HeatExchange(np.empty(0, dtype=np.int64), np.zeros((0, 0)), np.zeros(0))

    def taken(self, temperature: Array) -> Array:
        """Power taken from each of the particles at the ``temperature`` (n,) of all; shape (k,)."""
        taken: Array = self.matrix @ (temperature[self.particles] - self.ambient)
        return taken


def coupled(interfaces: Sequence[HeatCoupling]) -> HeatCoupling:
    """All ``interfaces`` as one; a particle may take part in several."""
    particles = np.unique(np.concatenate([each.particles for each in interfaces]))
    matrix = np.zeros((len(particles), len(particles)))
    for each in interfaces:
        at = np.searchsorted(particles, each.particles)
        matrix[np.ix_(at, at)] += each.matrix
    return HeatCoupling(particles, matrix)


def exchange_matrix(conductance: Array, response: Array) -> Array:
    r"""Matrix of the exchange with a tool that warms as heat enters.

    1. Heat q through conductances H (diagonal): :math:`q = H(\theta - \vartheta)`, the tool at the points being at
       :math:`\vartheta = \vartheta_0 + S q`, where S is its response to a unit of power.
    2. So :math:`q = M (\theta - \vartheta_0)` with :math:`M = (H^{-1} + S)^{-1}`, which stays bounded however large H.
    3. Written as :math:`H^{1/2} (1 + H^{1/2} S H^{1/2})^{-1} H^{1/2}` it also serves points with H = 0.

    Parameters
    ----------
    conductance
        H, of each point (mW/(mm K)); shape (k,).
    response
        S (mm K/mW); shape (k, k); zero for a tool at a given temperature.
    """
    root = np.sqrt(conductance)
    inside = np.eye(len(root)) + root[:, None] * response * root
    matrix = root[:, None] * np.linalg.solve(inside, np.diag(root))
    return 0.5 * (matrix + matrix.T)
