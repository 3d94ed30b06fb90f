"""Contact between bodies in a time step: the search before the momentum solve, and what it gives the solve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh
from pfemcut.contact.friction import Interface
from pfemcut.contact.heat import HeatExchange
from pfemcut.contact.node_to_segment import ContactPoints, SurfaceContact, surface_contact
from pfemcut.contact.penalty import facing_lengths
from pfemcut.contact.surface import Arcs, BodySurface, Surface, feet, surface_arcs
from pfemcut.fem.momentum_system import NodalForces
from pfemcut.pfem.newton import StepFailed
from pfemcut.problem import ContactIntegration, ContactLaw, ContactPair, MovingTool, Problem

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_REACH = (
    2.0  # arc lengths, and predicted motions in a step, within which a point of the slave surface is watched
)
_SMALLEST_PIECE = 1e-9  # of an edge
_GAUSS = 0.5 - 0.5 / np.sqrt(3.0)  # first of the two Gauss points of a piece


@dataclass(frozen=True)
class SurfaceInterface:
    """Contact in one step: the arcs of a surface, and the points that may touch them."""

    arcs: Arcs
    points: ContactPoints

    @property
    def couplings(self) -> tuple[IntArray, ...]:
        """Particles that each contact point may couple."""
        count, width = self.points.candidates.shape
        arcs = self.arcs.nodes[self.points.candidates].reshape(count, 3 * width)
        return tuple(np.unique(each) for each in np.column_stack([self.points.particles, arcs]))


@dataclass(frozen=True)
class BodyInterface(SurfaceInterface):
    """One contact pair in one step: the arcs are the master's, the points the slave's."""

    pair: ContactPair


def body_surface(problem: Problem, mesh: Mesh, parts: tuple[str, ...], smooth: bool) -> BodySurface:
    """The surface made of the named boundary ``parts`` where its particles are now."""
    return BodySurface(
        surface_arcs(mesh.points, mesh.boundary, _numbers(problem, parts), smooth), mesh.points
    )


def surfaces_around(problem: Problem, mesh: Mesh, time: float, body: int) -> tuple[Surface, ...]:
    """What the surface of the ``body`` of that number may touch: rigid tools, and the surfaces of other bodies."""
    own = set(problem.bodies[body].parts)
    touched = [(pair.master, pair.smooth) for pair in problem.pairs if own & set(pair.slave)]
    touched += [(pair.slave, pair.smooth) for pair in problem.pairs if own & set(pair.master)]
    return (
        *(tool.at(time) for tool in problem.rigid_tools),
        *(body_surface(problem, mesh, parts, smooth) for parts, smooth in touched),
    )


def contact_search(problem: Problem, mesh: Mesh, motion: Array) -> tuple[BodyInterface, ...]:
    """The contact pairs at the start of a step that is predicted to move the particles by ``motion`` (n, 2)."""
    return tuple(_search(problem, mesh, motion, pair) for pair in problem.pairs)


def _search(problem: Problem, mesh: Mesh, motion: Array, pair: ContactPair) -> BodyInterface:
    surface = body_surface(problem, mesh, pair.master, pair.smooth)
    arcs = surface.arcs
    after = BodySurface(arcs, mesh.points + motion)
    chosen = np.isin(mesh.boundary.parts, _numbers(problem, pair.slave))
    edges = mesh.boundary.edges[chosen]
    near = np.zeros(len(mesh.points), dtype=bool)
    particles = np.unique(edges)
    fastest = float(np.hypot(*(motion - motion[arcs.nodes[0, 0]]).T).max())
    longest = float(np.hypot(*(surface.corners[:, 2] - surface.corners[:, 0]).T).max())
    particles = particles[after.about(after.points[particles], _REACH * (longest + fastest))]
    foot = after.foot(after.points[particles])
    master = arcs.nodes[foot.arc]
    ends = mesh.points[master]
    size = np.maximum(np.hypot(*(ends[:, 2] - ends[:, 0]).T), np.hypot(*(ends[:, 1] - ends[:, 0]).T))
    reach = _REACH * (size + np.hypot(*(motion[particles] - motion[master[:, 1]]).T))
    near[particles[np.abs(foot.gap) < reach]] = True
    edges = edges[near[edges].any(axis=1)]
    if pair.integration is ContactIntegration.NODES:
        lengths = facing_lengths(surface, mesh.points, edges)
        facing = np.flatnonzero(lengths)
        ends, shares = np.column_stack([facing, facing]), np.tile([1.0, 0.0], (len(facing), 1))
        lengths = lengths[facing]
    else:
        place, part, edge = _edge_points(surface, mesh.points, edges)
        ends, shares = edges[edge], np.column_stack([1.0 - place, place])
        along = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
        outward = np.column_stack([along[:, 1], -along[:, 0]])
        at = np.einsum("kb,kbi->ki", shares, mesh.points[ends])
        lengths = part * np.maximum(-np.sum(outward * surface.closest(at).normal, axis=1), 0.0)
        facing = np.flatnonzero(lengths)
        ends, shares, lengths = ends[facing], shares[facing], lengths[facing]
    at = np.einsum("kb,kbi->ki", shares, after.points[ends])
    # An edge is the point's own for the whole step: at a corner of the polygon it would otherwise chatter.
    candidates = after.nearest_arcs(at) if pair.smooth else after.foot(at).arc[:, None]
    return BodyInterface(arcs, ContactPoints.at_no_distance(ends, shares, lengths, candidates), pair)


def _edge_points(surface: BodySurface, points: Array, edges: IntArray) -> tuple[Array, Array, IntArray]:
    """Gauss points of slave ``edges`` (e, 2), two on each piece that faces one arc of the master.

    So the shape functions of either side are integrated exactly, as in mortar methods, and a uniform pressure
    passes from mesh to mesh.

    Returns
    -------
    place, part
        Coordinate of each point on its edge, from 0 to 1, and the part of the edge that it stands for; (k,).
    edge
        Its edge; (k,).
    """
    arcs = surface.arcs
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    here, there = surface.foot(start).arc, surface.foot(end).arc
    low, high = np.minimum(here, there), np.maximum(here, there)
    split = (arcs.first[low] == arcs.first[high]) & (2 * (high - low) < arcs.last[low] - arcs.first[low] + 2)
    most = int((high - low)[split].max(initial=0))
    joint = low[:, None] + 1 + np.arange(most)
    valid = split[:, None] & (joint <= high[:, None])
    joint = np.where(valid, joint, 0)
    shape, _, _ = arcs.at(joint, np.zeros(joint.shape))
    at = np.einsum("ema,emai->emi", shape, surface.points[arcs.nodes[joint]])
    along = end - start
    cut = np.einsum("emi,ei->em", at - start[:, None], along) / np.sum(along**2, axis=1)[:, None]
    inner = np.sort(np.where(valid, np.clip(cut, 0.0, 1.0), 1.0), axis=1)
    knots = np.column_stack([np.zeros(len(edges)), inner, np.ones(len(edges))])
    width = np.diff(knots, axis=1)
    edge, piece = np.nonzero(width > _SMALLEST_PIECE)
    left, width = knots[edge, piece], width[edge, piece]
    place = np.concatenate([left + _GAUSS * width, left + (1.0 - _GAUSS) * width])
    return place, np.tile(0.5 * width, 2), np.tile(edge, 2)


def interface_contact(
    interface: SurfaceInterface,
    law: ContactLaw,
    positions: Array,
    displacement: Array,
    step: float,
    velocity: Array,
    temperature: Array,
    flow_stress: Array,
) -> SurfaceContact:
    """Contact of an interface with the particles at ``positions`` (n, 2), reached by ``displacement`` in ``step`` (s).

    ``law`` is the interface's, or a smoother one. ``velocity`` (n, 2), ``temperature`` and ``flow_stress`` (n,) are
    those of the start of the step, which friction may depend on.
    """
    points = interface.points
    # All candidates of a point move nearly alike.
    master = interface.arcs.nodes[points.candidates[:, points.candidates.shape[1] // 2], 1]
    apart = np.einsum("kb,kbi->ki", points.shares, velocity[points.particles]) - velocity[master]
    known_slip_speed = np.hypot(*apart.T)

    def friction(pressure: Array, slip_speed: Array, touching: IntArray) -> tuple[Array, Array, Array]:
        slave, share = points.particles[touching], points.shares[touching]
        state = Interface(
            pressure,
            slip_speed,
            known_slip_speed[touching],
            np.sum(share * temperature[slave], axis=1),
            np.sum(share * flow_stress[slave], axis=1),
        )
        shear = law.friction.shear(state, law.reference_speed)
        return shear.value, shear.by_pressure, shear.by_speed

    return surface_contact(interface.arcs, points, positions, displacement, step, law.penalty, friction)


def spring_energy(interface: SurfaceInterface, penalty: float, points: Array) -> float:
    """Energy in the penalty springs with the particles at ``points`` (n, 2) (mJ/mm)."""

    def none(pressure: Array, *_: Array | IntArray) -> tuple[Array, Array, Array]:
        zero = np.zeros_like(pressure)
        return zero, zero, zero

    still = np.zeros_like(points)
    found = surface_contact(interface.arcs, interface.points, points, still, 1.0, penalty, none)
    return float(found.energy.sum())


def heat_exchange(contacts: Sequence[tuple[ContactLaw, SurfaceContact]], fixed: BoolArray) -> HeatExchange:
    """Conduction through the interfaces (eqs. 29-32); points that touch a ``fixed`` (n,) temperature have none."""
    used = [(law, each) for law, each in contacts if law.conductance.value > 0.0 and len(each.points)]
    if not used:
        return HeatExchange.none()
    particles = np.unique(np.concatenate([each.particles.ravel() for _, each in used]))
    place = np.full(len(fixed), -1)
    place[particles] = np.arange(len(particles))
    matrix = np.zeros((len(particles), len(particles)))
    for law, each in used:
        conductance = law.conductance(each.normal_force / each.lengths) * each.lengths
        conductance = np.where(fixed[each.particles].any(axis=1), 0.0, conductance)
        blocks = conductance[:, None, None] * each.shape[:, :, None] * each.shape[:, None, :]
        at = place[each.particles]
        np.add.at(matrix, (at[:, :, None], at[:, None, :]), blocks)
    return HeatExchange(particles, matrix, np.zeros(len(particles)))


def require_found(interface: BodyInterface, found: SurfaceContact, positions: Array) -> None:
    """Fail if at the end of a step a point has left the arcs among which its foot was looked for.

    Raises
    ------
    StepFailed
        The step is too long for the search.
    """
    points = interface.points
    at = np.einsum("kb,kbi->ki", points.shares, positions[points.particles])
    if not len(at):
        return
    surface = BodySurface(interface.arcs, positions)
    missed = surface.foot(at).gap < 0.0
    missed[found.points] = False
    if not interface.pair.smooth:
        # On its own edge a point may be off the surface that is just within the neighbour's.
        missed &= feet(interface.arcs, positions, at, points.candidates).beyond
    if missed.any():
        raise StepFailed("a particle slides out of the reach of the contact search")


def nodal_forces(found: SurfaceContact) -> NodalForces:
    """The forces of a contact on its particles."""
    k = len(found.particles)
    rows = np.broadcast_to(found.particles[:, :, None], (k, 5, 5))
    columns = np.broadcast_to(found.particles[:, None, :], (k, 5, 5))
    return NodalForces(
        found.particles.ravel(),
        found.forces.reshape(-1, 2),
        rows.ravel(),
        columns.ravel(),
        found.stiffness.transpose(0, 1, 3, 2, 4).reshape(-1, 2, 2),
    )


def deformable_tools(problem: Problem, mesh: Mesh) -> Iterator[tuple[MovingTool, slice]]:
    """The tools that are bodies, and their particles."""
    for tool in problem.tool:
        for body, particles in zip(problem.bodies, mesh.particle_ranges, strict=True):
            if tool.body == body.name:
                yield tool, particles


def force_within(contacts: Sequence[SurfaceContact], particles: slice) -> Array:
    """Sum of the forces of the contacts on the ``particles`` (N/mm); shape (2,)."""
    total = np.zeros(2)
    for each in contacts:
        inside = (each.particles >= particles.start) & (each.particles < particles.stop)
        total += each.forces[inside].sum(axis=0)
    return total


def _numbers(problem: Problem, names: tuple[str, ...]) -> IntArray:
    return np.array([i for i, name in enumerate(problem.parts) if name in names], dtype=np.int64)
