"""What a formulation, such as total-Lagrangian or Eulerian SPH, offers to the integrator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import Arrays, Memory
from pfemcut.particles.stress import PointState

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Evaluation(Generic[Memory]):
    """Forces between particles at the end of a step, and what the step did to the material.

    Attributes
    ----------
    internal, viscous, control, between
        Forces (N, or N per mm of width); see :class:`pfemcut.particles.state.Loads`.
    material
        The new material state.
    volume_ratio
        J = rho_0 / rho; shape (n,).
    plastic_work
        Of the step, of all particles (mJ, or mJ per mm of width).
    memory
        What the formulation keeps.
    """

    internal: Array
    viscous: Array
    control: Array
    between: Array
    material: PointState
    volume_ratio: Array
    plastic_work: float
    memory: Memory


class ForceModel(Protocol[Memory]):
    """A formulation for one problem."""

    @property
    def problem(self) -> ParticleProblem:
        """The problem."""

    def start(self) -> Memory:
        """What it keeps at time zero."""

    def evaluate(
        self, memory: Memory, material: PointState, positions: Array, velocities: Array, dt: float
    ) -> Evaluation[Memory]:
        """Forces at ``positions`` (n, d), and the material after the step of ``dt`` (s) that led there.

        ``velocities`` (n, d) are those of the middle of the step.
        """

    def renewed(self, memory: Memory, positions: Array, volume_ratio: Array) -> tuple[Memory, bool]:
        """Memory for the next steps, and whether the reference configuration is a new one."""

    def connected(self, memory: Memory, pairs: IntArray) -> BoolArray:
        """Whether each of the ``pairs`` (m, 2) of one body's particles belongs together; else they touch at most."""

    def arrays(self, memory: Memory) -> Arrays:
        """``memory`` for a checkpoint."""

    def restored(self, arrays: Arrays) -> Memory:
        """The memory that :meth:`arrays` flattened."""
