"""The thermal half of a time step: heat of plasticity and friction, conduction on the updated configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.contact.node_to_segment import SurfaceContact
from pfemcut.fem.distribution import DistributedMesh
from pfemcut.fem.heat_system import HeatKernels, solve_temperature_increment
from pfemcut.pfem.bodies import over_cells
from pfemcut.pfem.kinematics import element_mean, lumped, tributary_lengths
from pfemcut.pfem.loads import part_edges, part_particles
from pfemcut.pfem.mechanics import ContactResult
from pfemcut.problem import MovingHeatBand, Problem

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


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
    """

    increment: Array
    generated: float
    supplied: float


def heat_capacity(problem: Problem, mesh: Mesh, temperature: Array, volume_ratio: Array) -> Array:
    """Heat capacity per current volume rho_0 c / J of the elements (mJ/(mm³ K)); (m,)."""
    at = element_mean(temperature, mesh.cells)
    return (
        over_cells(problem, mesh, lambda body, c: body.material.density * body.material.capacity(at[c]))
        / volume_ratio
    )


def solve_heat(
    problem: Problem,
    kernels: HeatKernels,
    distributed: DistributedMesh,
    mesh: Mesh,
    temperature: Array,
    volume_ratio: Array,
    plastic_power: Array,
    contact: tuple[ContactResult, ...],
    body_contact: tuple[SurfaceContact, ...],
    time: float,
    step: float,
) -> Heating:
    """One backward-Euler step on ``mesh``, which has its particles at their new positions.

    Parameters
    ----------
    temperature
        At the start of the step (K); (n,).
    volume_ratio
        J at the end of the step; (m,).
    plastic_power
        Plastic power per current volume (mW/mm³); (m,).
    contact, body_contact
        Contact results, whose friction heats.
    time, step
        Time at the end of the step, and its length (s).
    """
    count = len(mesh.points)
    at = element_mean(temperature, mesh.cells)
    areas = signed_areas(mesh.points, mesh.cells)
    capacity = heat_capacity(problem, mesh, temperature, volume_ratio) / step
    lumped_capacity = lumped(areas * capacity, mesh.cells, count)
    sources = lumped(
        over_cells(problem, mesh, lambda body, c: body.material.taylor_quinney * plastic_power[c]) * areas,
        mesh.cells,
        count,
    )
    for each in contact:
        sources[each.particles] += problem.contact.heat_partition * each.forces.friction_power
    for found in body_contact:
        # To the slave its share, to the master the rest (eqs. 34, 35 with halves).
        share = np.where(found.shape > 0.0, problem.contact.heat_partition, problem.contact.heat_partition - 1.0)
        np.add.at(sources, found.particles, share * found.shape * found.friction_power[:, None])
    flux, exchange = _boundary_flux(problem, mesh, temperature, time)

    fixed = np.zeros(count, dtype=bool)
    fixed_increment = np.zeros(count)
    for condition in problem.temperatures:
        particles = part_particles(problem, mesh, condition.part)
        fixed[particles] = True
        fixed_increment[particles] = condition.temperature(time) - temperature[particles]
    increment = solve_temperature_increment(
        kernels,
        distributed,
        temperature,
        capacity,
        lumped_capacity,
        over_cells(problem, mesh, lambda body, c: body.material.conductivity(at[c])),
        sources + flux,
        exchange,
        fixed,
        fixed_increment,
    )
    stored = float(lumped_capacity @ increment) * step
    generated = float(sources.sum()) * step
    through = float(flux.sum() - exchange @ increment) * step
    supplied = stored - generated if fixed.any() else through
    return Heating(increment, generated, supplied)


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
