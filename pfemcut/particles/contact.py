"""Penalty contact of particles with analytic rigid bodies: the tool of the cutting problem, and planes.

The surface of a body filled with particles lies half a spacing outside of its outer particles, so contact begins when
a particle is that near.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.contact.penalty import contact_forces
from pfemcut.method import ContactView
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.stress import PointState, von_mises
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RigidContact:
    """What tool and walls do to the particles.

    Attributes
    ----------
    forces
        On the particles (N, or N per mm of width); shape (n, d).
    tool_force
        On the tool; shape (d,).
    energy
        In the penalty springs (mJ, or mJ/mm).
    friction_power
        Heat of friction at each particle (mW, or mW/mm); shape (n,).
    """

    forces: Array
    tool_force: Array
    energy: float
    friction_power: Array


def rigid_contact(
    problem: ParticleProblem,
    material: PointState,
    positions: Array,
    velocities: Array,
    time: float,
    dt: float,
) -> RigidContact:
    """Forces of tool and walls at ``time`` on particles at ``positions`` with ``velocities`` (n, d)."""
    forces = np.zeros_like(positions)
    friction_power = np.zeros(len(positions))
    tool_force = np.zeros(problem.dimension)
    energy = 0.0
    half = 0.5 * problem.smoothing.spacing
    for wall in problem.walls:
        depth = np.maximum(half - (positions - wall.point) @ wall.normal, 0.0)
        stiffness = wall.penalty * problem.smoothing.spacing ** (problem.dimension - 1)
        forces += stiffness * depth[:, None] * wall.normal
        energy += 0.5 * stiffness * float(depth @ depth)
    for tool in problem.tool:
        shape = grown(tool.at(time), half)
        near = np.flatnonzero(shape.closest(positions).gap < 0.0)
        slip = velocities[near] - np.asarray(tool.velocity)
        found = contact_forces(
            shape,
            problem.contact,
            positions[near],
            dt * slip,
            np.full(len(near), problem.smoothing.spacing),
            dt,
            np.hypot(*slip.T),
            material.temperature[near],
            von_mises(material.deviator[near]),
        )
        normal = shape.closest(positions[near]).normal
        tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
        # Explicit friction must not turn the slip round: at most what halves it in a step.
        most = 0.5 * problem.mass[near] * np.abs(found.slip_speed) / dt
        shear = np.clip(found.shear_force, -most, most)
        forces[near] += found.normal_force[:, None] * normal + shear[:, None] * tangent
        friction_power[near] = -shear * found.slip_speed
        tool_force = -np.sum(forces[near], axis=0)
        energy += float(found.energy.sum())
    return RigidContact(forces, tool_force, energy, friction_power)


def contact_stiffness(problem: ParticleProblem) -> float:
    """Largest stiffness of a penalty spring (N/mm, or N/mm per mm of width); zero without contact."""
    area = problem.smoothing.spacing ** (problem.dimension - 1)
    penalties = [wall.penalty for wall in problem.walls] + [problem.contact.penalty for _ in problem.tool]
    return area * max(penalties, default=0.0)


def grown(tool: RigidWedge, distance: float) -> RigidWedge:
    """The tool with its surface moved outwards by ``distance`` (mm)."""
    return replace(tool, tip_radius=tool.tip_radius + distance)


def tool_contact_view(problem: ParticleProblem, positions: Array, time: float) -> ContactView:
    """Particles that touch the tool, without friction's part."""
    for tool in problem.tool:
        shape = tool.at(time)
        gap = grown(shape, 0.5 * problem.smoothing.spacing).closest(positions).gap
        touching = np.flatnonzero(gap < 0.0)
        return ContactView(
            touching,
            shape.arc_length(positions[touching]),
            -problem.contact.penalty * gap[touching],
            np.zeros(len(touching)),
        )
    return ContactView.none()
