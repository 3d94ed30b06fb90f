"""The thermal half of a time step: heat of plasticity and friction, conduction on the updated configuration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from meshing.mesh import Mesh, signed_areas
from pfemcut.contact.heat import HeatExchange, coupled, exchange_matrix
from pfemcut.contact.node_to_segment import SurfaceContact
from pfemcut.fem.heat_system import HeatKernels, solve_temperature_increment
from pfemcut.fem.partition import Partition
from pfemcut.materials.enthalpy import specific_enthalpy, temperature_at
from pfemcut.materials.material import Property
from pfemcut.pfem.bodies import densities, over_cells, over_particles
from pfemcut.pfem.body_contact import heat_exchange
from pfemcut.pfem.kinematics import element_mean, lumped, tributary_lengths
from pfemcut.pfem.loads import part_edges, part_particles
from pfemcut.pfem.step_contact import ContactResult
from pfemcut.problem import MovingHeatBand, Problem
from pfemcut.tools.heat_block import HeatBlock

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SOLVES = 5
_ENOUGH = 1e-2  # K, between the linear solution and the temperature of its heat
_SMALL = 1e-6  # K, below which a secant would be round-off


@dataclass(frozen=True)
class Heating:
    """Outcome of the heat equation of one step.

    Attributes
    ----------
    increment
        Temperature increment of the particles (K); (n,).
    generated
        Heat of plasticity and of friction that entered the body (mJ/mm).
    supplied
        Heat through boundaries with prescribed flux or temperature (mJ/mm).
    to_tool
        Heat through the interface into the tool, friction's share apart (mJ/mm).
    to_holder
        Heat from a conducting tool into its holder (mJ/mm).
    tool_temperature
        Of the particles of a conducting tool's block (K); empty without one.
    """

    increment: Array
    generated: float
    supplied: float
    to_tool: float
    to_holder: float
    tool_temperature: Array


def solve_heat(
    problem: Problem,
    kernels: HeatKernels,
    partition: Partition,
    mesh: Mesh,
    temperature: Array,
    volume_ratio: Array,
    plastic_power: Array,
    contact: tuple[ContactResult, ...],
    body_contact: tuple[SurfaceContact, ...],
    self_contact: tuple[SurfaceContact, ...],
    blocks: tuple[HeatBlock, ...],
    tool_temperature: Array,
    time: float,
    step: float,
) -> Heating:
    """One backward-Euler step on ``mesh``, which has its particles at their new positions.

    1. Conductivity k at the temperature of the start of the step, and specific heat c likewise, at the particles.
    2. Solve the linear system for the temperature increment.
    3. Each particle takes the temperature whose enthalpy, the integral of c, has grown by the heat that the solution
       brings it: no heat is lost, whatever the step.
    4. Where that differs from the increment by more than 0.01 K, solve again with the secant of the enthalpy as c.

    Steps 3 and 4 have nothing to do where c is constant.

    Parameters
    ----------
    temperature
        At the start of the step (K); (n,).
    volume_ratio
        J at the end of the step; (m,).
    plastic_power
        Plastic power per current volume (mW/mm³); (m,).
    contact, body_contact, self_contact
        Contact results, whose friction heats.
    blocks, tool_temperature
        The block of a conducting tool and its temperature at the start of the step (K), or none and empty.
    time, step
        Time at the end of the step, and its length (s).
    """
    count = len(mesh.points)
    element_temperature = element_mean(temperature, mesh.cells)
    areas = signed_areas(mesh.points, mesh.cells)
    mass = lumped(densities(problem, mesh) * areas / volume_ratio, mesh.cells, count)
    sources = lumped(
        over_cells(problem, mesh, lambda body, c: body.material.taylor_quinney * plastic_power[c]) * areas,
        mesh.cells,
        count,
    )
    for each in contact:
        sources[each.particles] += problem.contact.heat_partition * each.forces.friction_power
    for pair, found in zip(problem.pairs, body_contact, strict=True):
        # To the slave its share, to the master the rest (eqs. 34, 35 with halves).
        to_slave = pair.law.heat_partition
        share = np.where(found.shape > 0.0, to_slave, to_slave - 1.0)
        np.add.at(sources, found.particles, share * found.shape * found.friction_power[:, None])
    for found in self_contact:
        # Both sides are of one material.
        np.add.at(sources, found.particles, 0.5 * np.abs(found.shape) * found.friction_power[:, None])
    touching = _touching(problem, contact)
    flux, exchange = _boundary_flux(problem, mesh, temperature, time)

    fixed = np.zeros(count, dtype=bool)
    fixed_increment = np.zeros(count)
    for condition in problem.temperatures:
        particles = part_particles(problem, mesh, condition.part)
        fixed[particles] = True
        fixed_increment[particles] = condition.temperature(time) - temperature[particles]
    places = [
        block.places(tool.at(time).arc_length(mesh.points[touching.particles]))
        for tool, block in zip(problem.tool, blocks, strict=False)
    ]
    surface_power = [at.T @ touching.tool_power for at in places]
    tool = _interface(problem, touching, fixed, blocks, places, surface_power, tool_temperature, step)
    laws = [pair.law for pair in problem.pairs] + [rule.law for rule in problem.self_contact]
    between = heat_exchange(list(zip(laws, (*body_contact, *self_contact), strict=True)), fixed)
    drawn = np.zeros(count)
    for exchange_with in (tool, between):
        drawn[exchange_with.particles] += exchange_with.taken(temperature)
    coupling = coupled((tool, between))
    conductivity = over_cells(
        problem, mesh, lambda body, c: body.material.conductivity(element_temperature[c])
    )

    def by_capacity(of: Callable[..., Array], *values: Array) -> Array:
        """``of`` the specific heat of each body and the values of its particles."""
        return over_particles(
            problem, mesh, lambda body, p: of(body.material.capacity, *(each[p] for each in values))
        )

    specific_heat = by_capacity(lambda capacity, at: capacity(at), temperature)
    for _ in range(_SOLVES):
        increment = solve_temperature_increment(
            kernels,
            partition,
            mesh.points,
            temperature,
            mass * specific_heat / step,
            conductivity,
            sources + flux - drawn,
            exchange,
            coupling,
            fixed,
            fixed_increment,
        )
        warming = by_capacity(_warming, temperature, increment, specific_heat * increment)
        warming[fixed] = fixed_increment[fixed]
        if np.max(np.abs(warming - increment)) <= _ENOUGH:
            break
        specific_heat = by_capacity(_secant, temperature, warming)
    stored = float(mass @ by_capacity(_gain, temperature, warming))
    generated = float(sources.sum()) * step
    through = float(flux.sum() - exchange @ increment) * step
    taken = tool.taken(temperature + increment)
    to_tool = float(taken.sum()) * step
    supplied = stored - generated + to_tool if fixed.any() else through
    after, to_holder = tool_temperature, 0.0
    for block, at, power in zip(blocks, places, surface_power, strict=True):
        after, to_holder = block.advanced(tool_temperature, power + at.T @ taken, step)
    return Heating(warming, generated, supplied, to_tool, to_holder * step, after)


@dataclass(frozen=True)
class _Touching:
    """Particles in contact: their conductance (mW/(mm K)) and the friction heat that enters the tool (mW/mm); (k,)."""

    particles: IntArray
    conductance: Array
    tool_power: Array


def _touching(problem: Problem, contact: tuple[ContactResult, ...]) -> _Touching:
    law = problem.contact
    for each in contact:
        forces = each.forces
        loaded = forces.normal_force > 0.0
        pressure = law.penalty * np.maximum(-forces.gap[loaded], 0.0)
        length = forces.normal_force[loaded] / pressure
        return _Touching(
            each.particles[loaded],
            law.conductance(pressure) * length,
            (1.0 - law.heat_partition) * forces.friction_power[loaded],
        )
    return _Touching(np.empty(0, dtype=np.int64), np.zeros(0), np.zeros(0))


def _interface(
    problem: Problem,
    touching: _Touching,
    fixed: NDArray[np.bool_],
    blocks: tuple[HeatBlock, ...],
    places: list[csr_matrix],
    surface_power: list[Array],
    tool_temperature: Array,
    step: float,
) -> HeatExchange:
    """Exchange with the tool at its given temperature, or with its block, whose warming in the step is eliminated."""
    if not touching.conductance.any() and not blocks:
        return HeatExchange.none()
    # A particle whose temperature is prescribed has no use for the tool's.
    conductance = np.where(fixed[touching.particles], 0.0, touching.conductance)
    count = len(conductance)
    response = np.zeros((count, count))
    ambient = np.full(count, problem.tool[0].temperature)
    for block, at, power in zip(blocks, places, surface_power, strict=True):
        # As the block would be at the end of the step if nothing but friction heated it.
        alone, _ = block.advanced(tool_temperature, power, step)
        response = block.response(at, step)
        ambient = np.asarray(at @ alone[block.surface])
    return HeatExchange(touching.particles, exchange_matrix(conductance, response), ambient)


def _warming(capacity: Property, temperature: Array, increment: Array, received: Array) -> Array:
    """Temperature increment (K) for the heat ``received`` per mass (mm²/s²); ``increment`` if c is constant; (n,)."""
    if len(capacity.temperatures) == 1:
        return increment.copy()
    start = capacity.temperatures[0]
    enthalpy = specific_enthalpy(capacity, temperature, start) + received
    return temperature_at(capacity, enthalpy, start, temperature + increment) - temperature


def _gain(capacity: Property, temperature: Array, warming: Array) -> Array:
    """Growth of the specific enthalpy (mm²/s²); (n,)."""
    start = capacity.temperatures[0]
    after = specific_enthalpy(capacity, temperature + warming, start)
    return after - specific_enthalpy(capacity, temperature, start)


def _secant(capacity: Property, temperature: Array, warming: Array) -> Array:
    """Mean specific heat over the warming (mm²/(s² K)); (n,)."""
    large = np.abs(warming) > _SMALL
    secant = _gain(capacity, temperature, warming) / np.where(large, warming, 1.0)
    return np.where(large, secant, capacity(temperature))


def _boundary_flux(problem: Problem, mesh: Mesh, temperature: Array, time: float) -> tuple[Array, Array]:
    """Heat through the boundary at the temperature of the start of the step, and what a kelvin more takes away.

    Returns
    -------
    power
        mW/mm; (n,).
    exchange
        mW/(mm K); (n,).
    """
    count = len(mesh.points)
    power, exchange = np.zeros(count), np.zeros(count)
    for flux in problem.fluxes:
        edges = part_edges(problem, mesh, flux.part)
        power += flux.flux(time) * tributary_lengths(mesh.points, edges, count)
    for band in problem.heat_bands:
        edges = part_edges(problem, mesh, band.part)
        power += band.flux * _band_lengths(mesh.points, edges, band, time)
    for convection in problem.convections:
        edges = part_edges(problem, mesh, convection.part)
        coefficient = convection.coefficient * tributary_lengths(mesh.points, edges, count)
        power += coefficient * (convection.ambient(time) - temperature)
        exchange += coefficient
    return power, exchange


def _band_lengths(points: Array, edges: IntArray, band: MovingHeatBand, time: float) -> Array:
    """Length of each edge inside the band, given to its two particles as a linear field would have it; (n,)."""
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    shift = band.velocity * time
    run = end[:, 0] - start[:, 0]
    level = np.abs(run) < 1e-12
    slope = np.where(level, 1.0, run)
    s1 = (band.lower + shift - start[:, 0]) / slope
    s2 = (band.upper + shift - start[:, 0]) / slope
    inside = (start[:, 0] > band.lower + shift) & (start[:, 0] < band.upper + shift)
    low = np.where(level, 0.0, np.clip(np.minimum(s1, s2), 0.0, 1.0))
    high = np.where(level, inside.astype(float), np.clip(np.maximum(s1, s2), 0.0, 1.0))
    length = np.hypot(*(end - start).T)
    to_end = 0.5 * (high**2 - low**2) * length
    to_start = (high - low) * length - to_end
    total = np.bincount(edges[:, 0], to_start, minlength=len(points))
    total = total + np.bincount(edges[:, 1], to_end, minlength=len(points))
    return total.astype(np.float64, copy=False)
