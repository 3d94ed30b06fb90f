"""A short coarse cut of AISI 4340: its invariants, restart, and how runs end."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from problems import Array, advanced, block_problem, cut_problem, fixed_x, fixed_y, moving

from meshing.mesh import signed_areas
from pfemcut.method import CutEnded, RunStopped
from pfemcut.pfem import step as step_module
from pfemcut.pfem.method import PfemMethod
from pfemcut.pfem.newton import StepFailed
from pfemcut.problem import Axis, Cut, Problem

STEPS = 70
RESTART = STEPS - 10


def cut(integrator: str = "impl-ex", friction: float = 0.0, steps: int = STEPS) -> tuple[PfemMethod, Run]:
    """A cut of ``steps`` steps, and what it left on its way; made once."""
    return _cut(integrator, friction, steps)


@cache
def _cut(integrator: str, friction: float, steps: int) -> tuple[PfemMethod, Run]:
    problem = cut_problem(
        time={"integrator": integrator}, contact={"friction": friction, "reference_speed": 10.0}
    )
    method = PfemMethod.start(problem)
    run = Run(problem)
    for _ in range(steps):
        method.advance()
        run.note(method)
    return method, run


class Run:
    """Histories of a run, and its states at some steps."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.rows: list[dict[str, float]] = []
        self.states: dict[int, Mapping[str, NDArray[Any]]] = {}
        self.smallest_area = np.inf
        self.smallest_jacobian = np.inf

    def note(self, method: PfemMethod) -> None:
        self.rows.append({**vars(method.measure()), **method.own_measures()})
        mesh = method.current.mesh
        area = signed_areas(mesh.points, mesh.cells)
        before = signed_areas(mesh.points - method.current.fields.last_displacement, mesh.cells)
        self.smallest_area = min(self.smallest_area, float(area.min()))
        self.smallest_jacobian = min(self.smallest_jacobian, float((area / before).min()))
        if len(self.rows) == RESTART:
            self.states[len(self.rows)] = method.state()

    def mean(self, name: str, last: int = 30) -> float:
        return float(np.mean([row[name] for row in self.rows[-last:]]))

    def column(self, name: str) -> Array:
        return np.array([row[name] for row in self.rows])


def test_forces_have_the_right_signs() -> None:
    """Cutting force positive in every step, thrust once the tip is in; 1.5 to 2.5 kN/mm² of uncut chip."""
    _, run = cut()
    assert run.column("cutting_force").min() > 0.0
    assert run.column("thrust_force")[20:].min() > 0.0
    assert 1500.0 < run.mean("cutting_force") / 0.1 < 2500.0


def test_no_element_inverts() -> None:
    """Areas positive, and no element loses half of its area in a step."""
    _, run = cut()
    assert run.smallest_area > 0.0
    assert run.smallest_jacobian > 0.5
    assert run.rows[-1]["step_cuts"] == 0


@pytest.mark.parametrize("integrator", ["impl-ex", "implicit"])
def test_energy_ledger(integrator: str) -> None:
    """Error of the last 30 steps' work below 2 %; of all the work, the sudden entry included, below 6 %."""
    _, run = cut(integrator)
    work = run.column("tool_work")
    error = run.column("energy_error") * work
    print(
        "ENERGY", integrator, (error[-1] - error[-31]) / (work[-1] - work[-31]), run.rows[-1]["energy_error"]
    )
    assert abs(error[-1] - error[-31]) < 0.02 * (work[-1] - work[-31])
    assert abs(run.rows[-1]["energy_error"]) < 0.06
    assert run.rows[-1]["plastic_work"] > 0.8 * work[-1]


def test_heat_ledger() -> None:
    """Within 0.3 %."""
    _, run = cut()
    assert abs(run.rows[-1]["heat_error"]) < 0.003
    assert run.rows[-1]["max_temperature"] > 450.0


def test_area_and_mass_do_not_drift() -> None:
    """Remeshing keeps the area to 1e-9 of what was cut, and the body its mass to 1e-4."""
    method, run = cut()
    assert method.current.ledger.inserted > 100
    assert method.current.ledger.removed > 10
    assert np.abs(run.column("area_drift")).max() < 1e-9
    assert np.abs(run.column("mass_drift")).max() < 1e-4


def test_restart_goes_on_bit_for_bit() -> None:
    """From the state ten steps before the end, every array of the end."""
    method, run = cut()
    again = PfemMethod.restore(run.problem, run.states[RESTART])
    for _ in range(STEPS - RESTART):
        again.advance()
    wanted, found = method.state(), again.state()
    assert list(found) == list(wanted)
    for name, values in wanted.items():
        assert found[name].dtype == values.dtype, name
        assert np.array_equal(found[name], values), name


def test_impl_ex_and_implicit_forces_agree() -> None:
    """Mean of the last 30 steps, at twice the paper's step on a coarse mesh: 1 % in cutting force, 10 % in thrust."""
    _, explicit = cut()
    _, implicit = cut("implicit")
    assert explicit.mean("cutting_force") == pytest.approx(implicit.mean("cutting_force"), rel=0.01)
    assert explicit.mean("thrust_force") == pytest.approx(implicit.mean("thrust_force"), rel=0.1)


