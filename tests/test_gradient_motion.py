"""Boundary displacement that is linear in the initial position."""

from __future__ import annotations

from pathlib import Path

import pytest

from pfemcut.case.load import CaseError, validated
from pfemcut.case.translate import problem_of


def test_a_gradient_moves_a_part_linearly(tmp_path: Path) -> None:
    table = {
        "problem": "general",
        "body": [
            {
                "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
                "parts": ["edge"] * 4,
                "material": "voce_steel",
            }
        ],
        "boundary": [{"part": "edge", "gradient": {"centre": [0.5, 0.5], "xy": 0.1}}],
        "mesh": {"size": 0.5},
        "time": {"step": 1.0, "end": 1.0},
    }
    (motion,) = problem_of(*validated(table, tmp_path), tmp_path).motions
    assert (motion.part, motion.axis.name, motion.centre) == ("edge", "X", (0.5, 0.5))
    assert [slope(0.0) for slope in motion.gradient] == [0.0, 0.1]
    table["boundary"][0]["velocity"] = {"x": 1.0}
    with pytest.raises(CaseError, match="velocity and gradient exclude each other"):
        validated(table, tmp_path)
