"""What explicit particle methods are given: bodies filled with particles, walls, a tool, contact and controls.

In the plane, volumes, masses, forces and energies are per mm of width.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pfemcut.materials.material import Material
from pfemcut.problem import ContactLaw, Cut, MovingTool
from pfemcut.problem.course import Course, straight

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]


class Formulation(Enum):
    """How forces between particles are found."""

    TOTAL_LAGRANGIAN = "tlsph"
    EULERIAN = "esph"


@dataclass(frozen=True)
class ParticleBody:
    """A body filled with particles.

    Attributes
    ----------
    name
        Name used in messages and outputs.
    points
        Positions at time zero (mm); shape (n, d).
    volume
        Of one particle (mm^d).
    material
        Material of the whole body.
    temperature
        Initial temperature (K).
    velocity
        Initial velocity (mm/s); shape (d,).
    held
        Components of particles that keep their initial velocity for ever; shape (n, d).
    """

    name: str
    points: Array
    volume: float
    material: Material
    temperature: float
    velocity: Array
    held: BoolArray

    @property
    def rigid(self) -> bool:
        """Whether all particles keep one and the same velocity."""
        velocity = np.broadcast_to(self.velocity, self.points.shape)
        return bool(self.held.all() and (velocity == velocity[0]).all())


@dataclass(frozen=True)
class Wall:
    """A rigid plane without friction, with the bodies on the side that its normal points to.

    Attributes
    ----------
    point, normal
        A point of the plane (mm) and its unit normal; shape (d,).
    penalty
        Pressure per penetration (MPa/mm).
    """

    point: Array
    normal: Array
    penalty: float


@dataclass(frozen=True)
class ExplicitTime:
    """Explicit time steps.

    Attributes
    ----------
    end
        Final time (s).
    courant
        Step over the stability limit h / (c + v) of Courant, Friedrichs and Lewy.
    batch
        Time steps between two looks of the driver, which takes a batch as its step.
    mass_scaling
        Factor on the density where it is inertia; heat capacities keep the true one.
    """

    end: float
    courant: float
    batch: int
    mass_scaling: float


@dataclass(frozen=True)
class SmoothingControls:
    """Constants of smoothed particle hydrodynamics.

    Attributes
    ----------
    spacing
        Wished spacing dp of particles at time zero (mm).
    smoothing_length
        h (mm).
    corrected
        Whether kernel gradients are corrected to be exact for linear fields.
    alpha, beta
        Monaghan's artificial viscosity, linear and quadratic.
    zero_energy
        Modulus of the control of zero-energy modes over Young's modulus (total-Lagrangian).
    reference_update
        Relative displacement of a pair, over h, at which the reference configuration is renewed (total-Lagrangian);
        zero keeps it.
    artificial_pressure
        gamma (Eulerian).
    pinball
        Factors k1 and k2 of contact between bodies by pinballs, and of a body with itself (total-Lagrangian).
    kernel_contact
        Whether bodies of the Eulerian method touch by the sums over the kernel instead.
    """

    spacing: float
    smoothing_length: float
    corrected: bool
    alpha: float
    beta: float
    zero_energy: float
    reference_update: float
    artificial_pressure: float
    pinball: tuple[float, float]
    kernel_contact: bool


@dataclass(frozen=True)
class Gauge:
    """Measures a body along an axis and across it: length and largest diameter."""

    body: int
    axis: int


class OneStage:
    """A problem whose run is one stage, until the end of its ``time``."""

    time: ExplicitTime

    @property
    def course(self) -> Course:
        """How far a run is at each time."""
        return straight(self.time.end)

    def ends_stage(self, time: float) -> bool:
        """Whether a stage ends at ``time`` (s); there is one only."""
        return abs(time - self.time.end) <= 1e-9 * self.time.end


@dataclass(frozen=True)
class ParticleProblem(OneStage):
    """A complete problem for an explicit particle method.

    Attributes
    ----------
    title
        One line for reports.
    formulation
        The method.
    bodies
        All bodies; particles are numbered through.
    walls
        Rigid planes.
    tool
        Analytic rigid tools, none or one.
    contact
        Law of contact between particles and tool.
    time, smoothing
        Controls.
    cut
        Reference figures if the problem is a cut, else empty.
    gauges
        What the history measures of bodies, none or one.
    conduction
        Whether heat flows between particles and into the tool; else it stays where it arises.
    """

    title: str
    formulation: Formulation
    bodies: tuple[ParticleBody, ...]
    walls: tuple[Wall, ...]
    tool: tuple[MovingTool, ...]
    contact: ContactLaw
    time: ExplicitTime
    smoothing: SmoothingControls
    cut: tuple[Cut, ...] = ()
    gauges: tuple[Gauge, ...] = ()
    conduction: bool = False

    def cutting_at(self, time: float) -> bool:
        """Whether a step that ended at ``time`` (s) belongs to a cut."""
        return bool(self.cut) and time <= self.time.end * (1.0 + 1e-9)

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self.bodies[0].points.shape[1])

    @cached_property
    def ranges(self) -> tuple[slice, ...]:
        """Particles of each body."""
        ends = np.cumsum([0, *self._counts])
        return tuple(slice(int(a), int(b)) for a, b in zip(ends[:-1], ends[1:], strict=True))

    @cached_property
    def body_number(self) -> IntArray:
        """Body of each particle; shape (n,)."""
        return np.repeat(np.arange(len(self.bodies)), self._counts)

    @property
    def _counts(self) -> list[int]:
        return [len(body.points) for body in self.bodies]

    @cached_property
    def group(self) -> IntArray:
        """Particles of one number are neighbours: those of a body; of rigid ones each is alone; shape (n,)."""
        own = -1 - np.arange(len(self.body_number))
        return np.where(np.repeat([body.rigid for body in self.bodies], self._counts), own, self.body_number)

    @cached_property
    def points(self) -> Array:
        """Positions at time zero (mm); shape (n, d)."""
        return np.concatenate([body.points for body in self.bodies])

    @cached_property
    def velocities(self) -> Array:
        """Velocities at time zero (mm/s); shape (n, d)."""
        return np.concatenate([np.broadcast_to(body.velocity, body.points.shape) for body in self.bodies])

    @cached_property
    def held(self) -> BoolArray:
        """Components that keep their velocity; shape (n, d)."""
        return np.concatenate([body.held for body in self.bodies])

    @cached_property
    def volume(self) -> Array:
        """Of each particle at time zero (mm^d); shape (n,)."""
        return self.by_body([body.volume for body in self.bodies])

    @cached_property
    def inertial_density(self) -> Array:
        """Density times mass scaling (tonne/mm³) at time zero; shape (n,)."""
        return self.time.mass_scaling * self.by_body([body.material.density for body in self.bodies])

    @cached_property
    def bulk_modulus(self) -> Array:
        """Of each particle (MPa); shape (n,)."""
        return self.by_body([body.material.bulk_modulus for body in self.bodies])

    @cached_property
    def shear_modulus(self) -> Array:
        """Of each particle (MPa); shape (n,)."""
        return self.by_body([body.material.shear_modulus for body in self.bodies])

    @cached_property
    def mass(self) -> Array:
        """Of each particle (tonne, or tonne/mm of width), scaled; shape (n,)."""
        return self.inertial_density * self.volume

    def by_body(self, values: list[float]) -> Array:
        """One of the ``values`` for each body, at each of its particles; shape (n,)."""
        return np.asarray(values, dtype=np.float64)[self.body_number]

    @property
    def young_modulus(self) -> float:
        """Of the stiffest body (MPa)."""
        return max(body.material.young_modulus for body in self.bodies)

    @property
    def bar_speed(self) -> float:
        """Largest sqrt(E / rho) (mm/s), with scaled mass: the sound speed of artificial viscosity."""
        return max(
            float(np.sqrt(body.material.young_modulus / (self.time.mass_scaling * body.material.density)))
            for body in self.bodies
        )

    @property
    def sound_speed(self) -> float:
        """Largest speed of longitudinal waves, sqrt((K + 4/3 G) / rho) (mm/s), with scaled mass."""
        return max(
            float(
                np.sqrt(
                    (body.material.bulk_modulus + 4.0 / 3.0 * body.material.shear_modulus)
                    / (self.time.mass_scaling * body.material.density)
                )
            )
            for body in self.bodies
        )
