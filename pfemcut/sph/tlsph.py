"""Total-Lagrangian SPH: kernel sums over a reference configuration (Islam et al. 2019, section 2.2; Vignjevic 2006).

Neighbours and kernel gradients are those of the reference, so there is no tensile instability. Where deformation is
large the present configuration becomes the reference, with new neighbours among particles that are connected; stress
stays, and so does the strain of the springs that control zero-energy modes. Particles that aren't connected touch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import RunStopped
from pfemcut.particles.formulation import Evaluation
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.small_matrices import determinant, inverse, product, transposed
from pfemcut.particles.state import Arrays
from pfemcut.particles.stress import PointState, cauchy_stress, linear_pressure, updated_bodies, von_mises
from pfemcut.sph.connectivity import Connectivity, connectivity, renewed_connectivity
from pfemcut.sph.damping import Springs, carried, damping_force, hidden_length
from pfemcut.sph.pinball import pinball_contact
from pfemcut.sph.reference import Reference, reach, reference_of, reference_with
from pfemcut.sph.total_lagrangian import deformation_gradient, internal_force
from pfemcut.sph.touching import TouchingPairs

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Deformation:
    """What total-Lagrangian SPH keeps.

    Attributes
    ----------
    reference
        The reference configuration.
    reference_ratio
        J of the reference, over time zero; shape (n,).
    gradient
        Deformation gradient F from the reference at the end of the last step; shape (n, d, d).
    slip
        Hidden length at which the spring of each pair is relaxed (mm); shape (k,).
    """

    reference: Reference
    reference_ratio: Array
    gradient: Array
    slip: Array


class TotalLagrangian:
    """Total-Lagrangian SPH of a problem."""

    def __init__(self, problem: ParticleProblem) -> None:
        self._problem = problem
        self._materials = [body.material for body in problem.bodies]
        self._touching = TouchingPairs(problem.smoothing.spacing, problem.body_number, problem.group)

    @property
    def problem(self) -> ParticleProblem:
        """The problem."""
        return self._problem

    def start(self) -> Deformation:
        """The reference at time zero, undeformed."""
        problem, controls = self._problem, self._problem.smoothing
        reference = reference_of(
            problem.points, problem.volume, problem.group, controls.smoothing_length, controls.corrected
        )
        return self._undeformed(reference, np.ones(len(problem.points)), np.zeros(reference.distance.shape))

    def evaluate(
        self, memory: Deformation, material: PointState, positions: Array, velocities: Array, dt: float
    ) -> Evaluation[Deformation]:
        """Forces at ``positions`` (n, d), and the material after the step of ``dt`` (s) that led there.

        1. F of the new positions; L dt = (F_{n+1} - F_n) [(F_n + F_{n+1}) / 2]⁻¹, which has no symmetric part in a
           rotation of any size.
        2. Jaumann rate and radial return; pressure from J of the whole history.
        3. P = J sigma F⁻ᵀ and its divergence; artificial viscosity and zero-energy control.

        Raises
        ------
        RunStopped
            If a particle's deformation gradient has turned inside out.
        """
        problem, controls = self._problem, self._problem.smoothing
        reference = memory.reference
        gradient = deformation_gradient(reference, positions)
        ratio = determinant(gradient)
        if not ratio.min() > 0.0:
            where = ", ".join(f"{x:.3g}" for x in positions[np.argmin(ratio)])
            raise RunStopped(
                f"the particle at ({where}) mm has turned inside out; a smaller [particles] reference_update or "
                "more viscosity may help"
            )
        velocity_gradient = (
            product(gradient - memory.gradient, inverse(0.5 * (gradient + memory.gradient))) / dt
        )
        volume_ratio = memory.reference_ratio * ratio
        update = updated_bodies(
            self._materials, problem.ranges, material, velocity_gradient, dt, volume_ratio
        )
        pressure = linear_pressure(problem.bulk_modulus, volume_ratio)
        stress = cauchy_stress(update.state.deviator, pressure, problem.dimension)
        first_piola = ratio[:, None, None] * product(stress, transposed(inverse(gradient)))
        # Springs of a part of the body's stiffness have that part of its strength.
        strength = np.where(update.state.rate > 0.0, von_mises(update.state.deviator), np.inf)
        viscous, control, slip = damping_force(
            reference,
            positions,
            velocities,
            gradient,
            problem.mass,
            problem.inertial_density / volume_ratio,
            Springs(memory.slip, strength / problem.young_modulus),
            (
                controls.smoothing_length,
                controls.alpha,
                controls.beta,
                problem.bar_speed,
                controls.zero_energy * problem.young_modulus,
            ),
        )
        return Evaluation(
            internal=internal_force(reference, first_piola),
            viscous=viscous,
            control=control,
            between=self._between(reference, positions, velocities, dt),
            material=update.state,
            volume_ratio=volume_ratio,
            plastic_work=float(update.plastic_work @ (problem.volume * volume_ratio)),
            memory=Deformation(reference, memory.reference_ratio, gradient, slip),
        )

    def _between(self, reference: Reference, positions: Array, velocities: Array, dt: float) -> Array:
        """Pinball contact between the bodies, and of each with itself."""
        problem = self._problem
        self._touching.follow(positions, reference.connectivity)
        return pinball_contact(problem, self._touching, positions, velocities, dt)

    def renewed(self, memory: Deformation, positions: Array, volume_ratio: Array) -> tuple[Deformation, bool]:
        """The present configuration as reference if a pair has been displaced too far relative to each other."""
        controls = self._problem.smoothing
        if controls.reference_update == 0.0:
            return memory, False
        displacement = positions - memory.reference.points
        pairs = memory.reference.neighbours
        relative = displacement[pairs.indices] - displacement[pairs.owners]
        largest = float(np.sqrt(np.max(np.einsum("ka,ka->k", relative, relative), initial=0.0)))
        if largest <= controls.reference_update * controls.smoothing_length:
            return memory, False
        connected = renewed_connectivity(
            memory.reference.connectivity, positions, reach(controls.smoothing_length), self._problem.group
        )
        reference = self._reference(positions, volume_ratio, connected)
        strain = (
            hidden_length(memory.reference, positions, memory.gradient) - memory.slip
        ) / memory.reference.spring_length
        kept = carried(strain, memory.reference.neighbours, reference.neighbours)
        return self._undeformed(reference, volume_ratio, -kept * reference.spring_length), True

    def connected(self, memory: Deformation, pairs: IntArray) -> BoolArray:
        """Whether each of the ``pairs`` (m, 2) of one body's particles belongs together."""
        return memory.reference.connectivity.connected(pairs)

    def arrays(self, memory: Deformation) -> Arrays:
        """``memory`` for a checkpoint; neighbours and kernels are found again from the points and what is apart."""
        return {
            "reference/points": memory.reference.points,
            "reference/apart": memory.reference.connectivity.apart_pairs,
            "reference/ratio": memory.reference_ratio,
            "reference/gradient": memory.gradient,
            "reference/slip": memory.slip,
        }

    def restored(self, arrays: Arrays) -> Deformation:
        """The memory that :meth:`arrays` flattened."""
        points = np.asarray(arrays["reference/points"], dtype=np.float64)
        ratio = np.asarray(arrays["reference/ratio"], dtype=np.float64)
        gradient = np.asarray(arrays["reference/gradient"], dtype=np.float64)
        slip = np.asarray(arrays["reference/slip"], dtype=np.float64)
        # Runs whose checkpoints don't say what is apart joined all that was near.
        apart = np.asarray(arrays.get("reference/apart", np.empty((0, 2))), dtype=np.int64)
        connected = connectivity(
            points, reach(self._problem.smoothing.smoothing_length), self._problem.group, apart
        )
        return Deformation(self._reference(points, ratio, connected), ratio, gradient, slip)

    @staticmethod
    def _undeformed(reference: Reference, ratio: Array, slip: Array) -> Deformation:
        count, dimension = reference.points.shape
        identity = np.broadcast_to(np.eye(dimension), (count, dimension, dimension)).copy()
        return Deformation(reference, ratio, identity, slip)

    def _reference(self, points: Array, ratio: Array, connected: Connectivity) -> Reference:
        problem, controls = self._problem, self._problem.smoothing
        return reference_with(
            points, problem.volume * ratio, connected, controls.smoothing_length, controls.corrected
        )
