"""What outputs show of contact: tractions on the particles, and where along the tool."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pfemcut.contact.node_to_segment import SurfaceContact
from pfemcut.contact.penalty import ContactForces, contact_forces, facing_lengths
from pfemcut.method import ContactView
from pfemcut.pfem.body_contact import BodyInterface, contact_search, interface_contact
from pfemcut.pfem.mechanics import surface_flow_stress
from pfemcut.pfem.state import State
from pfemcut.problem import MovingTool, Problem

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


def contact_view(problem: Problem, state: State) -> ContactView:
    """Particles of the body that touch the tool, or another body, after the last step."""
    flow_stress = surface_flow_stress(problem, state.mesh, state.fields)
    for tool in problem.rigid_tools:
        return _on_rigid_tool(problem, state, tool, flow_stress)
    mesh, fields, step = state.mesh, state.fields, state.clock.last_dt
    views = [
        _on_body(
            problem,
            state,
            interface,
            interface_contact(
                interface,
                interface.pair.law,
                mesh.points,
                fields.last_displacement,
                step,
                fields.last_displacement / step,
                fields.temperature,
                flow_stress,
            ),
        )
        for interface in contact_search(problem, mesh, np.zeros_like(mesh.points))
    ]
    views.append(ContactView.none())
    return ContactView(
        np.concatenate([each.particles for each in views]),
        np.concatenate([each.arc_length for each in views]),
        np.concatenate([each.pressure for each in views]),
        np.concatenate([each.shear for each in views]),
    )


def _on_rigid_tool(problem: Problem, state: State, tool: MovingTool, flow_stress: Array) -> ContactView:
    mesh, clock = state.mesh, state.clock
    particles = np.unique(mesh.boundary.particles)
    shape = tool.at(clock.time)
    lengths = facing_lengths(shape, mesh.points, mesh.boundary.edges)[particles]
    slip = state.fields.last_displacement[particles] - clock.last_dt * np.asarray(tool.velocity)
    found: ContactForces = contact_forces(
        shape,
        problem.contact,
        mesh.points[particles],
        slip,
        lengths,
        clock.last_dt,
        state.fields.sliding_speed[particles],
        state.fields.temperature[particles],
        flow_stress[particles],
    )
    touching = found.normal_force > 0.0
    loaded = particles[touching]
    return ContactView(
        loaded,
        shape.arc_length(mesh.points[loaded]),
        found.normal_force[touching] / lengths[touching],
        np.abs(found.shear_force[touching]) / lengths[touching],
    )


def _on_body(problem: Problem, state: State, interface: BodyInterface, found: SurfaceContact) -> ContactView:
    """Tractions on the slave's particles: their shares of the forces over those of the lengths."""
    count = len(state.mesh.points)
    points = interface.points
    slave, share = points.particles[found.points], points.shares[found.points]

    def gathered(values: Array) -> Array:
        total = np.bincount(slave.ravel(), (share * values[:, None]).ravel(), minlength=count)
        return total.astype(np.float64, copy=False)

    length = np.bincount(
        points.particles.ravel(), (points.shares * points.lengths[:, None]).ravel(), minlength=count
    )
    force = gathered(found.normal_force)
    loaded = np.flatnonzero(force > 0.0)
    arc_length = np.zeros(len(loaded))
    for tool in problem.tool:
        # Where the foot was on the tool without load.
        master = interface.arcs.nodes[found.foot.arc]
        initial = state.mesh.points[master] - state.fields.displacement[master]
        places = np.einsum("ka,kai->ki", -found.shape[:, 2:], initial)
        along = tool.shape.arc_length(places)
        arc_length = (gathered(along * found.normal_force) / np.where(force > 0.0, force, 1.0))[loaded]
    return ContactView(
        loaded,
        arc_length,
        force[loaded] / length[loaded],
        np.abs(gathered(found.shear_force)[loaded]) / length[loaded],
    )
