"""Runs of laminae: moduli, ledgers, resuming, threads, cracks along the fibre, errors of the case file."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

from pfemcut.case.check import figures, warnings
from pfemcut.case.load import CaseError, validated
from pfemcut.driver import run_case
from pfemcut.output.vtu import read_last_frame
from pfemcut.peridynamics.fracture_mechanics import critical_load, opening_release_rate
from pfemcut.peridynamics.integrate import compiled_bonds, family_stiffness
from pfemcut.peridynamics.kernels import run_steps
from pfemcut.peridynamics.lamina import young_modulus
from pfemcut.peridynamics.method import LatticeMethod
from pfemcut.results.history import read_table
from tests.laminae import CARBON, plate, table

HOLE = [{"radius": 3.0}]


def ended(angle: float = 0.0, **changes: dict[str, Any] | list[Any]) -> LatticeMethod:
    """The run of a small plate at its end."""
    method = LatticeMethod.start(plate(angle, **changes))
    while not method.finished:
        method.advance()
    return method


@pytest.mark.parametrize("angle", [0.0, 45.0, 90.0])
def test_moduli_are_those_of_laminate_theory(angle: float) -> None:
    method = ended(
        angle,
        lattice={"criterion": "none", "spacing": 0.6},
        pull={"grips": "sliding", "elongation": 0.1 if angle == 0.0 else 0.2},
    )
    found = method.own_measures()["young_modulus"]
    assert found == pytest.approx(young_modulus(CARBON, math.radians(angle)), rel=0.03)


def test_energy_and_momentum_are_conserved_without_cracks() -> None:
    method = ended(30.0, lattice={"criterion": "none"}, hole=HOLE)
    assert abs(method.measure().energy_error) < 1e-4
    assert method.own_measures()["momentum_error"] < 1e-12


def test_the_ledgers_close_with_cracks_and_dashpots() -> None:
    method = ended(45.0, lattice={"damping": 0.05}, hole=HOLE, pull={"elongation": 0.3})
    own = method.own_measures()
    assert own["broken_matrix_bonds"] > 20 and own["broken_fibre_bonds"] == 0
    assert own["fracture_energy"] > 0.0 and own["damping_energy"] > 0.0
    assert abs(method.measure().energy_error) < 0.01
    assert own["momentum_error"] < 1e-12


def test_a_turned_plate_feels_no_force() -> None:
    problem = plate(20.0)
    turn = np.radians(40.0)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    u = problem.sites @ matrix.T - problem.sites
    force = np.zeros_like(u)
    count = len(problem.bonds.owners)
    none = np.zeros(0, dtype=np.int64)
    run_steps(
        1,
        0.0,
        0.0,
        compiled_bonds(problem),
        (family_stiffness(problem), problem.spacing, problem.limits, problem.site_mass, 0.0),
        (problem.free, none, none, np.zeros((2, 2))),
        problem.weak,
        u,
        np.zeros_like(u),
        force,
        np.ones(count, dtype=np.uint8),
        np.full(count, np.inf),
        np.zeros(count, dtype=np.uint8),
        np.zeros_like(u),
    )
    assert np.abs(force).max() < 1e-12 * problem.stiffness.fibre


def test_a_resumed_run_goes_on_to_the_same_bits() -> None:
    problem = plate(45.0, hole=HOLE, pull={"elongation": 0.3})
    whole, first = LatticeMethod.start(problem), LatticeMethod.start(problem)
    while whole.current.clock.batches < 100:
        whole.advance()
    assert whole.own_measures()["broken_matrix_bonds"] > 0
    for _ in range(60):
        first.advance()
    second = LatticeMethod.restore(problem, {name: each.copy() for name, each in first.state().items()})
    for _ in range(40):
        second.advance()
    for name, array in whole.state().items():
        assert np.array_equal(array, second.state()[name]), name
    measured = [
        {name: float(value).hex() for name, value in each.own_measures().items()} for each in (whole, second)
    ]
    assert measured[0] == measured[1]


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="numba may use one thread only")
def test_threads_do_not_change_a_bit() -> None:
    problem, states = plate(45.0, hole=HOLE, pull={"elongation": 0.3}), []
    before = numba.get_num_threads()
    try:
        for threads in (1, 2):
            numba.set_num_threads(threads)
            method = LatticeMethod.start(problem)
            for _ in range(90):
                method.advance()
            states.append(method.state())
    finally:
        numba.set_num_threads(before)
    assert np.isfinite(states[0]["broken_at"]).any()
    for name, array in states[0].items():
        assert np.array_equal(array, states[1][name]), name


@pytest.mark.parametrize("angle", [0.0, 45.0, 60.0, 90.0])
def test_cracks_from_a_hole_run_along_the_fibre(angle: float) -> None:
    method = ended(
        angle,
        lamina={"length": 40.0, "width": 30.0},
        lattice={"spacing": 0.75},
        hole=HOLE,
        pull={"speed": 800.0, "elongation": 0.25 if angle == 0.0 else 0.32},
    )
    own = method.own_measures()
    for number in (1, 2):
        assert own[f"crack_{number}_length"] > 8.0
        turn = abs(own[f"crack_{number}_angle"] - angle) % 180.0
        assert min(turn, 180.0 - turn) < 5.0


def test_a_crack_starts_at_the_tips_of_a_line_crack() -> None:
    method = ended(
        45.0,
        lamina={"length": 40.0, "width": 30.0},
        lattice={"spacing": 0.75},
        crack=[{"length": 8.0, "angle": 90.0}],
        pull={"speed": 800.0, "elongation": 0.2},
    )
    own = method.own_measures()
    for number in (1, 2):
        assert abs(own[f"crack_{number}_start_x"]) < 1.5
        assert abs(own[f"crack_{number}_start_y"]) == pytest.approx(4.0, abs=1.5)


def test_the_release_rate_of_an_isotropic_sheet_is_the_known_one() -> None:
    sheet = replace(CARBON, axial_modulus=9000.0, transverse_modulus=9000.0)
    assert opening_release_rate(sheet, 30.0) == pytest.approx(30.0**2 / 9000.0, rel=1e-9)


def test_a_line_crack_grows_at_the_load_of_fracture_mechanics() -> None:
    problem = plate(
        90.0,
        lamina={"length": 60.0, "width": 36.0},
        lattice={"spacing": 0.9, "batch": 20},
        crack=[{"length": 8.0, "angle": 90.0}],
        pull={"speed": 500.0, "elongation": 0.2},
    )
    method = LatticeMethod.start(problem)
    while method.own_measures()["broken_matrix_bonds"] == 0:
        method.advance()
    # The crack begins and ends between sites: half a spacing of its half length is 11 %, which is 6 % of the load.
    assert method.current.totals.load == pytest.approx(critical_load(problem.lamina, problem.plate), rel=0.1)


def test_fibre_bonds_break_only_where_they_may() -> None:
    weak = {"base": "carbon_epoxy", "fibre_energy": 0.5}
    given = {"lamina": {"material": weak}, "hole": HOLE, "pull": {"elongation": 0.3}}
    assert ended(0.0, **given).own_measures()["broken_fibre_bonds"] == 0
    assert ended(0.0, **given, lattice={"fibres_break": True}).own_measures()["broken_fibre_bonds"] > 0


def test_the_start_gives_the_plate_no_shock() -> None:
    problem = plate(0.0, lattice={"criterion": "none", "batch": 10})
    smooth, rough = LatticeMethod.start(problem), LatticeMethod.start(problem)
    still = np.where(problem.grip[:, None] == 0, 0.0, problem.start_velocity)
    rough._state = replace(rough.current, velocity=still)
    for method in (smooth, rough):
        method.advance()
    # Away from the grips the strain grows as their distance does; the outermost free sites are half a spacing inside.
    exact = smooth.measure().travel / problem.plate.length
    assert smooth.own_measures()["gauge_strain"] == pytest.approx(exact, rel=0.06)
    assert abs(rough.own_measures()["gauge_strain"] / exact - 1.0) > 0.1


def test_a_case_writes_its_outputs_and_can_be_run_from_them(tmp_path: Path) -> None:
    case, material = validated(table(90.0, hole=HOLE, pull={"elongation": 0.3}), Path())
    summary = run_case(case, material, tmp_path / "out")
    assert summary.finished
    content = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    for name in ("young_modulus", "peak_load", "crack_1_angle", "crack_1_start_x", "parts"):
        assert math.isfinite(content[name]["value"])
    history = read_table(tmp_path / "out" / "history.csv")
    assert content["peak_load"]["value"] == history["load"].max()
    frame = read_last_frame(tmp_path / "out")
    assert np.asarray(frame.point_fields["matrix_damage"]).max() > 0.0
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "figure-damage" in page and "figure-load" in page and "Peak load" in page
    resolved = (tmp_path / "out" / "inputs.resolved.toml").read_text(encoding="utf-8")
    (tmp_path / "again.toml").write_text(resolved, encoding="utf-8")
    from pfemcut import load_case

    assert load_case(tmp_path / "again.toml").toml() == load_case_text(case, material)


def load_case_text(case: Any, material: Any) -> str:
    """The resolved text of a validated case."""
    from pfemcut.case.load import resolved_toml

    return resolved_toml(case, material)


def test_check_tells_figures_and_what_is_unwise() -> None:
    case, material = validated(table(45.0, hole=HOLE), Path())
    told = dict(figures(case, material, Path()))
    assert "sites" in told["lattice"] and "8600 MPa" in told["material"]
    fast = validated(table(45.0, hole=[{"radius": 2.0}], pull={"speed": 1e5}), Path())
    words = " ".join(warnings(*fast))
    assert "[pull] speed" in words and "[lattice] spacing" in words


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"lattice": {"criterion": "strain"}}, ("[lattice] criterion", "'strain'", "'mixed-mode'")),
        ({"lattice": {"spacing": 5.0}}, ("[lattice] spacing", "5", "at most an eighth")),
        ({"lattice": {"spacing": 1e-3}}, ("[lattice] spacing", "0.001", "at most")),
        ({"hole": [{"radius": 9.0}]}, ("hole[0]", "9", "must lie in the plate")),
        ({"crack": [{"length": 30.0, "angle": 90.0}]}, ("crack[0]", "30", "must lie in the plate")),
        ({"pull": {"elongation": 5.0}}, ("[pull] elongation", "5", "at most a tenth")),
        ({"pull": {"grips": "glued"}}, ("[pull] grips", "'glued'", "'clamped'")),
        ({"lamina": {"material": "carbon_epoxi"}}, ("[lamina] material", "carbon_epoxi", "did you mean")),
        (
            {"lamina": {"material": {"base": "carbon_epoxy", "opening_energy": -1.0}}},
            ("opening_energy", "-1.0", "greater than 0"),
        ),
        (
            {"lamina": {"material": {"base": "carbon_epoxy", "axial_modulus": 10.0}}},
            ("axial_modulus", "10", "transverse_modulus"),
        ),
        ({"pull": {"protected": 20.0}}, ("[pull] protected", "20", "less than half")),
        ({"lamina": {"fibre": 3.0}}, ("[lamina] fibre", "unknown key", "fibre_angle")),
    ],
)  # fmt: skip
def test_bad_input_names_key_value_and_what_is_allowed(
    changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    from pfemcut.case.translate import problem_of
    from pfemcut.inputs import InputError

    with pytest.raises((CaseError, InputError)) as caught:
        problem_of(*validated(table(0.0, **changes), Path()), Path())
    for word in words:
        assert word in str(caught.value)
