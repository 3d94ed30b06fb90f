"""A batch of time steps of the lattice, and its energies and momentum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import RunStopped
from pfemcut.particles.state import Clock
from pfemcut.peridynamics.bonds import FAMILIES
from pfemcut.peridynamics.kernels import run_steps, stored_energy
from pfemcut.peridynamics.problem import LaminaProblem
from pfemcut.peridynamics.state import State, Totals

Array = NDArray[np.float64]

GAUGE = 0.25
"""The strain is measured over the sites that are not farther than this part of the length from the middle."""


def initial_state(problem: LaminaProblem) -> State:
    """The state at time zero: no strain, and velocities of a uniform strain rate."""
    none = np.zeros_like(problem.sites)
    return State(
        displacement=none,
        velocity=problem.start_velocity,
        force=none,
        broken_at=np.where(problem.bonds.cut, 0.0, np.inf),
        energy=none,
        clock=Clock(0, 0, 0, 0.0, problem.dt),
        totals=Totals(),
        impulse=np.zeros(2),
    )


def advance(problem: LaminaProblem, state: State) -> State:
    """The state after one batch of time steps, or fewer at the end.

    Raises
    ------
    RunStopped
        If sites have no finite places any more.
    """
    dt, clock = problem.dt, state.clock
    steps = min(problem.time.batch, round(problem.time.end / dt) - clock.steps)
    u, v, force = state.displacement.copy(), state.velocity.copy(), state.force.copy()
    broken_at, energy = state.broken_at.copy(), state.energy.copy()
    mean, work = run_steps(
        steps,
        dt,
        clock.time,
        compiled_bonds(problem),
        (family_stiffness(problem), problem.spacing, problem.limits, problem.site_mass, problem.dashpot),
        (problem.free, np.flatnonzero(problem.grip < 0), np.flatnonzero(problem.grip > 0), problem.grip_velocity),
        problem.weak,
        u,
        v,
        force,
        alive(state),
        broken_at,
        np.zeros(len(broken_at), dtype=np.uint8),
        energy,
    )  # fmt: skip
    if not np.isfinite(u).all():
        raise RunStopped(
            f"sites have no finite places after {clock.time:.4g} s: a smaller [lattice] courant may help"
        )
    held = np.array([1.0, 0.0 if problem.pull.sliding else 1.0])
    now = replace(
        clock, batches=clock.batches + 1, steps=clock.steps + steps, time=(clock.steps + steps) * dt
    )
    after = State(u, v, force, broken_at, energy, now, state.totals, state.impulse)
    return replace(
        after,
        impulse=state.impulse - steps * dt * held * mean.sum(axis=0),
        totals=_totals(problem, state, after, 0.5 * (mean[0, 0] - mean[1, 0]), work),
    )


def _totals(problem: LaminaProblem, before: State, after: State, load: float, work: float) -> Totals:
    """Sums after a batch in which the grips felt ``load`` (N) on average and did ``work`` (mJ)."""
    totals = replace(before.totals, grip_work=before.totals.grip_work + work, load=load)
    if load > totals.peak_load:
        totals = replace(
            totals, peak_load=load, peak_elongation=0.5 * (elongation(problem, before) + elongation(problem, after))
        )  # fmt: skip
    if broken(problem, after).any():
        return totals
    strain = 0.5 * (gauge_strain(problem, before) + gauge_strain(problem, after))
    return replace(
        totals,
        elastic_work=totals.elastic_work + stress(problem, load) * strain,
        elastic_square=totals.elastic_square + strain**2,
    )


def compiled_bonds(problem: LaminaProblem) -> tuple[NDArray[np.generic], ...]:
    """The bonds as the kernels take them; short integers, since memory is what the kernels wait for."""
    rows, bonds = problem.bonds.neighbours, problem.bonds
    short = (each.astype(np.int32) for each in (rows.offsets, rows.indices, rows.reverse))
    return (*short, bonds.family, problem.spacing * bonds.direction)


def alive(state: State) -> NDArray[np.uint8]:
    """1 for entries of whole bonds, else 0; shape (k,)."""
    return np.isinf(state.broken_at).astype(np.uint8)


def family_stiffness(problem: LaminaProblem) -> Array:
    """Stiffness of the families of bonds (N/mm); shape (6,)."""
    fibre = np.arange(FAMILIES) % 3 == 0
    return np.where(fibre, problem.stiffness.fibre, problem.stiffness.matrix)


def elongation(problem: LaminaProblem, state: State) -> float:
    """How much farther the grips are apart (mm)."""
    return problem.pull.speed * state.clock.time


def stress(problem: LaminaProblem, load: float) -> float:
    """``load`` (N) over the plate's section without hole or crack (MPa)."""
    return load / (problem.plate.width * problem.plate.thickness)


def gauge_strain(problem: LaminaProblem, state: State) -> float:
    """Slope of the straight line through the displacements along the pull of the sites in the middle."""
    x = problem.sites[:, 0]
    inside = np.abs(x) <= GAUGE * problem.plate.length
    along = x[inside] - x[inside].mean()
    return float(along @ state.displacement[inside, 0] / (along @ along))


def broken(problem: LaminaProblem, state: State) -> NDArray[np.bool_]:
    """Entries of bonds that broke since the start; shape (k,)."""
    return np.isfinite(state.broken_at) & ~problem.bonds.cut


def elastic_energy(problem: LaminaProblem, state: State) -> float:
    """Energy in the whole bonds (mJ)."""
    return float(
        stored_energy(
            compiled_bonds(problem), family_stiffness(problem), problem.spacing, state.displacement, alive(state)
        ).sum()
    )  # fmt: skip


def kinetic_energy(problem: LaminaProblem, velocity: Array) -> float:
    """Kinetic energy (mJ), with scaled mass."""
    return 0.5 * problem.site_mass * float(np.vdot(velocity, velocity))


def momentum_error(problem: LaminaProblem, state: State) -> float:
    """Momentum less that of the start and the grips' impulse, over mass times the largest speed."""
    missing = problem.site_mass * (state.velocity - problem.start_velocity).sum(axis=0) - state.impulse
    fastest = float(np.sqrt(np.max(np.einsum("na,na->n", state.velocity, state.velocity))))
    scale = problem.site_mass * len(problem.sites) * fastest
    return float(np.linalg.norm(missing)) / scale if scale else 0.0