def test_friction_raises_both_forces() -> None:
    """With a coefficient of 0.3: by 10 % and by half at least, from the same start."""
    _, without = cut()
    _, rubbed = cut(friction=0.3, steps=50)
    for name, factor in (("cutting_force", 1.1), ("thrust_force", 1.5)):
        assert rubbed.column(name)[20:50].mean() > factor * without.column(name)[20:50].mean()
    assert rubbed.rows[-1]["friction_work"] > 0.01 * rubbed.rows[-1]["tool_work"]


JAWS = (
    (0.0, 0.0),
    (1.0, 0.0),
    (1.0, 0.4),
    (0.3, 0.4),
    (0.3, 0.45),
    (1.0, 0.45),
    (1.0, 0.6),
    (0.0, 0.6),
)


def test_body_that_touches_itself_ends_the_cut() -> None:
    """Jaws 0.05 mm apart at x = 1 are closed by 0.01 mm a step: the run ends in time and says where.

    For a cut that is the end; any other problem can't go on.
    """
    closing = (fixed_x("bottom"), fixed_y("bottom"), moving("bite", Axis.Y, -1e3))
    block = block_problem(size=0.08, motions=closing, steps=30)
    parts = ("bottom", "lip", "slot", "slot", "slot", "lip", "bite", "left")
    jaws = replace(block, body=replace(block.body, name="jaws", outline=JAWS, parts=parts))
    method = PfemMethod.start(jaws)
    with pytest.raises(RunStopped, match="jaws after step . can't be triangulated"):
        while True:
            method.advance()
    method = PfemMethod.restore(replace(jaws, cut=(Cut(0.1, 1e3, 1.0),)), method.state())
    with pytest.raises(CutEnded, match="jaws after step . touches itself") as ended:
        method.advance()
    assert 4 <= method.current.clock.step <= 8
    x, y = place(str(ended.value))
    assert 0.25 < x < 1.05
    assert 0.3 < y < 0.45
    assert method.measure().step == method.current.clock.step  # the last state is whole


def place(message: str) -> tuple[float, float]:
    """The first position in a message, as (x, y)."""
    found = re.search(r"\((-?[\d.e+-]+), (-?[\d.e+-]+)\)", message)
    assert found, message
    return float(found[1]), float(found[2])


class FailsAtFirst:
    """Stands in for the momentum solve: the first ``failures`` attempts don't converge."""

    def __init__(self, failures: float) -> None:
        self.solve = step_module.solve_motion
        self.failures = failures
        self.attempts: list[float] = []

    def __call__(self, *arguments: Any, step: float, **keywords: Any) -> Any:
        self.attempts.append(step)
        if len(self.attempts) <= self.failures:
            raise StepFailed("no convergence, on purpose")
        return self.solve(*arguments, step=step, **keywords)


def squeezed(speed: float = 100.0) -> Problem:
    motions = (fixed_x("bottom"), fixed_y("bottom"), moving("top", Axis.Y, -speed))
    return block_problem(motions=motions, size=0.3, steps=20)


def test_failed_step_is_halved_and_grows_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two failures: a quarter of the step, counted, then growth by 1.25 a step back to the nominal one."""
    solve = FailsAtFirst(2)
    monkeypatch.setattr(step_module, "solve_motion", solve)
    method = PfemMethod.start(squeezed())
    nominal = 1e-5
    lengths = []
    for _ in range(9):
        method.advance()
        lengths.append(method.measure().dt)
    assert solve.attempts[:3] == [nominal, nominal / 2, nominal / 4]
    assert lengths == pytest.approx([min(nominal, nominal / 4 * 1.25**i) for i in range(9)], rel=1e-14)
    assert lengths[-1] == nominal
    assert method.own_measures()["step_cuts"] == 2
    assert method.measure().time == pytest.approx(sum(lengths), rel=1e-14)
    # The support moved by its velocity times the time, so the cut step was taken at its own length.
    top = method.current.mesh.points[:, 1].max()
    assert top == pytest.approx(1.0 - 100.0 * sum(lengths), rel=1e-12)


def test_run_that_cannot_go_on_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    """Step, time, place, reason; state untouched; given up below the smallest step and not before."""
    method = advanced(squeezed(), 2)
    before = method.state()
    solve = FailsAtFirst(np.inf)
    monkeypatch.setattr(step_module, "solve_motion", solve)
    with pytest.raises(RunStopped) as stopped:
        method.advance()
    message = str(stopped.value)
    assert "step 3" in message
    assert "t = 2e-05 s" in message
    assert "no convergence, on purpose" in message
    x, y = place(message)
    assert 0.0 <= x <= 1.01
    assert y == pytest.approx(0.998, abs=1e-3)  # the fastest particles are at the top
    assert solve.attempts == pytest.approx([1e-5 * 0.5**i for i in range(10)])
    after = method.state()
    assert all(np.array_equal(after[name], values) for name, values in before.items())


def test_body_crushed_in_one_step_is_not_carried_on() -> None:
    """Nine tenths of the height in the smallest step: an element would invert, and the run stops."""
    problem = squeezed(speed=0.9 / 1e-8)
    with pytest.raises(RunStopped, match="step 1 .*(invert|convergence)"):
        PfemMethod.start(problem).advance()
    # A step that is only too long is cut and then taken.
    method = advanced(squeezed(speed=0.9 / 1e-5), 1)
    assert method.own_measures()["step_cuts"] > 0
    mesh = method.current.mesh
    assert signed_areas(mesh.points, mesh.cells).min() > 0.0
