"""What outputs show of particles.

In the plane the particles of a cut are joined to triangles, those of a Delaunay triangulation that are not larger than
the spacing allows (an alpha shape; Edelsbrunner, Kirkpatrick and Seidel 1983). Only outputs see them: with the body's
outline every figure that is derived from a mesh has a meaning for particles too. Other problems are clouds of points.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from pfemcut.method import ContactView, Frame
from pfemcut.output.vtu import boundary_loops
from pfemcut.particles.formulation import ForceModel
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import Memory, State
from pfemcut.particles.stress import linear_pressure, von_mises
from pfemcut.results.derived.rays import loop_edges
from pfemcut.results.derived.tool_profiles import directions, facing_halves
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

LARGEST_RADIUS = 1.6
"""Largest circumradius of a triangle over the spacing of particles at time zero; a square lattice has 0.71."""
_LEAST_LENGTH = 0.25
"""Of the spacing: particles of the outline with less of it along the tool bear no traction of their own."""


def frame_of(model: ForceModel[Memory], state: State[Memory], travel: float) -> Frame:
    """The frame of ``state``: all particles in one cloud, or the triangles of a cut's first body."""
    problem = model.problem
    fields = point_fields(problem, state)
    cells: IntArray = np.empty((0, 3), dtype=np.int64)
    particles = slice(0, len(state.positions))
    if problem.cut:
        particles = problem.ranges[0]
        cells = joined(state.positions[particles], LARGEST_RADIUS * problem.smoothing.spacing)
        # No triangle between a chip and the workpiece where it only touches it.
        sides = particles.start + cells[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        cells = cells[model.connected(state.memory, sides).reshape(-1, 3).all(axis=1)]
    loops = boundary_loops(cells)
    tools = tuple(tool.at(state.clock.time) for tool in problem.tool)
    contact = ContactView.none()
    for tool in tools:
        contact = tractions_on(
            tool,
            state.positions[particles],
            state.loads.contact[particles],
            loops,
            problem.smoothing.spacing,
        )
    return Frame(
        step=state.clock.batches,
        time=state.clock.time,
        travel=travel,
        points=state.positions[particles],
        cells=cells,
        loops=loops,
        point_fields={name: values[particles] for name, values in fields.items()},
        cell_fields=cell_fields(fields, cells) if len(cells) else {},
        tool=tools,
        contact=contact,
        surface_offset=0.5 * problem.smoothing.spacing,
    )


def point_fields(problem: ParticleProblem, state: State[Any]) -> dict[str, NDArray[Any]]:
    """Fields on the particles by standard name."""
    material = state.material
    pressure = linear_pressure(problem.bulk_modulus, state.volume_ratio)
    stress = material.deviator.copy()
    stress[:, :3] -= pressure[:, None]
    mises = von_mises(material.deviator)
    return {
        "velocity": state.velocities,
        # As the PFEM's: positive in tension.
        "pressure": -pressure,
        "temperature": material.temperature,
        "particle_id": np.arange(len(pressure)),
        "body_number": problem.body_number,
        "equivalent_plastic_strain": material.eqps,
        "equivalent_plastic_strain_rate": material.rate,
        "von_mises": mises,
        "cauchy_stress": stress,
        "plastic_power": mises * material.rate,
    }


def joined(points: Array, radius: float) -> IntArray:
    """Delaunay triangles of ``points`` (n, 2) with circumradii up to ``radius`` (mm), counter-clockwise; (m, 3)."""
    cells = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[cells[:, corner]] for corner in range(3))
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    cells[doubled < 0.0] = cells[doubled < 0.0][:, [0, 2, 1]]
    sides = np.prod([np.hypot(*(b - a).T), np.hypot(*(c - b).T), np.hypot(*(a - c).T)], axis=0)
    return cells[sides <= radius * 2.0 * np.abs(doubled)]


def cell_fields(fields: Mapping[str, NDArray[Any]], cells: IntArray) -> dict[str, Array]:
    """Means over the corners of triangles of the fields that a mesh has on elements."""
    names = (
        "equivalent_plastic_strain",
        "equivalent_plastic_strain_rate",
        "von_mises",
        "plastic_power",
    )
    found = {name: fields[name][cells].mean(axis=1) for name in names}
    found["cauchy_stress"] = fields["cauchy_stress"][:, :4][cells].mean(axis=1)
    return found


def tractions_on(
    tool: RigidWedge, points: Array, forces: Array, loops: tuple[IntArray, ...], spacing: float
) -> ContactView:
    """What the body feels of the tool, at the particles of its outline that face the tool.

    Each stands for the halves of the outline's edges beside it, as in profiles along the tool; forces on other
    particles, inside of the outline or with hardly an edge along the tool, are taken to the nearest of these. So
    tractions times lengths add up to the forces.

    Parameters
    ----------
    points
        Of the body's particles (mm); shape (n, 2).
    forces
        Of the tool on them (N per mm of width); shape (n, 2).
    loops
        The outline.
    spacing
        Of particles at the start (mm).
    """
    touching = np.flatnonzero(np.any(forces != 0.0, axis=1))
    before, after = facing_halves(tool, points, loop_edges(loops))
    length = before + after
    carrying = touching[length[touching] > _LEAST_LENGTH * spacing]
    arc = tool.arc_length(points[carrying])
    if not carrying.size:
        return ContactView(carrying, arc, np.empty(0), np.empty(0))
    normal, along = directions(tool, points[touching])
    _, nearest = cKDTree(arc[:, None]).query(tool.arc_length(points[touching])[:, None])
    pressure, shear = (
        np.bincount(nearest, np.sum(forces[touching] * direction, axis=1), minlength=carrying.size)
        / length[carrying]
        for direction in (normal, along)
    )
    return ContactView(carrying, arc, pressure, np.abs(shear))
