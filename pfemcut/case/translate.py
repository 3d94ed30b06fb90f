"""From any validated case to the problem that solvers take."""

from __future__ import annotations

from pathlib import Path

from pfemcut.case.cutting import cutting_problem
from pfemcut.case.general import general_problem
from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.load import AnyCase
from pfemcut.case.particles import SolidsCase
from pfemcut.case.solids import cutting_particles, solids_problem
from pfemcut.materials.material import Material
from pfemcut.particles.problem import ParticleProblem
from pfemcut.problem import Problem


def problem_of(case: AnyCase, material: Material, base_directory: Path) -> Problem | ParticleProblem:
    """The problem of ``case``; files that it names are looked for in ``base_directory``."""
    if isinstance(case, GeneralCase):
        return general_problem(case, material, base_directory)
    if isinstance(case, SolidsCase):
        return solids_problem(case, material, base_directory)
    if case.method != "pfem":
        return cutting_particles(case, material)
    return cutting_problem(case, material)
