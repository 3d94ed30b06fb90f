"""Small laminae for tests of the lattice model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.peridynamics.lamina import Lamina
from pfemcut.peridynamics.problem import LaminaProblem

CARBON = Lamina("carbon/epoxy", 120e3, 8600.0, 1.57e-9, 0.28, 0.8, 90.0)


def table(angle: float = 0.0, **changes: dict[str, Any] | list[Any]) -> dict[str, Any]:
    """A case file's table of a small plate; ``changes`` replace keys of its tables, or tables in numbers."""
    given: dict[str, Any] = {
        "problem": "lamina",
        "lamina": {"length": 24.0, "width": 16.0, "fibre_angle": angle, "material": "carbon_epoxy"},
        "lattice": {"spacing": 1.0, "batch": 50},
        "pull": {"speed": 1000.0, "elongation": 0.1},
    }
    for name, change in changes.items():
        given[name] = {**given.get(name, {}), **change} if isinstance(change, dict) else change
    return given


def plate(angle: float = 0.0, **changes: dict[str, Any] | list[Any]) -> LaminaProblem:
    """The problem of :func:`table`."""
    problem = problem_of(*validated(table(angle, **changes), Path()), Path())
    assert isinstance(problem, LaminaProblem)
    return problem
