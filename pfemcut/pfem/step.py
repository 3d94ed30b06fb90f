"""One time step of the PFEM, which reads like the method (paper, Boxes 1, 3 and 4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from meshing.remesh import RemeshMap
from pfemcut.allocator import keep_freed_memory
from pfemcut.fem.heat_system import HeatKernels, HeatSolveFailed
from pfemcut.fem.momentum_system import MomentumKernels
from pfemcut.fem.partition import Partition
from pfemcut.materials.return_mapping import ReturnMappingFailed
from pfemcut.method import RunStopped
from pfemcut.pfem import energies
from pfemcut.pfem.bodies import moduli, thermal_strains
from pfemcut.pfem.body_contact import deformable_tools, force_within
from pfemcut.pfem.kinematics import element_mean
from pfemcut.pfem.loads import nodal_loads, part_particles
from pfemcut.pfem.mechanics import Motion, PlasticUpdate, solve_motion, update_plasticity
from pfemcut.pfem.newton import StepFailed
from pfemcut.pfem.particle_step import first_iterate, particle_step
from pfemcut.pfem.state import Clock, Fields, Ledger, State
from pfemcut.pfem.step_contact import known_sliding_speed
from pfemcut.pfem.step_size import flow_change, next_step
from pfemcut.pfem.thermal import Heating, solve_heat
from pfemcut.problem import HeatSource, Integrator, Problem
from pfemcut.timing import Stopwatch
from pfemcut.tools.heat_block import HeatBlock

Array = NDArray[np.float64]

PHASES = (
    "particles",
    "transfer",
    "mesh",
    "system",
    "assembly",
    "linear_solve",
    "momentum",
    "plasticity",
    "heat",
    "ledger",
)
_STEADFAST = 3  # times that a step is halved before its multiplier is extrapolated instead
_ROOT_2_3 = np.sqrt(2.0 / 3.0)


class Kernels:
    """Compiled forms of a run, and the block of a tool that conducts heat."""

    def __init__(self, comm: MPI.Comm, heat_blocks: tuple[HeatBlock, ...] = ()):
        keep_freed_memory()
        self.comm = comm
        self.heat_blocks = heat_blocks
        self.momentum = MomentumKernels(comm)
        self.heat = HeatKernels(comm)


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


def advance(problem: Problem, kernels: Kernels, state: State, watch: Stopwatch) -> tuple[State, StepRecord]:
    """Advance ``state`` by one time step.

    Raises
    ------
    RunStopped
        If even the smallest step fails.
    CutEnded
        If the body touches itself.
    """
    # Box 1: the particles are where the last step moved them; remove, insert, triangulate, transfer.
    mesh, fields, remesh_map = particle_step(problem, state, watch)
    wished = step = _step_length(problem, state.clock)
    cuts = 0
    with watch.phase("mesh"):
        partition = Partition(kernels.comm, mesh.points, mesh.cells)
    while True:
        # Box 4, steps 1 and 2: contact search and momentum.
        try:
            with watch.phase("momentum"):
                motion = solve_motion(
                    problem,
                    kernels.momentum,
                    partition,
                    mesh,
                    fields,
                    first_iterate(problem, state, mesh, fields, step, steady=cuts == 0),
                    # Some elements alternate between yielding and not whatever the step: one step without asking them.
                    integrator=problem.time.integrator if cuts < _STEADFAST else Integrator.IMPL_EX,
                    start_time=state.clock.time,
                    step=step,
                    last_step=state.clock.last_dt,
                    watch=watch,
                )
            # Box 4, step 4: implicit update of the internal variables, at the temperature of the start of the step.
            with watch.phase("plasticity"):
                plastic = update_plasticity(problem, mesh, fields, motion, step)
            break
        except (StepFailed, ReturnMappingFailed) as failure:
            step, cuts = 0.5 * step, cuts + 1
            if step < problem.time.smallest_step_fraction * problem.time.step:
                raise RunStopped(_why(state, mesh, fields, step, failure)) from failure
    # Box 4, step 3: heat on the updated configuration.
    with watch.phase("heat"):
        moved = replace(mesh, points=mesh.points + motion.displacement)
        power = _plastic_power(motion, plastic, step)
        try:
            heating = solve_heat(
                problem,
                kernels.heat,
                partition,
                moved,
                fields.temperature,
                motion.volume_ratio,
                _heating_power(problem, motion, plastic, power, step),
                motion.contact,
                motion.body_contact,
                motion.self_contact,
                kernels.heat_blocks,
                state.tool_temperature,
                state.clock.time + step,
                step,
            )
        except HeatSolveFailed as failure:
            raise RunStopped(_why(state, mesh, fields, step, failure)) from failure
    with watch.phase("ledger"):
        new_fields = Fields(
            temperature=fields.temperature + heating.increment,
            momentum_temperature=fields.temperature,
            pressure=motion.pressure,
            displacement=fields.displacement + motion.displacement,
            last_displacement=motion.displacement,
            sliding_speed=known_sliding_speed(problem, fields.sliding_speed, motion.displacement, step),
            b_elastic=plastic.b_elastic,
            volume_ratio=motion.volume_ratio,
            eqps=plastic.eqps,
            multiplier_rate=plastic.multiplier_rate,
            plastic_power=power,
        )
        springs = energies.contact_energy(problem, mesh, state.clock.time)
        record, ledger = _record(
            problem, state, mesh, fields, moved, motion, plastic, power, heating, remesh_map, springs, step
        )
        ledger = ledger.plus(
            step_cuts=cuts,
            extrapolated_steps=int(cuts >= _STEADFAST),
            **_remeshing_amounts(problem, state, mesh, fields, remesh_map, springs),
        )
    clock = Clock(
        step=state.clock.step + 1,
        time=state.clock.time + step,
        last_dt=step,
        # A step shortened only to end on time does not shorten those after a resumption.
        next_dt=(
            state.clock.next_dt
            if wished < state.clock.next_dt
            else next_step(problem.time, step, record.flow_change, motion.iterations, problem.newton)
        ),
    )
    new_state = replace(
        state,
        mesh=moved,
        fields=new_fields,
        clock=clock,
        ledger=ledger,
        last_tool_force=record.tool_force,
        last_reactions=record.reactions,
        tool_temperature=heating.tool_temperature,
    )
    return new_state, record


def _step_length(problem: Problem, clock: Clock) -> float:
    """The wished step, or what lies before the end in one or two equal steps: never a tiny last one.

    Raises
    ------
    RunStopped
        If the end is reached already.
    """
    remaining = problem.time.end - clock.time
    if remaining <= 0.0:
        raise RunStopped(f"step {clock.step + 1} would begin at the end of the run, t = {clock.time:.6g} s")
    if remaining <= clock.next_dt * (1.0 + 1e-9):
        return remaining
    return min(clock.next_dt, 0.5 * remaining)


def _why(state: State, mesh: Mesh, fields: Fields, step: float, failure: Exception) -> str:
    speed = np.hypot(*(fields.last_displacement / state.clock.last_dt).T)
    x, y = mesh.points[int(np.argmax(speed))]
    return (
        f"step {state.clock.step + 1} at t = {state.clock.time:.6g} s failed down to dt = {step:.3g} s: {failure}; "
        f"the fastest particle is at ({x:.4f}, {y:.4f}) mm with {speed.max():.4g} mm/s"
    )


def _plastic_power(motion: Motion, plastic: PlasticUpdate, step: float) -> Array:
    """Plastic power of the implicit state per current volume (mW/mm³); (m,)."""
    return plastic.flow_stress * plastic.eqps_increment / (motion.volume_ratio * step)


def _heating_power(
    problem: Problem, motion: Motion, plastic: PlasticUpdate, power: Array, step: float
) -> Array:
    """Plastic power that heats: of the implicit multiplier, or of the extrapolated one as in the paper's Box 4."""
    if problem.time.heat_source is HeatSource.IMPLICIT:
        return power
    return plastic.flow_stress * _ROOT_2_3 * motion.multiplier / (motion.volume_ratio * step)


def _record(
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


def _support_forces(problem: Problem, mesh: Mesh, fields: Fields, motion: Motion) -> Array:
    """Forces and moments of the supports, see :class:`StepRecord`; shape (motions, 3)."""
    supports = np.zeros((len(problem.motions), 3))
    for support, each in zip(supports, problem.motions, strict=True):
        particles = part_particles(problem, mesh, each.part)
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


def _remeshing_amounts(
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
