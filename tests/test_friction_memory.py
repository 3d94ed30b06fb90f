"""A coefficient of friction that falls with the sliding speed: its memory keeps quasi-static sliding stable."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from problems import SHORT_CUT, Array, advanced, cut_problem, with_fields
from test_history import MEASURES

from pfemcut.case.check import warnings
from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.conclusion import summary_of
from pfemcut.contact.friction import Interface, remembered_speed
from pfemcut.contact.friction_laws.table import Points, TableLaw
from pfemcut.pfem.method import PfemMethod
from pfemcut.results.history import TableWriter

PRESSURE = 1000.0
SPEED = 700.0
STIFFNESS = 4e5  # MPa/mm, of the chip between tool and shear zone
FALLING = Points(at=(333.3, 1666.7), value=(0.421, 0.244))
FALL = PRESSURE * (0.421 - 0.244) / (1666.7 - 333.3)
# Ruina's criterion, with the slope by the logarithm of the speed.
LEAST_MEMORY = SPEED * FALL / STIFFNESS


def slid_speeds(memory: float, step: float, count: int) -> Array:
    """Slip speeds (mm/s) of a particle on a spring that is driven at SPEED, disturbed by 1 mm/s; (count,)."""
    law = TableLaw(law="table", coefficient=FALLING, memory=memory)

    def traction(known: float, speed: float) -> float:
        state = Interface(*(np.array([x]) for x in (PRESSURE, speed, known, 300.0, 800.0)))
        return float(law.shear(state, 1e-3).value[0])

    known = SPEED + 1.0
    before = traction(known, SPEED)
    speeds = []
    for _ in range(count):
        after = traction(known, SPEED)
        speed = SPEED - (after - before) / (STIFFNESS * step)
        known = float(remembered_speed(np.array([known]), np.array([speed]), step, law.sliding_memory)[0])
        before = after
        speeds.append(speed)
    return np.array(speeds)


@pytest.mark.parametrize("advance", [1e-5, 1e-4, 1e-3, 1e-2])
def test_memory_keeps_sliding_steady_whatever_the_step(advance: float) -> None:
    """The default is well above the least; a disturbance only dies out, by steps of ``advance`` (mm)."""
    memory = TableLaw(law="table", coefficient=FALLING).memory
    assert memory > 10.0 * LEAST_MEMORY
    step = advance / SPEED
    speeds = slid_speeds(memory, step, count=int(np.ceil(40.0 * memory / advance)) + 10)
    assert abs(speeds[-1] - SPEED) < 1e-6
    assert np.abs(speeds - SPEED).max() < 1.0


def test_without_memory_short_steps_swing() -> None:
    """So that the test above means something; long ones don't, though the material is the same."""
    critical = LEAST_MEMORY / SPEED
    short, long = (slid_speeds(0.0, factor * critical, count=40) for factor in (0.5, 4.0))
    assert np.abs(short[-6:] - SPEED).max() > 100.0
    assert np.abs(long[-6:] - SPEED).max() < 1e-6


def test_too_short_a_memory_does_not_help() -> None:
    speeds = slid_speeds(0.5 * LEAST_MEMORY, 0.1 * LEAST_MEMORY / SPEED, count=200)
    assert np.abs(speeds[-20:] - SPEED).max() > 100.0


def test_remembered_speed_follows_over_the_sliding_distance() -> None:
    """Whatever the steps, to round-off: after one memory of sliding 1/e of a jump is left."""
    before, speed = np.array([100.0, 0.0]), np.array([500.0, 0.0])
    memory = 0.005
    known = before
    for step in memory / 500.0 * np.array([0.1, 0.6, 0.3]):
        known = remembered_speed(known, speed, float(step), memory)
    # At rest nothing is forgotten.
    assert known == pytest.approx([500.0 - 400.0 / np.e, 0.0], rel=1e-12)
    assert remembered_speed(before, speed, 1e-6, 0.0) is speed


def friction(memory: float) -> dict[str, object]:
    table = {"at": [300.0, 3000.0], "value": [0.4, 0.2]}
    return {"friction": {"law": "table", "coefficient": table, "memory": memory}, "reference_speed": 33.3}


def tool_speeds(method: PfemMethod, tool_speed: float) -> Array:
    fields, clock = method.current.fields, method.current.clock
    return np.hypot(
        fields.last_displacement[:, 0] / clock.last_dt + tool_speed,
        fields.last_displacement[:, 1] / clock.last_dt,
    )


def test_a_cut_remembers_by_its_particles() -> None:
    """Without memory the last step's speed; with it between that and the one before, on particles that stay."""
    problem = cut_problem(contact=friction(0.0))
    (tool,) = problem.rigid_tools
    method = advanced(problem, 12)
    speed = tool_speeds(method, -tool.velocity[0])
    assert method.current.fields.sliding_speed == pytest.approx(speed, rel=1e-12)

    memory = 0.003
    method = advanced(cut_problem(contact=friction(memory)), 11)
    before, ids = method.current.fields.sliding_speed, method.current.mesh.ids
    method.advance()
    fields, now = method.current.fields, method.current.mesh.ids
    at = {number: row for row, number in enumerate(ids)}
    kept = [row for row, number in enumerate(now) if number in at]
    earlier = before[[at[now[row]] for row in kept]]
    speed = tool_speeds(method, -tool.velocity[0])[kept]
    expected = remembered_speed(earlier, speed, method.current.clock.last_dt, memory)
    assert fields.sliding_speed[kept] == pytest.approx(expected, rel=1e-12)
    assert np.abs(fields.sliding_speed[kept] - speed).max() > 100.0


def test_friction_goes_by_the_remembered_speed() -> None:
    """Particles that remember to have slid slowly bear the larger coefficient of the table, 0.4 instead of 0.2."""
    problem = cut_problem(contact=friction(0.1))
    method = advanced(problem, 12)
    ratios = []
    for speed in (0.0, 1e4):
        known = np.full(len(method.current.mesh.points), speed)
        going_on = with_fields(problem, method, sliding_speed=known)
        going_on.advance()
        view = going_on.frame().contact
        # Where it slides freely. The view shows the friction with what is known after the step, hardly changed by it.
        ratios.append(np.max(view.shear / view.pressure))
    assert ratios == pytest.approx([0.4, 0.2], rel=0.05)


def test_where_friction_has_no_memory_check_and_summary_say_so(tmp_path: Path) -> None:
    """Between the workpiece and a tool that deforms; not on a rigid tool, nor of a law that needs none."""
    body = {"material": {"base": "aisi4340", "hardening": {"law": "elastic"}}, "width": 0.5, "height": 0.5}
    falling = {"law": "table", "coefficient": {"at": [333.3, 1666.7], "value": [0.421, 0.244]}}
    deformable = {**SHORT_CUT["tool"], "model": "deformable", "body": body}
    for tool, friction, told in (
        (deformable, falling, 1),
        (deformable, {**falling, "memory": 0.0}, 0),
        (deformable, 0.3, 0),
        (SHORT_CUT["tool"], falling, 0),
    ):
        case, material = validated({**SHORT_CUT, "tool": tool, "contact": {"friction": friction}}, tmp_path)
        assert (
            sum("its memory acts on a rigid tool only" in text for text in warnings(case, material)) == told
        )
        problem = problem_of(case, material, tmp_path)
        with TableWriter(tmp_path / "history.csv") as table:
            table.append(vars(MEASURES))
        summary = summary_of(tmp_path, problem, finished=True, ending="", warnings=())
        (tmp_path / "history.csv").unlink()
        assert sum("its memory acts on a rigid tool only" in text for text in summary.warnings) == told
