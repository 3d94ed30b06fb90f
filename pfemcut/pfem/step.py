"""One time step of the PFEM, which reads like the method (paper, Boxes 1, 3 and 4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from meshing.mesh import Mesh
from pfemcut.allocator import keep_freed_memory
from pfemcut.fem.heat_system import HeatKernels, HeatSolveFailed
from pfemcut.fem.momentum_system import MomentumKernels
from pfemcut.fem.partition import Partition
from pfemcut.materials.return_mapping import ReturnMappingFailed
from pfemcut.method import RunStopped
from pfemcut.pfem import energies
from pfemcut.pfem.chip_cut_off import cut_off_chip
from pfemcut.pfem.mechanics import Motion, PlasticUpdate, solve_motion, update_plasticity
from pfemcut.pfem.newton import StepFailed
from pfemcut.pfem.particle_step import first_iterate, particle_step
from pfemcut.pfem.state import Clock, Fields, State
from pfemcut.pfem.step_contact import known_sliding_speed
from pfemcut.pfem.step_record import StepRecord, recorded_step, remeshing_amounts
from pfemcut.pfem.step_size import next_step
from pfemcut.pfem.thermal import solve_heat
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


def advance(problem: Problem, kernels: Kernels, state: State, watch: Stopwatch) -> tuple[State, StepRecord]:
    """Advance ``state`` by one time step.

    Raises
    ------
    RunStopped
        If even the smallest step fails.
    CutEnded
        If the body touches itself.
    """
    state = cut_off_chip(problem, state)
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
        record, ledger = recorded_step(
            problem, state, mesh, fields, moved, motion, plastic, power, heating, remesh_map, springs, step
        )
        ledger = ledger.plus(
            step_cuts=cuts,
            extrapolated_steps=int(cuts >= _STEADFAST),
            **remeshing_amounts(problem, state, mesh, fields, remesh_map, springs),
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
