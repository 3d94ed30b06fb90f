"""Stored energies, heat content and mass of a state, for the ledgers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.contact.penalty import facing_lengths
from pfemcut.materials.enthalpy import specific_enthalpy
from pfemcut.materials.return_mapping import deviatoric_energy
from pfemcut.pfem.kinematics import element_mean, lumped
from pfemcut.pfem.state import Fields
from pfemcut.problem import Problem

Array = NDArray[np.float64]


def elastic_energy(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Stored elastic energy, int (W_dev + p²/(2 kappa)) / J dV (mJ/mm)."""
    material = problem.body.material
    pressure = element_mean(fields.pressure, mesh.cells)
    density = deviatoric_energy(fields.b_elastic, material.shear_modulus)
    density += pressure**2 / (2.0 * material.bulk_modulus)
    return float(np.sum(density / fields.volume_ratio * signed_areas(mesh.points, mesh.cells)))


def mass(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Mass of the body per mm of width, int rho_0 / J dV (tonne/mm)."""
    material = problem.body.material
    volume = signed_areas(mesh.points, mesh.cells) / fields.volume_ratio
    return material.density * float(volume.sum())


def heat_content(problem: Problem, mesh: Mesh, fields: Fields) -> float:
    """Heat above the initial temperature, int rho_0 / J (int c dtheta) dV with lumped capacity (mJ/mm)."""
    material = problem.body.material
    volume = signed_areas(mesh.points, mesh.cells) / fields.volume_ratio
    nodal_mass = lumped(material.density * volume, mesh.cells, len(mesh.points))
    enthalpy = specific_enthalpy(material.capacity, fields.temperature, problem.body.temperature)
    return float(np.sum(nodal_mass * enthalpy))


def kinetic_energy(problem: Problem, mesh: Mesh, fields: Fields, step: float) -> float:
    """Kinetic energy with lumped mass (mJ/mm); ``step`` is the length of the last step (s)."""
    material = problem.body.material
    volume = signed_areas(mesh.points, mesh.cells) / fields.volume_ratio
    nodal_mass = lumped(material.density * volume, mesh.cells, len(mesh.points))
    return 0.5 * float(np.sum(nodal_mass[:, None] * (fields.last_displacement / step) ** 2))


def contact_energy(problem: Problem, mesh: Mesh, time: float) -> float:
    """Energy stored in the penalty springs (mJ/mm)."""
    particles = np.unique(mesh.boundary.particles)
    positions = mesh.points[particles]
    total = 0.0
    for tool in problem.tool:
        shape = tool.at(time)
        lengths = facing_lengths(shape, mesh.points, mesh.boundary.edges)[particles]
        depth = np.maximum(-shape.closest(positions).gap, 0.0)
        total += 0.5 * problem.contact.penalty * float(lengths @ depth**2)
    return total
