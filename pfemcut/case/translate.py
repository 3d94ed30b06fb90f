"""From any validated case to the problem that solvers take."""

from __future__ import annotations

from pathlib import Path

from pfemcut.any_problem import AnyProblem
from pfemcut.case.cutting import cutting_problem
from pfemcut.case.general import general_problem
from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.lamina import lamina_problem
from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.load import AnyCase, AnyMaterial, solid
from pfemcut.case.particle_count import require_countable
from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.case.solids import cutting_particles, solids_problem
from pfemcut.materials.material import Material
from pfemcut.problem import Problem


def problem_of(case: AnyCase, material: AnyMaterial, base_directory: Path) -> AnyProblem:
    """The problem of ``case``; files that it names are looked for in ``base_directory``.

    Raises
    ------
    InputError
        If a file can't be used, or the mesh would have more particles than could ever be run.
    """
    if isinstance(case, LaminaCase):
        return lamina_problem(case)
    if isinstance(case, SolidsCase):
        return solids_problem(case, solid(material), base_directory)
    if isinstance(case, Case) and case.method != "pfem":
        return cutting_particles(case, solid(material))
    return meshed_problem_of(case, solid(material), base_directory)


def meshed_problem_of(case: Case | GeneralCase, material: Material, base_directory: Path) -> Problem:
    """The problem of a case for the PFEM; see :func:`problem_of`."""
    if isinstance(case, GeneralCase):
        problem = general_problem(case, material, base_directory)
    else:
        problem = cutting_problem(case, material)
    require_countable(problem)
    return problem
