"""General problems from case files: geometry, conditions, errors."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from meshing.initial import read_mesh
from meshing.mesh import boundary_area, signed_areas
from pfemcut.case.load import CaseError, load_case, resolved_toml, validated
from pfemcut.case.translate import problem_of
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Axis, Problem

ELASTIC = {
    "name": "elastic",
    "source": "none",
    "young_modulus": 2e5,
    "poisson_ratio": 0.3,
    "density": 7.8e-9,
    "expansion": 1e-5,
    "capacity": 4.6e8,
    "conductivity": 45.0,
    "reference_temperature": 293.15,
    "taylor_quinney": 0.9,
    "hardening": {"law": "elastic"},
}


def general(**changes: Any) -> dict[str, Any]:
    """A unit square, held below, pulled above."""
    table: dict[str, Any] = {
        "problem": "general",
        "body": [
            {
                "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
                "parts": ["bottom", "right", "top", "left"],
                "material": ELASTIC,
            }
        ],
        "boundary": [
            {"part": "bottom", "displacement": {"x": 0.0, "y": 0.0}},
            {"part": "top", "force": {"y": {"time": [0.0, 1.0], "value": [0.0, 10.0]}}},
        ],
        "mesh": {"size": 0.3, "remesh": False},
        "time": {"step": 0.5, "end": 1.0},
        "probe": [{"name": "corner", "point": [1.0, 1.0]}],
    }
    return {**table, **changes}


def problem(table: dict[str, Any], base: Path = Path()) -> Problem:
    return problem_of(*validated(table, base), base)


def test_conditions_reach_the_problem() -> None:
    found = problem(
        general(
            boundary=[
                {"part": "bottom", "velocity": {"x": 3.0}, "temperature": 400.0},
                {"part": "top", "pressure": 5.0, "traction": {"x": 2.0}, "flux": 7.0},
                {"part": "left", "convection": {"coefficient": 0.1, "ambient": 300.0}},
                {"part": "right", "band": {"flux": 1.0, "lower": 0.0, "upper": 1.0, "velocity": -2.0}},
            ]
        )
    )
    (motion,) = found.motions
    assert (motion.part, motion.axis, motion.displacement(0.5)) == ("bottom", Axis.X, 1.5)
    assert found.temperatures[0].temperature(9.0) == 400.0
    assert found.pressures[0].pressure(0.0) == 5.0
    assert (found.tractions[0].x(0.0), found.tractions[0].y(0.0)) == (2.0, 0.0)
    assert found.fluxes[0].flux(0.0) == 7.0
    assert found.convections[0].ambient(0.0) == 300.0
    assert found.heat_bands[0].velocity == -2.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"boundary": [{"part": "botom"}]}, "unknown 'botom'; allowed: 'bottom'"),
        ({"boundary": [{"part": "top", "presure": 1.0}]}, "presure: unknown key; did you mean 'pressure'?"),
        ({"time": {"step": -1.0, "end": 1.0}}, "[time] step: given -1.0, must be greater than 0"),
        ({"mesh": {"size": 0.0}}, "[mesh] size: given 0.0, must be greater than 0"),
        ({"probe": [{"name": "a b", "point": [0.0, 0.0]}]}, "name: given 'a b'"),
        (
            {"boundary": [{"part": "top", "force": {"y": {"time": [1.0, 0.0], "value": [0.0, 1.0]}}}]},
            "time: must increase",
        ),
        (
            {"boundary": [{"part": "top", "velocity": {"x": 1.0}, "displacement": {"x": 1.0}}]},
            "displacement, velocity and gradient exclude each other",
        ),
    ],
)
def test_a_mistake_is_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError) as raised:
        validated(general(**change), Path())
    assert message in str(raised.value)
    assert "Traceback" not in str(raised.value)


def test_a_clockwise_outline_is_refused() -> None:
    body = general()["body"][0]
    with pytest.raises(CaseError, match="counter-clockwise"):
        validated(general(body=[{**body, "outline": body["outline"][::-1]}]), Path())


def test_the_resolved_case_reproduces_itself(tmp_path: Path) -> None:
    case, material = validated(general(), Path())
    text = resolved_toml(case, material)
    (tmp_path / "again.toml").write_text(text)
    again, same = load_case(tmp_path / "again.toml")
    assert same == material
    assert resolved_toml(again, same) == text
    assert tomllib.loads(text)["problem"] == "general"


def test_a_stretched_block_obeys_hooke_and_its_ledger_closes() -> None:
    # Plane strain, sides free: strain = (1 - nu²) sigma / E away from the clamped side; sigma = 10 MPa.
    table = general(
        boundary=[
            {"part": "bottom", "displacement": {"y": 0.0}},
            {"part": "left", "displacement": {"x": 0.0}},
            {"part": "top", "force": {"y": {"time": [0.0, 1.0], "value": [0.0, 10.0]}}},
        ]
    )
    method = PfemMethod.start(problem(table))
    while not method.finished:
        method.advance()
    own = method.own_measures()
    assert own["corner_uy"] == pytest.approx((1.0 - 0.09) * 10.0 / 2e5, rel=1e-3)
    assert own["corner_ux"] == pytest.approx(-0.3 * 1.3 * 10.0 / 2e5, rel=1e-3)
    assert own["reaction_bottom_y"] == pytest.approx(-10.0, rel=1e-9)
    assert abs(method.measure().energy_error) < 1e-3


def test_a_follower_pressure_compresses_evenly() -> None:
    sides = [{"part": part, "pressure": 100.0} for part in ("top", "right")]
    held = [{"part": "bottom", "displacement": {"y": 0.0}}, {"part": "left", "displacement": {"x": 0.0}}]
    method = PfemMethod.start(problem(general(boundary=held + sides)))
    while not method.finished:
        method.advance()
    stress = method.frame().cell_fields["cauchy_stress"]
    assert np.allclose(stress[:, :2], -100.0, rtol=1e-6)
    assert np.allclose(stress[:, 3], 0.0, atol=1e-4)


def test_arcs_enclose_the_ring_and_keep_their_part() -> None:
    table = general(
        body=[
            {
                "outline": [[1.0, 0.0], [2.0, 0.0], [0.0, 2.0], [0.0, 1.0]],
                "parts": ["flat", "outer", "upright", "inner"],
                "arcs": [{"side": 1, "centre": [0.0, 0.0]}, {"side": 3, "centre": [0.0, 0.0]}],
                "material": ELASTIC,
            }
        ],
        boundary=[],
        mesh={"size": 0.05},
    )
    mesh = PfemMethod.start(problem(table)).current.mesh
    assert boundary_area(mesh.points, mesh.boundary) == pytest.approx(np.pi * 3.0 / 4.0, rel=1e-3)
    inner = mesh.boundary.edges[mesh.boundary.parts == 3]
    assert np.allclose(np.hypot(*mesh.points[inner.ravel()].T), 1.0)


def test_a_mesh_file_brings_its_parts(tmp_path: Path) -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]]
    triangles = [[0, 1, 4], [4, 1, 2], [2, 3, 4], [0, 4, 3]]
    mesh = meshio.Mesh(
        np.array(points, dtype=float),
        [("triangle", np.array(triangles)), ("line", np.array([[0, 1], [2, 3]]))],
        cell_sets={"below": [np.array([], dtype=int), np.array([0])]},
    )
    path = tmp_path / "square.xdmf"
    mesh = meshio.Mesh(
        mesh.points,
        mesh.cells,
        cell_data={"gmsh:physical": [np.zeros(4, dtype=int), np.array([7, 0])]},
        field_data={"below": np.array([7, 1])},
    )
    path = tmp_path / "square.msh"
    meshio.write(path, mesh, file_format="gmsh22")
    found, names = read_mesh(path)
    assert "below" in names and "boundary" in names
    assert signed_areas(found.points, found.cells).sum() == pytest.approx(1.0)
    below = found.boundary.edges[found.boundary.parts == names.index("below")]
    assert found.points[below.ravel(), 1].max() == 0.0
    body = {"mesh": "square.msh", "material": ELASTIC}
    boundary = [{"part": "below", "displacement": {"x": 0.0, "y": 0.0}}]
    held = problem(general(body=[body], boundary=boundary), tmp_path)
    assert PfemMethod.start(held).current.mesh.points.shape == (5, 2)
    with pytest.raises(CaseError, match="unknown 'above'"):
        problem(general(body=[body], boundary=[{"part": "above"}]), tmp_path)
    with pytest.raises(CaseError, match="not a mesh"):
        problem(general(body=[{**body, "mesh": "missing.msh"}], boundary=[]), tmp_path)


def test_probes_survive_remeshing() -> None:
    table = general(
        boundary=[
            {"part": "bottom", "displacement": {"y": 0.0}},
            {"part": "left", "displacement": {"x": 0.0}},
            {"part": "top", "velocity": {"y": -0.5}},
        ],
        mesh={"size": 0.2, "remesh": True},
        time={"step": 0.05, "end": 1.0},
        probe=[{"name": "inside", "point": [0.5, 0.5]}],
    )
    method = PfemMethod.start(problem(table))
    start = method.current.mesh.points[method.current.probes[0]]
    for _ in range(10):
        method.advance()
    state = method.current
    at = np.flatnonzero(state.mesh.ids == state.probes[0])[0]
    moved = state.mesh.points[at] - start
    own = method.own_measures()
    assert (own["inside_ux"], own["inside_uy"]) == pytest.approx(tuple(moved), abs=1e-12)


def two_blocks(**changes: Any) -> dict[str, Any]:
    """A block on another, of two materials."""
    lower, upper = (
        {
            "name": name,
            "outline": [[0.0, y], [1.0, y], [1.0, y + 0.5], [0.0, y + 0.5]],
            "parts": [f"{name} {side}" for side in ("bottom", "right", "top", "left")],
            "material": {**ELASTIC, "young_modulus": modulus},
        }
        for name, y, modulus in (("lower", 0.0, 2e5), ("upper", 0.5, 6e5))
    )
    table = general(
        body=[lower, upper],
        contact=[{"slave": ["upper bottom"], "master": ["lower top"], "friction": 0.1}],
        boundary=[
            {"part": "lower bottom", "displacement": {"x": 0.0, "y": 0.0}},
            {"part": "upper top", "displacement": {"x": 0.0, "y": {"time": [0, 1], "value": [0, -1e-3]}}},
        ],
        probe=[{"name": "above", "point": [0.5, 0.5], "body": "upper"}],
    )
    return {**table, **changes}


def test_contact_between_bodies_carries_the_load() -> None:
    method = PfemMethod.start(problem(two_blocks()))
    while not method.finished:
        method.advance()
    own = method.own_measures()
    assert own["reaction_lower bottom_y"] > 50.0
    assert own["reaction_lower bottom_y"] == pytest.approx(-own["reaction_upper top_y"], rel=1e-6)
    assert own["above_uy"] < -1e-4
    assert abs(method.measure().energy_error) < 0.02
    frame = method.frame()
    assert [each.name for each in frame.others] == ["upper"]
    assert frame.contact.pressure.min() > 0.0


def test_a_case_with_two_bodies_reproduces_itself(tmp_path: Path) -> None:
    case, material = validated(two_blocks(), Path())
    text = resolved_toml(case, material)
    (tmp_path / "again.toml").write_text(text, encoding="utf-8")
    again, same = load_case(tmp_path / "again.toml")
    assert resolved_toml(again, same) == text
    assert problem_of(again, same, tmp_path).others[0].material.young_modulus == 6e5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"contact": [{"slave": ["uper bottom"], "master": ["lower top"]}]}, "unknown 'uper bottom'"),
        ({"contact": [{"slave": ["upper bottom"]}]}, "master: missing"),
        ({"probe": [{"name": "a", "point": [0.0, 0.0], "body": "middle"}]}, "unknown 'middle'"),
        (
            {"tool": {"tip_radius": 0.1, "centre": [0.0, 2.0]}},
            "[[contact]] between bodies and a rigid [tool] exclude each other",
        ),
    ],
)
def test_mistakes_in_contact_between_bodies_are_named(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError, match=".*") as caught:
        problem(two_blocks(**changes))
    assert message in str(caught.value)
