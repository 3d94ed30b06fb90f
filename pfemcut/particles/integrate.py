"""One explicit step of particles: the velocity form of the leapfrog (kick, drift, kick), with its ledger.

1. Half a kick: v_h = v_n + dt/2 a_n.
2. Drift: x_{n+1} = x_n + dt v_h.
3. Forces and material at x_{n+1}; what depends on velocity takes v_h.
4. Half a kick: v_{n+1} = v_h + dt/2 a_{n+1}.

It needs one evaluation of forces a step, is of second order and, without damping, symplectic (Verlet 1967; Swope et al.
1982). A predictor-corrector, as in Islam et al. 2019, needs two evaluations for the same order.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.materials.return_mapping import ReturnMappingFailed
from pfemcut.method import RunStopped
from pfemcut.particles.contact import RigidContact, contact_stiffness, rigid_contact
from pfemcut.particles.formulation import ForceModel
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import Clock, Ledger, Loads, Memory, State
from pfemcut.particles.stress import PointState, initial_points

Array = NDArray[np.float64]


def initial_state(model: ForceModel[Memory]) -> State[Memory]:
    """The state at time zero: no stress, and no forces but those of a contact that is there already."""
    problem = model.problem
    count, dimension = problem.points.shape
    none = np.zeros((count, dimension))
    contact = contact_at_start(problem)
    return State(
        positions=problem.points,
        velocities=problem.velocities,
        loads=Loads(none, none, none, none, contact.forces),
        material=material_at_start(problem),
        volume_ratio=np.ones(count),
        memory=model.start(),
        clock=Clock(0, 0, 0, 0.0, 0.0),
        ledger=Ledger(),
        impulse=np.zeros(dimension),
        tool_force=contact.tool_force,
        tool_impulse=np.zeros(dimension),
        contact_energy=contact.energy,
    )


def material_at_start(problem: ParticleProblem) -> PointState:
    """The material at time zero: without stress."""
    return initial_points(problem.by_body([body.temperature for body in problem.bodies]))


def contact_at_start(problem: ParticleProblem) -> RigidContact:
    """Contact at time zero: a lattice that fits its body may lie a little nearer to a wall than half its spacing."""
    velocities = problem.velocities
    dt = stable_step(problem, velocities)
    return rigid_contact(problem, material_at_start(problem), problem.points, velocities, 0.0, dt)


def energy_at_start(problem: ParticleProblem) -> float:
    """Kinetic energy and that of contact at time zero (mJ, or mJ per mm of width)."""
    return kinetic_energy(problem, problem.velocities) + contact_at_start(problem).energy


def stable_step(problem: ParticleProblem, velocities: Array) -> float:
    """Time step (s): the Courant number times the smaller of h / (c + |v|) and 2 / omega of a penalty spring."""
    fastest = float(np.sqrt(np.max(np.einsum("na,na->n", velocities, velocities))))
    limit = problem.smoothing.smoothing_length / (problem.sound_speed + fastest)
    stiffness = contact_stiffness(problem)
    if stiffness > 0.0:
        limit = min(limit, 2.0 * float(np.sqrt(problem.mass.min() / stiffness)))
    return problem.time.courant * limit


def kinetic_energy(problem: ParticleProblem, velocities: Array) -> float:
    """Kinetic energy (mJ, or mJ per mm of width), with scaled mass."""
    return 0.5 * float(problem.mass @ np.einsum("na,na->n", velocities, velocities))


def momentum(problem: ParticleProblem, velocities: Array) -> Array:
    """Momentum (N s, or N s per mm of width); shape (d,)."""
    return problem.mass @ velocities


def advance(model: ForceModel[Memory], state: State[Memory]) -> State[Memory]:
    """The state after one time step.

    Raises
    ------
    RunStopped
        If particles fly off, positions being no numbers any more, or a stress can't be found.
    """
    problem, clock = model.problem, state.clock
    mass = problem.mass[:, None]
    dt = min(stable_step(problem, state.velocities), problem.time.end - clock.time)
    free = ~problem.held

    half = state.velocities + 0.5 * dt * free * state.loads.total / mass
    positions = state.positions + dt * half
    if not np.isfinite(positions).all():
        raise RunStopped(
            f"particles have no finite positions after {clock.time:.4g} s: the step was not stable"
        )
    try:
        found = model.evaluate(state.memory, state.material, positions, half, dt)
    except ReturnMappingFailed as error:
        raise RunStopped(f"{error}, after {clock.time:.4g} s") from error
    contact = rigid_contact(problem, found.material, positions, half, clock.time + dt, dt)
    loads = Loads(found.internal, found.viscous, found.control, found.between, contact.forces)
    velocities = half + 0.5 * dt * free * loads.total / mass

    # With the mean force and the mean velocity, work is the change of kinetic energy to round-off.
    mean_velocity = 0.5 * (state.velocities + velocities)
    mean = [
        0.5 * (before + after)
        for before, after in (
            (state.loads.internal, loads.internal),
            (state.loads.viscous, loads.viscous),
            (state.loads.control, loads.control),
            (state.loads.between, loads.between),
            (state.loads.contact, loads.contact),
        )
    ]
    hold = -(mean[0] + mean[1] + mean[2] + mean[3] + mean[4]) * problem.held
    work = [dt * float(np.vdot(force, mean_velocity)) for force in (*mean, hold)]
    on_tool = 0.5 * (state.tool_force + contact.tool_force)
    drive = sum(float(np.dot(-on_tool, tool.velocity)) for tool in problem.tool)
    friction = dt * float(contact.friction_power.sum())
    heat = dt * problem.contact.heat_partition * contact.friction_power
    return State(
        positions=positions,
        velocities=velocities,
        loads=loads,
        material=found.material.heated(heat / heat_capacity(problem, found.material.temperature)),
        volume_ratio=found.volume_ratio,
        memory=found.memory,
        clock=replace(clock, steps=clock.steps + 1, time=clock.time + dt, dt=dt),
        ledger=state.ledger.plus(
            internal=work[0],
            viscous=work[1],
            control=work[2],
            between=work[3],
            contact=work[4],
            hold=work[5],
            tool=dt * drive,
            plastic=found.plastic_work,
            friction=friction,
        ),
        impulse=state.impulse + dt * (mean[4] + hold).sum(axis=0),
        tool_impulse=state.tool_impulse + dt * on_tool,
        tool_force=contact.tool_force,
        contact_energy=contact.energy,
    )


def heat_capacity(problem: ParticleProblem, temperature: Array) -> Array:
    """Of each particle (mJ/K, or mJ/K per mm of width), with true mass; shape (n,)."""
    specific = np.empty_like(temperature)
    for body, particles in zip(problem.bodies, problem.ranges, strict=True):
        specific[particles] = body.material.capacity(temperature[particles])
    return problem.mass / problem.time.mass_scaling * specific
