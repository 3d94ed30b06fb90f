"""The particle step of a time step: where the solution asks for particles, and the remesh (paper, Box 1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from meshing.remesh import RemeshMap, SpacingRules, remesh
from meshing.sizes import SizeField, SpacingField
from pfemcut.contact.surface import Surface
from pfemcut.pfem.estimators import coarsening_factors
from pfemcut.pfem.loads import part_particles
from pfemcut.pfem.self_contact import sizes_beside_contact
from pfemcut.pfem.state import Clock, Fields
from pfemcut.problem import ParticleControls, Problem

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_HOT = 0.25  # score above which plastic power keeps its particles: hysteresis against removal
_HOT_REMOVAL = 0.4  # removal distance there, relative to the refined spacing, below the insertion distance
_STRAIGHT = 1e-6  # sine of the turn below which a boundary is straight
_CONTACT_EDGE = 0.1  # an edge whose ends are closer to the tool than this times its length lies on it


def remesh_particles(
    problem: Problem,
    mesh: Mesh,
    fields: Fields,
    tools: tuple[Surface, ...],
    clock: Clock,
    probe_ids: IntArray,
) -> tuple[Mesh, RemeshMap]:
    """Remove and insert particles of one body and triangulate anew.

    ``tools`` are what its boundary may touch; particles with ``probe_ids`` stay.

    Raises
    ------
    meshing.triangulation.BoundaryCrossing
        If the body overlaps itself.
    """
    controls = problem.particles
    sizes = sizes_beside_contact(problem, mesh, sizes_at(problem, clock.time))
    score = plastic_power_score(mesh, fields, controls)
    probes = np.isin(mesh.ids, probe_ids)
    locked = supported_particles(problem, mesh) | probes
    scale = _removal_scale(mesh, score, controls)
    scale[probes] = 0.0
    return remesh(
        mesh,
        sizes,
        spacing_rules(controls),
        refine_score=score,
        removal_scale=scale,
        coarsening=coarsening_factors(
            problem, mesh, fields, sizes, clock.last_dt * np.asarray(controls.sizes_velocity)
        ),
        locked=locked,
        free=_free_particles(problem, mesh, tools, sizes, locked),
        place_boundary=lambda a, b: _place_on_surface(a, b, tools),
    )


def sizes_at(problem: Problem, time: float) -> SizeField:
    """The size field at ``time`` (s)."""
    controls = problem.particles
    return controls.sizes.moved(time * np.asarray(controls.sizes_velocity))


def spacing_rules(controls: ParticleControls) -> SpacingRules:
    """The controls that concern distances."""
    return SpacingRules(
        boundary_split=controls.boundary_split,
        boundary_removal=controls.boundary_removal,
        interior_radius=controls.interior_radius,
        interior_area=controls.interior_area,
        interior_spacing=controls.interior_spacing,
        interior_removal=controls.interior_removal,
        power_smallest=controls.power_smallest,
        insert=controls.insert,
        remove=controls.remove,
    )


def plastic_power_score(mesh: Mesh, fields: Fields, controls: ParticleControls) -> Array:
    """Plastic power of each element over its tolerance, the left side of eq. 1 over the right; shape (m,)."""
    power = fields.plastic_power * signed_areas(mesh.points, mesh.cells)
    total = float(power.sum())
    if total <= 0.0:
        return np.zeros(len(power))
    return power / (controls.power_tolerance * total)


def supported_particles(problem: Problem, mesh: Mesh) -> BoolArray:
    """Particles on curved boundary parts with a prescribed motion; shape (n,).

    On a straight one, such as a symmetry line, a collapse stays on the line, so those are edited like others.
    """
    names = {motion.part for motion in problem.motions}
    numbers = [i for i, name in enumerate(problem.parts) if name in names]
    boundary = mesh.boundary
    held = np.isin(boundary.parts, numbers)
    at = mesh.points[boundary.particles]
    back, ahead = at - at[boundary.preceding], at[boundary.following] - at
    turn = np.abs(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0])
    bent = turn > _STRAIGHT * np.hypot(*back.T) * np.hypot(*ahead.T)
    curved = held & held[boundary.preceding] & bent
    supported = np.zeros(len(mesh.points), dtype=bool)
    supported[boundary.particles[curved]] = True
    return supported


def _removal_scale(mesh: Mesh, score: Array, controls: ParticleControls) -> Array:
    scale = np.ones(len(mesh.points))
    scale[mesh.cells[score > _HOT]] = _HOT_REMOVAL * controls.power_smallest / controls.interior_removal
    return scale


def _free_particles(
    problem: Problem, mesh: Mesh, tools: tuple[Surface, ...], sizes: SpacingField, locked: BoolArray
) -> BoolArray:
    """Boundary particles away from tools and supports, which may shift to keep the area; shape (n,)."""
    free = np.zeros(len(mesh.points), dtype=bool)
    particles = mesh.boundary.particles
    free[particles] = ~locked[particles]
    for motion in problem.motions:
        free[part_particles(problem, mesh, motion.part)] = False
    for tool in tools:
        free[particles] &= tool.closest(mesh.points[particles]).gap > sizes(mesh.points[particles])
    return free


def _place_on_surface(a: Array, b: Array, tools: tuple[Surface, ...]) -> Array:
    """Middles of the edges a-b, moved off the tool: on it to the mean gap of the ends, elsewhere out of it."""
    middle = 0.5 * (a + b)
    length = np.hypot(*(b - a).T)
    for tool in tools:
        gap_a, gap_b = tool.closest(a).gap, tool.closest(b).gap
        at_middle = tool.closest(middle)
        on_tool = np.maximum(np.abs(gap_a), np.abs(gap_b)) < _CONTACT_EDGE * length
        target = np.where(on_tool, 0.5 * (gap_a + gap_b), 0.0)
        lift = np.maximum(target - at_middle.gap, 0.0)
        middle = middle + lift[:, None] * at_middle.normal
    return middle
