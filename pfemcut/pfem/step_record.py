"""What a time step leaves for the history and the ledger: forces, works, heat and counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from meshing.remesh import RemeshMap
from pfemcut.pfem import energies
from pfemcut.pfem.bodies import moduli, thermal_strains
from pfemcut.pfem.body_contact import deformable_tools, force_within
from pfemcut.pfem.kinematics import element_mean
from pfemcut.pfem.loads import motion_particles, nodal_loads
from pfemcut.pfem.mechanics import Motion, PlasticUpdate
from pfemcut.pfem.state import Fields, Ledger, State
from pfemcut.pfem.step_size import flow_change
from pfemcut.pfem.thermal import Heating
from pfemcut.problem import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StepRecord:
    """What the last step leaves for the history besides the state.

    Attributes
    ----------
    tool_force
        Force on the tool (N/mm); (2,).
    self_contact_length, self_contact_force
        Length over which bodies touch themselves (mm), and sum of the normal force there (N/mm).
    inserted, removed, changed, outside
        Particles inserted and removed, elements that changed, Gauss points outside the old mesh.
    newton_iterations
        Linear solves of the momentum equation.
    plastic_power
        Total (mW/mm).
    flow_change
        Part of the plastic power that the step moved, see :mod:`pfemcut.pfem.step_size`.
    reactions
        Of the support on the body for each prescribed motion, along its axis: force (N/mm), and its moments with the
        initial distances from the motion's centre in x and y (N); (motions, 3).
    """

    tool_force: Array
    self_contact_length: float
    self_contact_force: float
    inserted: int
    removed: int
    changed: int
    outside: int
    newton_iterations: int
    plastic_power: float
    flow_change: float
    reactions: Array


def recorded_step(
    problem: Problem,
    state: State,
    mesh: Mesh,
    fields: Fields,
    moved: Mesh,
    motion: Motion,
    plastic: PlasticUpdate,
    power: Array,
    heating: Heating,
    remesh_map: tuple[RemeshMap, ...],
    springs: float,
    step: float,
) -> tuple[StepRecord, Ledger]:
    """History record of the step, and the ledger with the step's work and heat.

    ``springs`` is the energy in the penalty springs at its start (mJ/mm).
    """
    areas = signed_areas(moved.points, moved.cells)
    total_power = float(np.sum(power * areas))
    force = np.zeros(2)
    work = friction = spring = 0.0
    for tool, result in zip(problem.rigid_tools, motion.contact, strict=True):
        on_body = result.forces.forces.sum(axis=0)
        force -= on_body
        # Trapezoidal rule: from the force at the start of the step to the one at its end.
        work += 0.5 * float((on_body - state.last_tool_force) @ np.asarray(tool.velocity)) * step
        friction += float(result.forces.friction_power.sum()) * step
        spring += float(result.forces.energy.sum())
    for found in (*motion.body_contact, *motion.self_contact):
        friction += float(found.friction_power.sum()) * step
        spring += float(found.energy.sum())
    for tool, particles in deformable_tools(problem, mesh):
        on_tool = force_within(motion.body_contact, particles)
        force += on_tool
        # It is what its supports, which all move with the tool, put in.
        work -= 0.5 * float((on_tool + state.last_tool_force) @ np.asarray(tool.velocity)) * step
    warming = element_mean(
        thermal_strains(problem, mesh, fields.temperature)
        - thermal_strains(problem, mesh, fields.momentum_temperature),
        mesh.cells,
    )
    pressure = element_mean(motion.pressure, mesh.cells)
    reactions = _support_forces(problem, mesh, fields, motion)
    ledger = state.ledger.plus(
        tool_work=work,
        plastic=total_power * step,
        friction=friction,
        thermoelastic=float(np.sum(pressure * warming * areas)),
        contact=spring - springs,
        boundary_work=_boundary_work(problem, state, mesh, motion, reactions, step),
        stabilisation=_stabilisation_work(problem, mesh, fields, motion, pressure, warming, areas),
        heat_generated=heating.generated,
        heat_supplied=heating.supplied,
        heat_to_tool=heating.to_tool,
        heat_to_holder=heating.to_holder,
    )
    record = StepRecord(
        tool_force=force,
        self_contact_length=sum(float(each.lengths.sum()) for each in motion.self_contact),
        self_contact_force=sum(float(each.normal_force.sum()) for each in motion.self_contact),
        inserted=sum(len(each.inserted_cells) for each in remesh_map),
        removed=sum(each.removed for each in remesh_map),
        changed=sum(int((~each.unchanged).sum()) for each in remesh_map),
        outside=sum(each.outside for each in remesh_map),
        newton_iterations=motion.iterations,
        plastic_power=total_power,
        flow_change=flow_change(
            fields.multiplier_rate, plastic.multiplier_rate, plastic.flow_stress * areas / motion.volume_ratio
        ),
        reactions=reactions,
    )
    return record, ledger


def remeshing_amounts(
    problem: Problem,
    state: State,
    mesh: Mesh,
    fields: Fields,
    remesh_map: tuple[RemeshMap, ...],
    springs: float,
) -> dict[str, float]:
    """What the transfer changed: stored energy, penalty energy (now ``springs``), heat content, area and counts."""
    if not remesh_map:
        return {}
    energy = energies.elastic_energy(problem, mesh, fields)
    heat = energies.heat_content(problem, mesh, fields)
    return {
        "remeshing": energy
        + springs
        - energies.elastic_energy(problem, state.mesh, state.fields)
        - energies.contact_energy(problem, state.mesh, state.clock.time),
        "heat_remeshing": heat - energies.heat_content(problem, state.mesh, state.fields),
        "area_drift": sum(each.area_after - each.area_before for each in remesh_map),
        "inserted": sum(len(each.inserted_cells) for each in remesh_map),
        "removed": sum(each.removed for each in remesh_map),
        "outside": sum(each.outside for each in remesh_map),
    }


def _support_forces(problem: Problem, mesh: Mesh, fields: Fields, motion: Motion) -> Array:
    """Forces and moments of the supports, see :class:`StepRecord`; shape (motions, 3)."""
    supports = np.zeros((len(problem.motions), 3))
    for support, each in zip(supports, problem.motions, strict=True):
        particles = motion_particles(problem, mesh, each)
        shape = each.shape(mesh.points[particles] - fields.displacement[particles])
        support[:] = motion.reactions[particles, each.axis.value] @ shape
    return supports


def _stabilisation_work(
    problem: Problem,
    mesh: Mesh,
    fields: Fields,
    motion: Motion,
    pressure: Array,
    warming: Array,
    areas: Array,
) -> float:
    """Work of the pressure on volume that it does not explain, which the pressure projection took (mJ/mm).

    int p (d ln J - dp / kappa - de) dV: not a sink of the ledger but what explains a part of its error.
    """
    before = element_mean(fields.pressure, mesh.cells)
    unexplained = np.log(motion.volume_ratio / fields.volume_ratio)
    unexplained -= (pressure - before) / moduli(problem, mesh)[:, 1] + warming
    return float(np.sum(0.5 * (before + pressure) * unexplained * areas))


def _boundary_work(
    problem: Problem, state: State, mesh: Mesh, motion: Motion, reactions: Array, step: float
) -> float:
    """Work of prescribed motions, but a tool's, and of loads over the step (mJ/mm), by the trapezoidal rule."""
    start = state.clock.time
    work = 0.0
    driven = {
        part
        for tool in problem.tool
        for body in problem.bodies
        if body.name == tool.body
        for part in body.parts
    }
    for each, before, after in zip(problem.motions, state.last_reactions, reactions, strict=True):
        if each.part not in driven:
            work += 0.5 * float((before + after) @ each.increment(start, start + step))
    at_start = nodal_loads(problem, mesh, np.zeros_like(motion.displacement), start)
    at_end = nodal_loads(problem, mesh, motion.displacement, start + step)
    return work + 0.5 * float(np.sum((at_start + at_end) * motion.displacement))
