"""The thermal half of a time step: heat of plasticity and friction, conduction on the updated configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.fem.distribution import DistributedMesh
from pfemcut.fem.heat_system import HeatKernels, solve_temperature_increment
from pfemcut.pfem.kinematics import element_mean, lumped, tributary_lengths
from pfemcut.pfem.mechanics import ContactResult, part_particles
from pfemcut.problem import Problem

Array = NDArray[np.float64]


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
    material = problem.body.material
    return material.density * material.capacity(element_mean(temperature, mesh.cells)) / volume_ratio


def solve_heat(
    problem: Problem,
    kernels: HeatKernels,
    distributed: DistributedMesh,
    mesh: Mesh,
    temperature: Array,
    volume_ratio: Array,
    plastic_power: Array,
    contact: tuple[ContactResult, ...],
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
    contact
        Contact results, whose friction heats.
    step
        s.
    """
    material = problem.body.material
    count = len(mesh.points)
    areas = signed_areas(mesh.points, mesh.cells)
    capacity = heat_capacity(problem, mesh, temperature, volume_ratio) / step
    lumped_capacity = lumped(areas * capacity, mesh.cells, count)
    sources = lumped(material.taylor_quinney * plastic_power * areas, mesh.cells, count)
    for each in contact:
        sources[each.particles] += problem.contact.heat_partition * each.forces.friction_power
    flux = _boundary_flux(problem, mesh)

    fixed = np.zeros(count, dtype=bool)
    fixed_increment = np.zeros(count)
    for condition in problem.temperatures:
        particles = part_particles(problem, mesh, condition.part)
        fixed[particles] = True
        fixed_increment[particles] = condition.temperature - temperature[particles]
    increment = solve_temperature_increment(
        kernels,
        distributed,
        temperature,
        capacity,
        lumped_capacity,
        material.conductivity(element_mean(temperature, mesh.cells)),
        sources + flux,
        fixed,
        fixed_increment,
    )
    stored = float(lumped_capacity @ increment) * step
    generated = float(sources.sum()) * step
    supplied = stored - generated if fixed.any() else float(flux.sum()) * step
    return Heating(increment, generated, supplied)


def _boundary_flux(problem: Problem, mesh: Mesh) -> Array:
    """Prescribed heat flux integrated to particles (mW/mm); (n,)."""
    power = np.zeros(len(mesh.points))
    for condition in problem.fluxes:
        numbers = [i for i, name in enumerate(problem.body.parts) if name == condition.part]
        edges = mesh.boundary.edges[np.isin(mesh.boundary.parts, numbers)]
        power += condition.flux * tributary_lengths(mesh.points, edges, len(power))
    return power
