"""Heat into the tool: the block of a tool that conducts, the exchange with it, and cuts with both."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from problems import Array, advanced, cut_problem

from pfemcut.contact.heat import exchange_matrix
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Conductor, Problem
from pfemcut.tools.heat_block import HeatBlock, block_mesh
from pfemcut.tools.rigid_wedge import RigidWedge

COLD = 293.15
CARBIDE = Conductor(
    density=14.85e-9,
    capacity=0.202e9,
    conductivity=100.0,
    length=1.0,
    fine_length=0.2,
    tip_size=0.02,
    growth=0.3,
)
CONDUCTION = {
    "conductivity": 100.0,
    "capacity": 0.202e9,
    "density": 14.85e-9,
    "length": 1.0,
    "fine_length": 0.2,
}


@cache
def block(rake: float = 6.0) -> HeatBlock:
    tool = RigidWedge((0.4, -0.2), rake, 5.0, 0.025)
    return HeatBlock(tool, CARBIDE, block_mesh(tool, CARBIDE))


@pytest.mark.parametrize("rake", [-10.0, 0.0, 6.0])
def test_surface_runs_round_the_tip(rake: float) -> None:
    """From the rake face's end to the flank face's, particles on the tool to 1e-9 mm, the rake face resolved."""
    heat, tool = block(rake), RigidWedge((0.4, -0.2), rake, 5.0, 0.025)
    points = heat.mesh.points[heat.surface]
    assert np.abs(tool.closest(points).gap).max() < 1e-9
    assert np.all(np.diff(heat.arc_length) < 0.0)
    assert heat.arc_length[[0, -1]] == pytest.approx([1.0, -0.025 * tool.arc_angle - 1.0])
    on_rake = (heat.arc_length > 0.0) & (heat.arc_length < 0.2)
    assert np.abs(np.diff(heat.arc_length[on_rake])).max() < 0.03


def test_places_interpolate_and_hand_on_all_power() -> None:
    heat = block()
    at = np.array([0.31, 0.0, -0.02, -0.5, 7.0])
    places = heat.places(at)
    assert np.asarray(places.sum(axis=1)).ravel() == pytest.approx(np.ones(5))
    assert (places @ heat.arc_length)[:4] == pytest.approx(at[:4], abs=1e-12)
    assert (places.T @ np.array([1.0, 2.0, 3.0, 4.0, 5.0])).sum() == pytest.approx(15.0)


def test_block_books_its_heat() -> None:
    """Power in is content and what the holder took, to 1e-11; in long steps all goes to the holder."""
    heat = block()
    power = heat.places(np.array([0.1, 0.02])).T @ np.array([3.0, 5.0])
    temperature, lost, into = np.full(len(heat.mesh.points), COLD), 0.0, 0.0
    for step in (1e-7, 1e-7, 2e-5, 1e-3):
        temperature, to_holder = heat.advanced(temperature, power, step)
        lost, into = lost + to_holder * step, into + power.sum() * step
    assert heat.content(temperature, COLD) + lost == pytest.approx(into, rel=1e-9)
    assert 0.0 < lost < into
    assert temperature.min() > COLD - 1e-9
    _, to_holder = heat.advanced(temperature, power, 1e6)
    assert to_holder == pytest.approx(8.0, rel=1e-6)


def test_response_is_that_of_a_step() -> None:
    """Symmetric, and what a step with unit power gives at the points, for either step length."""
    heat = block()
    places = heat.places(np.array([0.15, 0.01, -0.01, -0.3]))
    start = np.full(len(heat.mesh.points), COLD)
    for step in (1e-7, 1e-5, 1e-7):
        response = heat.response(places, step)
        assert np.allclose(response, response.T, rtol=1e-10, atol=1e-10 * response.max())
        for i in range(4):
            after, _ = heat.advanced(start, places.T @ (1e3 * np.eye(4)[i]), step)
            rise = (places @ after[heat.surface] - COLD) / 1e3
            assert rise == pytest.approx(response[:, i], rel=1e-7, abs=1e-9)


def test_exchange_matrix_is_conductance_and_warming_in_series() -> None:
    """Against the series formula; bounded by the tool alone for any conductance; zero where there is none."""
    response = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert exchange_matrix(np.array([3.0, 4.0]), 0.0 * response) == pytest.approx(np.diag([3.0, 4.0]))
    series = np.linalg.inv(np.diag([1 / 3.0, 1 / 4.0]) + response)
    assert exchange_matrix(np.array([3.0, 4.0]), response) == pytest.approx(series)
    assert exchange_matrix(np.full(2, 1e12), response) == pytest.approx(np.linalg.inv(response), rel=1e-9)
    insulated = exchange_matrix(np.array([0.0, 4.0]), response)
    assert not insulated[0].any()
    assert insulated[1, 1] == pytest.approx(1.0 / (0.25 + 1.0))


def hot_cut(
    contact: Mapping[str, Any], conducts: bool = True, friction: Any = 0.3, temperature: float = COLD
) -> Problem:
    """A cut with friction and heat into the tool."""
    tool = {"conduction": CONDUCTION} if conducts else {}
    return cut_problem(
        tool={"temperature": temperature, **tool},
        contact={"friction": friction, "reference_speed": 10.0, **contact},
    )


@cache
def cut(conductance: float, partition: float = 0.5) -> PfemMethod:
    return advanced(hot_cut({"conductance": conductance, "heat_partition": partition}), 25)


@pytest.mark.parametrize("conductance", [0.0, 10.0, 1e6])
def test_both_heat_ledgers_close(conductance: float) -> None:
    """The workpiece's to 1 % (remeshing), the tool's to 1e-9: whatever the conductance."""
    method = cut(conductance)
    own, measured = method.own_measures(), method.measure()
    assert abs(own["heat_error"]) < 0.01
    assert abs(own["tool_heat_error"]) < 1e-9
    received = own["heat_to_tool"] + 0.5 * measured.friction_work
    assert own["tool_heat_content"] + own["tool_heat_lost"] == pytest.approx(received, rel=1e-9)
    assert received > 0.0
    assert (own["heat_to_tool"] == 0.0) == (conductance == 0.0)


def test_perfect_contact_has_one_temperature_and_no_overshoot() -> None:
    """With 1e6 the tool's surface has the particles' temperature, and nothing is below the start.

    To 2 % of the rise: half a kelvin drives the 500 W/mm² of the first moments even through 1e6.
    """
    method = cut(1e6)
    frame, own = method.frame(), method.own_measures()
    contact = frame.contact
    particles = frame.point_fields["temperature"][contact.particles]
    (tool_block,) = frame.tool_blocks
    on_surface = np.abs(frame.tool[0].closest(tool_block.points).gap) < 1e-7
    arc = frame.tool[0].arc_length(tool_block.points[on_surface])
    order = np.argsort(arc)
    surface: Array = np.asarray(tool_block.point_fields["temperature"])[on_surface][order]
    seen = np.interp(contact.arc_length, arc[order], surface)
    hottest = method.measure().max_temperature
    assert np.abs(seen - particles).max() < 0.02 * (particles.max() - COLD)
    assert surface.min() > COLD - 1e-6
    assert COLD + 0.2 * (hottest - COLD) < own["tool_max_temperature"] < hottest


def test_in_perfect_contact_the_partition_does_not_matter() -> None:
    """Tool's heat to 1 % and its temperature to 1 K with all friction heat on either side."""
    one, other = cut(1e6, 0.0), cut(1e6, 1.0)
    a, b = one.own_measures(), other.own_measures()
    assert a["tool_heat_content"] == pytest.approx(b["tool_heat_content"], rel=0.01)
    assert a["tool_max_temperature"] == pytest.approx(b["tool_max_temperature"], abs=1.0)


