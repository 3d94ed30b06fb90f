"""How far a run is, also while it cools down: course, time to go, the view of a run and the state of a sweep."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from problems import SHORT_CUT, cut_problem
from test_history import MEASURES

from pfemcut.case.load import resolved_toml, validated
from pfemcut.problem.course import course_of, straight
from pfemcut.results.history import TableWriter
from pfemcut.sweep.plan import Plan, Variant
from pfemcut.sweep.prepare import State, prepared, states
from pfemcut.watch.state import RunReader, Status

AFTER = {"cool": True, "cooling_steps": 60, "release": True}


def test_a_cut_alone_advances_evenly() -> None:
    problem = cut_problem()
    assert problem.course.share(0.25 * problem.end) == pytest.approx(0.25, rel=1e-12)
    assert problem.course == course_of([problem.time])
    assert problem.course.share(problem.end) == straight(problem.end).share(problem.end) == 1.0


def test_stages_count_by_their_steps() -> None:
    problem = cut_problem(after=AFTER)
    course, cut = problem.course, problem.time
    # 720 steps of the cut, some forty of the withdrawal, 60 of cooling and 2 of the release.
    ends = [course.share(stage.time.end) for stage in (problem, *problem.after)]
    expected = cut.end / cut.largest_step
    steps = np.diff([0.0, *ends]) * expected / ends[0]
    assert steps[0] == pytest.approx(expected)
    assert 20 < steps[1] < 60
    assert steps[2] == pytest.approx(60.0, abs=1.5)
    assert steps[3] == pytest.approx(2.0, abs=1e-6)
    assert ends[-1] == 1.0
    assert np.all(np.diff(course.times) > 0.0) and np.all(np.diff(course.shares) > 0.0)
    # Though it takes less than a thousandth of the time, most of the run is the cut.
    assert problem.time.end < 1e-2 * problem.end
    assert ends[0] > 0.85


def test_time_to_go_of_later_stages_is_by_their_steps(tmp_path: Path) -> None:
    table = {**SHORT_CUT, "after": AFTER}
    (tmp_path / "inputs.resolved.toml").write_text(resolved_toml(*validated(table, tmp_path)), "utf-8")
    course = cut_problem(after=AFTER).course
    later = [at for at in course.times[1:] if course.share(at) < 0.97]
    with TableWriter(tmp_path / "history.csv") as history, TableWriter(tmp_path / "timing.csv") as timing:
        for step, at in enumerate(later, 1):
            history.append({**vars(replace(MEASURES, step=step, time=at))})
            timing.append({"step": step, "total": 2.0})
    left = len(course.times) - 1 - len(later)
    assert left > 10
    state = RunReader(tmp_path).state()
    assert (state.status, state.share) == (Status.RUNNING, pytest.approx(course.share(later[-1])))
    assert state.to_go == pytest.approx(2.0 * left, rel=1e-6)


def test_a_finished_cut_goes_on_where_something_comes_after_it_now(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(tomli_w.dumps(SHORT_CUT), encoding="utf-8")
    plan = Plan(case, tmp_path / "out", {}, (Variant("one", {}),), ())
    (variant,) = prepared(plan)
    variant.directory.mkdir(parents=True)
    inputs = resolved_toml(variant.case, variant.material)
    (variant.directory / "inputs.resolved.toml").write_text(inputs, encoding="utf-8")
    (variant.directory / "summary.json").write_text('{"finished": true}', encoding="utf-8")
    (variant.directory / "checkpoint.h5").touch()
    assert states([variant]) == (State.FINISHED,)
    relaxed = prepared(replace(plan, common={"after.cool": True}))
    assert states(relaxed) == (State.INTERRUPTED,)
    assert relaxed[0].course.share(variant.course.times[-1]) < 1.0
