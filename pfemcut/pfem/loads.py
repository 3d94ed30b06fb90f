"""Loads on named boundary parts, and inertia, as nodal forces with their derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from pfemcut.fem.momentum_system import NodalForces
from pfemcut.pfem.kinematics import tributary_lengths
from pfemcut.problem import PrescribedMotion, Problem, Schedule

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def part_edges(problem: Problem, mesh: Mesh, part: str) -> IntArray:
    """Particle pairs of the boundary edges of ``part``; shape (k, 2)."""
    numbers = [i for i, name in enumerate(problem.parts) if name == part]
    return mesh.boundary.edges[np.isin(mesh.boundary.parts, numbers)]


def part_particles(problem: Problem, mesh: Mesh, part: str) -> IntArray:
    """Particles on the boundary edges of ``part``."""
    return np.unique(part_edges(problem, mesh, part))


def motion_particles(problem: Problem, mesh: Mesh, motion: PrescribedMotion) -> IntArray:
    """Particles whose motion is prescribed."""
    particles = part_particles(problem, mesh, motion.part)
    if motion.corner:
        particles = np.intersect1d(particles, part_particles(problem, mesh, motion.corner))
    return particles


def load_forces(problem: Problem, mesh: Mesh, displacement: Array, time: float) -> NodalForces:
    """All loads at ``time`` (s) with the particles moved by ``displacement`` (n, 2) from ``mesh``.

    Forces and tractions use the lengths of the mesh, at the start of the step; pressures follow the surface exactly.
    """
    parts = []
    for force in problem.forces:
        edges = part_edges(problem, mesh, force.part)
        lengths = tributary_lengths(mesh.points, edges, len(mesh.points))
        parts.append(_dead(lengths / lengths.sum(), (force.x, force.y), time))
    for traction in problem.tractions:
        edges = part_edges(problem, mesh, traction.part)
        lengths = tributary_lengths(mesh.points, edges, len(mesh.points))
        parts.append(_dead(lengths, (traction.x, traction.y), time))
    for pressure in problem.pressures:
        edges = part_edges(problem, mesh, pressure.part)
        parts.append(_follower(mesh.points + displacement, edges, pressure.pressure(time)))
    return NodalForces.sum(parts)


def nodal_loads(problem: Problem, mesh: Mesh, displacement: Array, time: float) -> Array:
    """Sum of :func:`load_forces` on each particle (N/mm); shape (n, 2)."""
    loads = load_forces(problem, mesh, displacement, time)
    total = np.zeros((len(mesh.points), 2))
    np.add.at(total, loads.particles, loads.forces)
    return total


def _dead(weights: Array, components: tuple[Schedule, Schedule], time: float) -> NodalForces:
    particles = np.flatnonzero(weights)
    forces = np.outer(weights[particles], [component(time) for component in components])
    return NodalForces.local(particles, forces, np.zeros((len(particles), 2, 2)))


def _follower(points: Array, edges: IntArray, pressure: float) -> NodalForces:
    """Half of -p n L of each edge on each of its ends; the body lies on the left, so n L = (dy, -dx)."""
    d = points[edges[:, 1]] - points[edges[:, 0]]
    half = -0.5 * pressure * np.column_stack([d[:, 1], -d[:, 0]])
    # d(force)/d(end) = -p/2 R and d(force)/d(start) = +p/2 R with R = [[0, 1], [-1, 0]].
    by_end = np.broadcast_to(-0.5 * pressure * np.array([[0.0, 1.0], [-1.0, 0.0]]), (len(edges), 2, 2))
    start, end = edges.T
    return NodalForces(
        particles=np.concatenate([start, end]),
        forces=np.concatenate([half, half]),
        rows=np.concatenate([start, start, end, end]),
        columns=np.concatenate([end, start, end, start]),
        stiffness=np.concatenate([-by_end, by_end, -by_end, by_end]),
    )


def inertia_forces(unknown: Array, mass: Array, velocity: Array, step: float) -> NodalForces:
    """-m (u / dt - v) / dt on the particles with mass."""
    heavy = np.flatnonzero(mass)
    forces = -(mass / step)[:, None] * (unknown[:, :2] / step - velocity)
    stiffness = (mass / step**2)[:, None, None] * np.eye(2)
    return NodalForces.local(heavy, forces[heavy], stiffness[heavy])
