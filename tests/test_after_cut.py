"""What comes after a cut: the tool withdraws, the workpiece cools down and is let go; resumable, ledgers closed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from problems import cut_problem

from pfemcut.case.check import figures
from pfemcut.case.load import CaseError, load_case, validated
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem
from pfemcut.results.checkpoint import CheckpointError, require_same_case, require_still_cutting

TRAVEL = 0.01
AFTER = {"release": True, "cooling_steps": 40}


@cache
def problem() -> Problem:
    return cut_problem(cutting={"travel": TRAVEL}, after=AFTER)


@cache
def run() -> tuple[list[dict[str, float]], dict[int, dict[str, np.ndarray]], PfemMethod]:
    """Rows of the history, states at the ends of the stages, and the method at the end."""
    method, rows, states = PfemMethod.start(problem()), [], {}
    while not method.finished:
        method.advance()
        row = {**vars(method.measure()), **method.own_measures()}
        rows.append(row)
        if problem().ends_stage(row["time"]):
            states[row["step"]] = dict(method.state())
    return rows, states, method


def test_stages_follow_each_other_and_the_tool_moves_without_a_jump() -> None:
    whole = problem()
    stages = (whole, *whole.after)
    assert [stage.time.end for stage in stages] == sorted(stage.time.end for stage in stages)
    for before, after in zip(stages, stages[1:], strict=False):
        end = before.time.end
        assert whole.ending(end) is before
        assert whole.beginning(end) is after
        assert np.allclose(before.tool[0].at(end).centre, after.tool[0].at(end).centre, rtol=0.0, atol=1e-14)
    # Withdrawn by two depths of cut, equally far from both faces.
    cut_end, last = whole.tool[0].at(whole.time.end), stages[-1].tool[0].at(whole.end)
    way = np.asarray(last.centre) - np.asarray(cut_end.centre)
    assert np.hypot(*way) == pytest.approx(2.0 * whole.cut[0].depth)
    assert way @ cut_end.rake_normal == pytest.approx(way @ cut_end.flank_normal)
    assert way @ cut_end.rake_normal < 0.0


def test_forces_fall_to_zero_gradually_and_travel_stays() -> None:
    rows, _, _ = run()
    force = np.array([row["cutting_force"] for row in rows])
    time = np.array([row["time"] for row in rows])
    end = problem().time.end * (1.0 + 1e-9)
    loaded = force[time <= end][-1]
    after = force[time > end]
    assert loaded > 20.0
    assert np.count_nonzero((after > 0.02 * loaded) & (after < 0.98 * loaded)) >= 3
    assert (np.diff(after) <= 1e-9 * loaded).all()
    assert after[-1] == 0.0
    assert max(row["travel"] for row in rows) == pytest.approx(TRAVEL)
    assert rows[-1]["travel"] == pytest.approx(TRAVEL)


def test_it_cools_down_and_is_let_go_with_closed_ledgers() -> None:
    rows, states, method = run()
    cut, last = rows[list(states)[0] - 1], rows[-1]
    assert cut["max_temperature"] > 400.0
    assert last["max_temperature"] == pytest.approx(293.15, abs=0.1)
    assert last["heat_content"] == pytest.approx(0.0, abs=1e-3 * cut["heat_content"])
    assert abs(last["heat_error"] - cut["heat_error"]) < 1e-4
    assert abs(last["energy_error"] - cut["energy_error"]) < 5e-3
    supports = [last[name] for name in last if name.startswith("reaction_")]
    assert len(supports) == 3
    assert np.abs(supports).max() == 0.0
    corners = np.abs(method.current.last_reactions[:, 0])
    assert corners.max() < 1e-6 * abs(cut["cutting_force"])


@pytest.mark.parametrize("stage", [0, 1, 2])
def test_resuming_between_stages_changes_no_bit(stage: int) -> None:
    rows, states, method = run()
    step = list(states)[stage]
    again = PfemMethod.restore(problem(), states[step])
    for _ in range(3 if stage < 2 else 1):
        again.advance()
    assert vars(again.measure()) == {
        name: rows[again.measure().step - 1][name] for name in vars(again.measure())
    }


def test_a_cut_without_it_is_the_same_until_its_end() -> None:
    rows, states, _ = run()
    plain = PfemMethod.start(replace(problem(), after=()))
    while not plain.finished:
        plain.advance()
    assert plain.measure().step == list(states)[0]
    assert plain.measure().cutting_force == rows[plain.measure().step - 1]["cutting_force"]


STORED = "[cutting]\nspeed = 1000.0\ntravel = 0.5\n"
RELAXED = STORED + "[after]\ncool = true\n"


def test_after_may_be_added_to_a_finished_cut() -> None:
    require_same_case(STORED, RELAXED)
    require_still_cutting(STORED, RELAXED, 5e-4)


@pytest.mark.parametrize("wanted", [RELAXED.replace("0.5", "0.6"), RELAXED.replace("true", "false"), STORED])
def test_nothing_of_it_may_change_once_the_tool_has_withdrawn(wanted: str) -> None:
    require_still_cutting(RELAXED, wanted, 5e-4)
    with pytest.raises(CheckpointError, match="withdrawn"):
        require_still_cutting(RELAXED, wanted, 5.1e-4)


def test_only_a_free_end_lets_the_tool_out() -> None:
    case = Path(__file__).parent.parent / "demos" / "aisi4340_exit" / "case.toml"
    found, material = load_case(case)
    assert dict(figures(found, material, case.parent))["workpiece"] == "0.5 x 0.5 mm"
    table = found.model_dump(exclude_none=True)
    table["workpiece"]["end"] = "held"
    with pytest.raises(CaseError, match="travel"):
        validated(table, case.parent)
