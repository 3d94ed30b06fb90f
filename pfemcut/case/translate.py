"""From any validated case to the problem that solvers take."""

from __future__ import annotations

from pathlib import Path

from pfemcut.case.cutting import cutting_problem
from pfemcut.case.general import general_problem
from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.load import AnyCase
from pfemcut.case.particle_count import require_countable
from pfemcut.materials.material import Material
from pfemcut.problem import Problem


def problem_of(case: AnyCase, material: Material, base_directory: Path) -> Problem:
    """The problem of ``case``; files that it names are looked for in ``base_directory``.

    Raises
    ------
    InputError
        If a file can't be used, or the mesh would have more particles than could ever be run.
    """
    if isinstance(case, GeneralCase):
        problem = general_problem(case, material, base_directory)
    else:
        problem = cutting_problem(case, material)
    require_countable(problem)
    return problem
