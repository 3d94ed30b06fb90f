"""In a short cut, pressure and shear along the tool add up to the forces that the run reports."""

from __future__ import annotations

import pytest
from problems import advanced, cut_problem

from pfemcut.problem import Problem
from pfemcut.results.derived.tool_profiles import (
    averaged_profiles,
    force_of_profiles,
    force_on_tool,
    tool_loads,
)

BODY = {
    "material": {"base": "aisi4340", "hardening": {"law": "elastic"}},
    "tip_size": 0.006,
    "face_size": 0.02,
    "width": 0.5,
    "height": 0.5,
}
FRICTION = {"friction": 0.3, "reference_speed": 33.3}


@pytest.mark.parametrize(
    ("problem", "tolerance"),
    [
        (cut_problem(contact=FRICTION), 1e-9),
        # The tool's surface is a curve through its particles that bends, the profile's that of the tool without load.
        (cut_problem(contact=FRICTION, tool={"model": "deformable", "body": BODY}), 0.01),
    ],
    ids=["rigid", "deformable"],
)
def test_tractions_add_up_to_the_forces(problem: Problem, tolerance: float) -> None:
    """Of the particles to round-off; of the stations, each with the normal of its middle, to half a per cent."""
    method = advanced(problem, 30)
    measures, tool = method.measure(), problem.tool[0]
    loads = tool_loads(method.frame(), tool.velocity, 0.0 if tool.body else measures.dt)
    exact = [measures.cutting_force, measures.thrust_force]
    scale = measures.cutting_force
    found = force_on_tool(loads, tool.shape)
    assert found == pytest.approx(exact, abs=tolerance * scale)
    profiles = averaged_profiles([loads], tool.shape, problem.cut[0].depth)
    assert force_of_profiles(profiles, tool.shape) == pytest.approx(found, abs=0.005 * scale)
