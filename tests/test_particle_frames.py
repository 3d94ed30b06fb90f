"""What outputs are shown of particles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from particle_problems import CUT

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.method import ContactView
from pfemcut.methods import factory_of
from pfemcut.particles.frames import tractions_on
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.problem import ParticleProblem
from pfemcut.results.derived.tool_profiles import force_on_tool, tool_loads


@pytest.mark.parametrize("method", ["tlsph", "esph"])
def test_tractions_along_the_tool_add_up_to_its_forces(method: str) -> None:
    """With friction, to 2 %: on the tip the normal at the particles is not that at the stations."""
    problem = problem_of(*validated({**CUT, "method": method}, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    run = factory_of(problem).start()
    assert isinstance(run, ParticleMethod)
    while not run.finished:
        run.advance()
    frame = run.frame()
    assert frame.contact.shear.max() > 0.0
    force = run.current.tool_force
    found = force_on_tool(tool_loads(frame, problem.tool[0].velocity), frame.tool[0])
    assert np.abs(found - force).max() < 0.02 * np.abs(force).max()


def test_without_an_outline_there_is_nothing_in_contact() -> None:
    problem = problem_of(*validated({**CUT, "method": "tlsph"}, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    (tool,) = problem.tool
    forces = np.ones_like(problem.points)
    found = tractions_on(tool.at(0.0), problem.points, forces, (), 0.02)
    assert isinstance(found, ContactView)
    assert found.particles.size == 0
