"""Cutting with a deformable tool: it is the rigid one if it is stiff, and its ledgers close."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from problems import advanced, cut_problem

from pfemcut.case.cutting import TOOL
from pfemcut.output.vtu import FieldWriter, read_last_frame
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem
from pfemcut.results.derived.columns import derived_columns

STEPS = 40
TOLERANCE = 1e-6
ELASTIC = {"base": "aisi4340", "hardening": {"law": "elastic"}}


def deformable(
    material: dict[str, Any] = ELASTIC, contact: dict[str, Any] | None = None, **body: Any
) -> Problem:
    given = {"material": material, "tip_size": 0.006, "face_size": 0.02, "width": 0.5, "height": 0.5, **body}
    return cut_problem(
        tool={"model": "deformable", "body": given},
        contact={} if contact is None else contact,
        solver={"tolerance": TOLERANCE},
    )


@cache
def rigid() -> PfemMethod:
    return advanced(cut_problem(), STEPS)


@cache
def soft() -> PfemMethod:
    return advanced(deformable(), STEPS)


def test_a_stiff_tool_gives_the_forces_of_a_rigid_one() -> None:
    """The means of the last twenty steps, in which both wander by several per cent."""
    forces = []
    for problem in (cut_problem(), deformable({**ELASTIC, "young_modulus": 2e7})):
        method = advanced(problem, STEPS - 20)
        history = []
        for _ in range(20):
            method.advance()
            history.append(method.record.tool_force)
        forces.append(np.mean(history, axis=0))
    rigid, stiff = forces
    assert stiff[0] == pytest.approx(rigid[0], rel=0.02)
    assert stiff[1] == pytest.approx(rigid[1], abs=0.02 * rigid[0])


def test_ledgers_close_with_the_tools_elastic_energy() -> None:
    method = soft()
    measures, own = method.measure(), method.own_measures()
    # So early and with so coarse a mesh it is 5 %, with either tool.
    assert abs(measures.energy_error) < abs(rigid().measure().energy_error) + 0.003
    assert measures.elastic_energy > 1.3 * rigid().measure().elastic_energy
    assert abs(own["mass_drift"]) < 1e-5
    # The bottom carries what the tool presses, to the tolerance of Newton's method.
    assert own["reaction_bottom_y"] == pytest.approx(measures.thrust_force, rel=TOLERANCE)


def test_tool_is_stressed_at_the_tip_and_keeps_its_mesh() -> None:
    method = soft()
    frame = method.frame()
    (block,) = frame.tool_blocks
    assert block.name == TOOL and frame.points.shape[0] < len(method.current.mesh.points)
    start = advanced(deformable(), 0).frame().tool_blocks[0]
    np.testing.assert_array_equal(start.cells, block.cells)
    columns = derived_columns(frame, deformable().cut[0])
    assert 500.0 < columns["tool_max_von_mises"] < 5000.0
    assert np.hypot(columns["tool_von_mises_along_rake"], columns["tool_von_mises_depth"]) < 0.1
    assert columns["tool_min_principal"] < -1000.0
    # Pushed back against its motion, by some force over modulus.
    assert 5e-4 < columns["tool_tip_deflection_x"] < 5e-3
    assert columns["tool_max_temperature"] == pytest.approx(293.15)
    assert frame.contact.arc_length.max() < 0.2 and frame.contact.arc_length.min() > -0.1
    assert frame.contact.particles.max() < len(frame.points)


def test_restored_run_goes_on_with_the_same_bits() -> None:
    problem = deformable()
    method = advanced(problem, 6)
    again = PfemMethod.restore(problem, dict(method.state()))
    for _ in range(3):
        method.advance()
        again.advance()
    for (name, one), two in zip(method.state().items(), again.state().values(), strict=True):
        np.testing.assert_array_equal(one, two, err_msg=name)


@pytest.mark.parametrize("points", ["nodes", "edges"])
def test_friction_heats_the_tool_and_the_heat_ledger_closes(points: str) -> None:
    """Perfect conductance: both sides of the interface are equally hot, within the mesh."""
    contact = {"friction": 0.2, "conductance": 1e6, "reference_speed": 20.0}
    method = advanced(deformable(contact=contact, contact_points=points), STEPS)
    own = method.own_measures()
    assert abs(own["heat_error"]) < 0.01
    frame = method.frame()
    columns = derived_columns(frame, deformable().cut[0])
    assert columns["tool_max_temperature"] > 330.0
    hottest = frame.contact.particles[np.argmax(frame.contact.pressure)]
    assert abs(frame.point_fields["temperature"][hottest] - columns["tool_max_temperature"]) < 150.0
    assert method.measure().friction_work > 0.0
    assert abs(method.measure().energy_error) < 0.05


def test_elastic_plastic_tool_yields_where_it_is_soft() -> None:
    material = {"base": "aisi4340", "hardening": {"A": 500.0, "B": 100.0}}
    method = advanced(deformable(material), 25)
    (block,) = method.frame().tool_blocks
    assert block.cell_fields["equivalent_plastic_strain"].max() > 1e-3


def test_tool_s_fields_are_written_and_read_back(tmp_path: Path) -> None:
    frame = soft().frame()
    FieldWriter(tmp_path).write(frame)
    (written,), (read,) = frame.tool_blocks, read_last_frame(tmp_path).tool_blocks
    np.testing.assert_allclose(read.points, written.points, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(read.cells, written.cells)
    for name in ("temperature", "displacement"):
        np.testing.assert_allclose(read.point_fields[name], written.point_fields[name], rtol=0, atol=1e-12)
    stress = written.cell_fields["cauchy_stress"]
    np.testing.assert_allclose(read.cell_fields["cauchy_stress"], stress, rtol=0, atol=1e-9)
    again = derived_columns(read_last_frame(tmp_path), deformable().cut[0])
    assert again["tool_max_von_mises"] == pytest.approx(
        derived_columns(frame, deformable().cut[0])["tool_max_von_mises"]
    )