def test_tool_at_a_given_temperature_takes_or_gives_heat() -> None:
    """A cold tool takes, a hot one gives heat, and the ledger closes (1 %)."""
    for temperature, sign in ((COLD, 1.0), (1500.0, -1.0)):
        method = advanced(hot_cut({"conductance": 100.0}, conducts=False, temperature=temperature), 15)
        own = method.own_measures()
        assert sign * own["heat_to_tool"] > 0.0
        assert abs(own["heat_error"]) < 0.01
        assert "tool_max_temperature" not in own


def test_conductance_by_pressure_is_used() -> None:
    """Heat into the tool grows with the exponent, as the pressure lies above the reference."""
    taken = []
    for exponent in (0.0, 0.5):
        table = {"value": 1.0, "reference_pressure": 10.0, "exponent": exponent}
        method = advanced(hot_cut({"conductance": table}, conducts=False), 12)
        taken.append(method.own_measures()["heat_to_tool"])
    assert taken[1] > 2.0 * taken[0] > 0.0


FRICTIONS: Mapping[str, Mapping[str, Any]] = {
    "sticking-sliding": {"coefficient": 0.5, "shear_factor": 0.8},
    "usui": {"coefficient": 0.5},
    "shear": {"shear_factor": 0.3},
    "norton-hoff": {"coefficient": 6e-5},
    "power": {"coefficient": 0.3, "speed": 1000.0, "speed_exponent": -0.3, "shear_factor": 1.0},
    "table": {
        "coefficient": {"at": [333.3, 1666.7], "value": [0.42, 0.24]},
        "temperature_factor": {"at": [300.0, 1000.0], "value": [1.0, 0.6]},
    },
}


@cache
def coulomb_cut() -> PfemMethod:
    return advanced(hot_cut({}, conducts=False), 20)


@pytest.mark.parametrize("name", FRICTIONS)
def test_cut_with_each_law(name: str) -> None:
    """Twenty steps: converges without cutting a step, friction costs work, and the energy ledger closes.

    As well as Coulomb's (1 % of the work); so early in a cut IMPL-EX still owes 8 % of the little work there is.
    """
    coulomb = coulomb_cut().measure()
    method = advanced(hot_cut({}, conducts=False, friction={"law": name, **FRICTIONS[name]}), 20)
    measured, own = method.measure(), method.own_measures()
    assert own["step_cuts"] == 0
    assert measured.friction_work > 0.002 * measured.tool_work
    assert abs(measured.energy_error - coulomb.energy_error) < 0.01 + 0.03 * abs(
        1.0 - measured.friction_work / coulomb.friction_work
    )


def test_resumed_run_is_the_same() -> None:
    """Bit for bit, tool included."""
    problem = hot_cut({"conductance": 1e3})
    whole = advanced(problem, 8)
    resumed = PfemMethod.restore(problem, advanced(problem, 5).state())
    for _ in range(3):
        resumed.advance()
    # What a step leaves in the record is the last step's in both.
    assert dict(resumed.own_measures()) == dict(whole.own_measures())
    assert np.array_equal(resumed.current.tool_temperature, whole.current.tool_temperature)
