"""All contact of one time step: with rigid tools, between bodies, and of bodies with themselves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from pfemcut.contact.friction import remembered_speed
from pfemcut.contact.node_to_segment import SurfaceContact
from pfemcut.contact.penalty import ContactForces, contact_forces, facing_lengths
from pfemcut.fem.momentum_system import NodalForces
from pfemcut.pfem.body_contact import (
    BodyInterface,
    SurfaceInterface,
    contact_search,
    interface_contact,
    nodal_forces,
    require_found,
)
from pfemcut.pfem.self_contact import SelfInterface, require_apart, self_contact_search
from pfemcut.pfem.state import Fields
from pfemcut.problem import ContactLaw, MovingTool, Problem
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class ContactResult:
    """Contact with a tool at the end of a step: candidate particles, and the forces on them."""

    particles: IntArray
    forces: ContactForces


@dataclass(frozen=True)
class StepContact:
    """What may touch in one step, by the search at its start.

    Attributes
    ----------
    problem, mesh, fields
        At the start of the step.
    step
        Its length (s).
    velocity
        Of the particles in the last step (mm/s), from which friction between bodies knows the sliding speed; (n, 2).
    candidates
        Particles of the boundary; shape (b,).
    tools
        Rigid tools, each where it is at the end of the step, with the tributary lengths (b,) that face it (mm).
    interfaces
        One for each contact pair.
    own
        One if bodies may touch themselves.
    flow_stress
        Of the surface (MPa), which friction may depend on; zero if there is none; shape (n,).
    frictionless
        Whether there is no friction anywhere.
    """

    problem: Problem
    mesh: Mesh
    fields: Fields
    step: float
    velocity: Array
    candidates: IntArray
    tools: tuple[tuple[MovingTool, RigidWedge, Array], ...]
    interfaces: tuple[BodyInterface, ...]
    own: tuple[SelfInterface, ...]
    flow_stress: Array
    frictionless: bool

    @staticmethod
    def search(
        problem: Problem,
        mesh: Mesh,
        fields: Fields,
        motion: Array,
        end_time: float,
        step: float,
        last_step: float,
        flow_stress: Callable[[], Array],
    ) -> StepContact:
        """Search at the start of a step that is predicted to move the particles by ``motion`` (n, 2).

        ``flow_stress`` gives that of the particles (MPa); it is not called without friction.
        """
        candidates = np.unique(mesh.boundary.particles)
        shapes = tuple(tool.at(end_time) for tool in problem.rigid_tools)
        interfaces = contact_search(problem, mesh, motion)
        own = self_contact_search(problem, mesh, motion)
        # The law of the tool, of the pairs, and of self-contact only where surfaces may touch.
        laws = (
            problem.contact,
            *(pair.law for pair in problem.pairs),
            *(each.rule.law for each in own if len(each.points.lengths)),
        )
        frictionless = all(law.friction.frictionless for law in laws)
        return StepContact(
            problem=problem,
            mesh=mesh,
            fields=fields,
            step=step,
            velocity=fields.last_displacement / last_step,
            candidates=candidates,
            tools=tuple(
                (tool, shape, facing_lengths(shape, mesh.points, mesh.boundary.edges)[candidates])
                for tool, shape in zip(problem.rigid_tools, shapes, strict=True)
            ),
            interfaces=interfaces,
            own=own,
            flow_stress=np.zeros(len(mesh.points)) if frictionless else flow_stress(),
            frictionless=frictionless,
        )

    @property
    def couplings(self) -> list[IntArray]:
        """Groups of particles that contact may couple though they share no element."""
        return [group for each in (*self.interfaces, *self.own) for group in each.couplings]

    def with_tools(self, displacement: Array, smoothing: float = 1.0) -> tuple[ContactResult, ...]:
        """Contact with each rigid tool after a ``displacement`` (n, 2), with V_ref times ``smoothing``."""
        candidates = self.candidates
        moved = displacement[candidates]
        return tuple(
            ContactResult(
                candidates,
                contact_forces(
                    shape,
                    self.problem.contact.smoothed(smoothing),
                    self.mesh.points[candidates] + moved,
                    moved - self.step * np.asarray(tool.velocity),
                    lengths,
                    self.step,
                    self.fields.sliding_speed[candidates],
                    self.fields.temperature[candidates],
                    self.flow_stress[candidates],
                ),
            )
            for tool, shape, lengths in self.tools
        )

    def between_bodies(self, displacement: Array, smoothing: float = 1.0) -> tuple[SurfaceContact, ...]:
        """Contact of each pair after a ``displacement`` (n, 2)."""
        pairs = [(each, each.pair.law) for each in self.interfaces]
        return self._of_surfaces(pairs, displacement, smoothing)

    def of_bodies_with_themselves(
        self, displacement: Array, smoothing: float = 1.0
    ) -> tuple[SurfaceContact, ...]:
        """Contact of bodies with themselves after a ``displacement`` (n, 2); one entry if that is treated."""
        own = [(each, each.rule.law) for each in self.own]
        return self._of_surfaces(own, displacement, smoothing)

    def forces(self, displacement: Array, smoothing: float) -> list[NodalForces]:
        """All contact forces after a ``displacement`` (n, 2)."""
        return [
            *map(_tool_forces, self.with_tools(displacement, smoothing)),
            *map(nodal_forces, self.between_bodies(displacement, smoothing)),
            *map(nodal_forces, self.of_bodies_with_themselves(displacement, smoothing)),
        ]

    def require_found(self, displacement: Array, between_bodies: Sequence[SurfaceContact]) -> None:
        """Fail if after the ``displacement`` (n, 2) of the step something touches that the search did not watch.

        ``between_bodies`` is :meth:`between_bodies` there.

        Raises
        ------
        pfemcut.pfem.newton.StepFailed
            The step is too long for the search.
        """
        positions = self.mesh.points + displacement
        for each, found in zip(self.interfaces, between_bodies, strict=True):
            require_found(each, found, positions)
        for interface in self.own:
            require_apart(self.mesh, interface, positions)

    def _of_surfaces(
        self, touching: Sequence[tuple[SurfaceInterface, ContactLaw]], displacement: Array, smoothing: float
    ) -> tuple[SurfaceContact, ...]:
        positions = self.mesh.points + displacement
        return tuple(
            interface_contact(
                interface,
                law.smoothed(smoothing),
                positions,
                displacement,
                self.step,
                self.velocity,
                self.fields.temperature,
                self.flow_stress,
            )
            for interface, law in touching
        )


def known_sliding_speed(problem: Problem, before: Array, displacement: Array, step: float) -> Array:
    """Speed against the rigid tool that its friction knows after a ``step`` (s); (n,).

    ``before`` is what it knew before the step (n,), in which the particles moved by ``displacement`` (n, 2). Zero
    without a rigid tool.
    """
    for tool in problem.rigid_tools:
        speed = np.hypot(*(displacement / step - np.asarray(tool.velocity)).T)
        return remembered_speed(before, speed, step, problem.contact.friction.sliding_memory)
    return np.zeros_like(before)


def _tool_forces(contact: ContactResult) -> NodalForces:
    """Forces on the particles that touch a tool."""
    touching = contact.forces.normal_force > 0.0
    return NodalForces.local(
        contact.particles[touching], contact.forces.forces[touching], contact.forces.stiffness[touching]
    )
