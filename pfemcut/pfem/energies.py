"""Stored energies, heat content and mass of a state, for the ledgers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.contact.penalty import facing_lengths
from pfemcut.materials.enthalpy import specific_enthalpy
from pfemcut.materials.return_mapping import deviatoric_energy
from pfemcut.pfem.bodies import densities, moduli, over_particles
from pfemcut.pfem.body_contact import contact_search, deformable_tools, spring_energy
from pfemcut.pfem.kinematics import element_mean, lumped
from pfemcut.pfem.self_contact import self_contact_search
from pfemcut.pfem.state import Fields
from pfemcut.problem import Body, Problem

Array = NDArray[np.float64]


def elastic_energy(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Stored elastic energy, int (W_dev + p²/(2 kappa)) / J dV (mJ/mm)."""
    shear, bulk = moduli(problem, mesh).T
    pressure = element_mean(fields.pressure, mesh.cells)
    density = deviatoric_energy(fields.b_elastic, shear)
    density += pressure**2 / (2.0 * bulk)
    return float(np.sum(density / fields.volume_ratio * signed_areas(mesh.points, mesh.cells)))


def mass(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Mass of the bodies per mm of width, int rho_0 / J dV (tonne/mm)."""
    return float(_element_masses(problem, mesh, fields).sum())


def _element_masses(problem: Problem, mesh: Mesh, fields: Fields) -> Array:
    """Mass of each element (tonne/mm); shape (m,)."""
    return densities(problem, mesh) * signed_areas(mesh.points, mesh.cells) / fields.volume_ratio


def heat_content(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Heat above the initial temperature, int rho_0 / J (int c dtheta) dV with lumped capacity (mJ/mm)."""
    return float(_nodal_heat(problem, mesh, fields).sum())


def tool_heat_content(problem: Problem, mesh: Mesh, fields: Fields) -> dict[str, float]:
    """The heat content (mJ/mm) of a deformable tool as a history column; empty without one."""
    columns = {}
    for _, particles in deformable_tools(problem, mesh):
        columns["tool_heat_content"] = float(_nodal_heat(problem, mesh, fields)[particles].sum())
    return columns


def _nodal_heat(problem: Problem, mesh: Mesh, fields: Fields) -> Array:
    nodal_mass = lumped(_element_masses(problem, mesh, fields), mesh.cells, len(mesh.points))
    enthalpy = over_particles(problem, mesh, lambda body, p: _enthalpy(body, fields.temperature[p]))
    return nodal_mass * enthalpy


def _enthalpy(body: Body, temperature: Array) -> Array:
    """Specific enthalpy above the body's initial temperature (mm²/s²); same shape."""
    return specific_enthalpy(body.material.capacity, temperature, body.temperature)


def kinetic_energy(problem: Problem, mesh: Mesh, fields: Fields, step: float) -> float:
    """Kinetic energy with lumped mass (mJ/mm); ``step`` is the length of the last step (s)."""
    nodal_mass = lumped(_element_masses(problem, mesh, fields), mesh.cells, len(mesh.points))
    return 0.5 * float(np.sum(nodal_mass[:, None] * (fields.last_displacement / step) ** 2))


def contact_energy(problem: Problem, mesh: Mesh, time: float) -> float:
    """Energy stored in the penalty springs (mJ/mm)."""
    particles = np.unique(mesh.boundary.particles)
    positions = mesh.points[particles]
    still = np.zeros_like(mesh.points)
    total = sum(
        spring_energy(each, each.pair.law.penalty, mesh.points)
        for each in contact_search(problem, mesh, still)
    )
    total += sum(
        spring_energy(each, each.rule.law.penalty, mesh.points)
        for each in self_contact_search(problem, mesh, still)
    )
    for tool in problem.rigid_tools:
        shape = tool.at(time)
        lengths = facing_lengths(shape, mesh.points, mesh.boundary.edges)[particles]
        depth = np.maximum(-shape.closest(positions).gap, 0.0)
        total += 0.5 * problem.contact.penalty * float(lengths @ depth**2)
    return total
