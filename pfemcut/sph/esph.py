"""Eulerian SPH: kernel sums over the present configuration (Islam et al. 2019, section 2.1; Libersky et al. 1993).

Neighbours change as particles move, so nothing has to be cut or joined, and bodies touch through the same sums, unless
pinballs are asked for. These sums also resist sliding, as if bodies stuck together, and a rigid body takes part in them
like any other: it is strained, yields and is heated where the other one passes. Under tension particles cluster
(Swegle, Hicks and Attaway 1995), which artificial pressure holds up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import RunStopped
from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.formulation import Evaluation
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.small_matrices import product
from pfemcut.particles.state import Arrays
from pfemcut.particles.stress import PointState, cauchy_stress, linear_pressure, updated_bodies
from pfemcut.sph.eulerian import PairConstants, pair_forces, support, velocity_sums
from pfemcut.sph.pinball import pinball_contact
from pfemcut.sph.reference import inverse_moments
from pfemcut.sph.touching import OtherBodies

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Density:
    """What Eulerian SPH keeps: the volume ratio J = rho_0 / rho; shape (n,)."""

    volume_ratio: Array


class Eulerian:
    """Eulerian SPH of a problem."""

    def __init__(self, problem: ParticleProblem) -> None:
        self._problem = problem
        self._materials = [body.material for body in problem.bodies]
        controls = problem.smoothing
        reach = support(controls.smoothing_length)
        self._neighbours = (
            NeighbourList(reach) if controls.kernel_contact else NeighbourList(reach, group=problem.group)
        )
        self._touching = OtherBodies(controls.spacing, problem.body_number)
        self._constants = PairConstants(
            smoothing_length=controls.smoothing_length,
            spacing=controls.spacing,
            alpha=controls.alpha,
            beta=controls.beta,
            sound_speed=problem.bar_speed,
            gamma=controls.artificial_pressure,
        )

    @property
    def problem(self) -> ParticleProblem:
        """The problem."""
        return self._problem

    def start(self) -> Density:
        """The density at time zero."""
        return Density(np.ones(len(self._problem.points)))

    def evaluate(
        self, memory: Density, material: PointState, positions: Array, velocities: Array, dt: float
    ) -> Evaluation[Density]:
        """Forces at ``positions`` (n, d), and the material after the step of ``dt`` (s) that led there.

        1. Velocity gradient L in the middle of the step, where ``velocities`` are.
        2. Continuity: J_{n+1} / J_n = (1 + dt/2 tr L) / (1 - dt/2 tr L), which is rho' = -rho tr L to second order.
           For equal densities tr L is the paper's sum (eq. 7), sum_j m_j v_ij·gradient over rho.
        3. Jaumann rate and radial return; forces at the end of the step.

        Raises
        ------
        RunStopped
            If a step compresses a particle to nothing.
        """
        problem, controls = self._problem, self._problem.smoothing
        self._neighbours.follow(positions)
        volume = problem.volume * memory.volume_ratio
        middle = positions - 0.5 * dt * velocities
        rates, moments = velocity_sums(
            self._neighbours, middle, velocities, volume, controls.smoothing_length
        )
        correction = inverse_moments(moments, controls.corrected)
        velocity_gradient = product(rates, correction)
        growth = 0.5 * dt * np.trace(velocity_gradient, axis1=1, axis2=2)
        if not np.abs(growth).max() < 1.0:
            where = ", ".join(f"{x:.3g}" for x in positions[np.argmax(np.abs(growth))])
            raise RunStopped(f"the particle at ({where}) mm changes its volume too much in a step")
        volume_ratio = memory.volume_ratio * (1.0 + growth) / (1.0 - growth)
        update = updated_bodies(
            self._materials, problem.ranges, material, velocity_gradient, dt, volume_ratio
        )
        pressure = linear_pressure(problem.bulk_modulus, volume_ratio)
        stress = cauchy_stress(update.state.deviator, pressure, problem.dimension)
        internal, viscous, repulsive = pair_forces(
            self._neighbours,
            positions,
            velocities,
            problem.mass,
            problem.inertial_density / volume_ratio,
            product(stress, correction),
            pressure,
            self._constants,
        )
        return Evaluation(
            internal=internal,
            viscous=viscous,
            control=repulsive,
            between=self._between(positions, velocities, dt),
            material=update.state,
            volume_ratio=volume_ratio,
            plastic_work=float(update.plastic_work @ (problem.volume * volume_ratio)),
            memory=Density(volume_ratio),
        )

    def _between(self, positions: Array, velocities: Array, dt: float) -> Array:
        """Pinball contact between the bodies, unless they touch by the sums over the kernel."""
        problem = self._problem
        if len(problem.bodies) == 1 or problem.smoothing.kernel_contact:
            return np.zeros_like(positions)
        self._touching.follow(positions)
        return pinball_contact(problem, self._touching, positions, velocities, dt)

    def renewed(self, memory: Density, positions: Array, volume_ratio: Array) -> tuple[Density, bool]:
        """``memory`` as it is: there is no reference configuration."""
        return memory, False

    def connected(self, memory: Density, pairs: IntArray) -> BoolArray:
        """True for all ``pairs`` (m, 2): what is near belongs together."""
        return np.ones(len(pairs), dtype=bool)

    def arrays(self, memory: Density) -> Arrays:
        """``memory`` for a checkpoint."""
        return {"density/volume_ratio": memory.volume_ratio}

    def restored(self, arrays: Arrays) -> Density:
        """The memory that :meth:`arrays` flattened."""
        return Density(np.asarray(arrays["density/volume_ratio"], dtype=np.float64))
