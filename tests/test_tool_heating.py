"""What a cut is too short to tell of its tool's temperature."""

import math

import pytest
from problems import cut_problem

from pfemcut.results.derived.tool_heating import heated_depth, tool_warnings

CONDUCTION = {"conductivity": 50.0, "capacity": 5e8, "density": 8e-9, "length": 2.0}
DIFFUSIVITY = 12.5  # mm²/s
BODY = {"material": "aisi4340", "tip_size": 0.006, "face_size": 0.02, "width": 0.5, "height": 0.4}


def test_heated_depth_is_that_of_a_half_space() -> None:
    """2 sqrt(a t) is where the rise is erfc(1) of the face's."""
    assert math.erfc(heated_depth(DIFFUSIVITY, 0.02) / math.sqrt(4.0 * DIFFUSIVITY * 0.02)) == pytest.approx(
        0.1573, abs=1e-4
    )


def test_a_conducting_rigid_tool_is_warned_of_until_heat_is_half_through() -> None:
    problem = cut_problem(tool={"conduction": CONDUCTION}, contact={"conductance": 1e5})
    (text,) = tool_warnings(problem, 1e-3)
    assert "about 0.22 mm far into the tool of 2 mm" in text
    half_through = 1.0 / (4.0 * DIFFUSIVITY)
    assert tool_warnings(problem, 0.99 * half_through)
    assert not tool_warnings(problem, 1.01 * half_through)


def test_a_deformable_tool_is_warned_of_only_if_heat_enters() -> None:
    tool = {"model": "deformable", "body": BODY}
    assert not tool_warnings(cut_problem(tool=tool), 1e-4)
    (text,) = tool_warnings(cut_problem(tool=tool, contact={"conductance": 1e5}), 1e-4)
    assert "into the tool of 0.4 mm" in text
    assert not tool_warnings(cut_problem(), 1e-4)
