"""Valid inputs that make no physical sense are flagged by ``pfemcut check``, each by its own words; demos are not."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from problems import SHORT_CUT

from meshing.sizes import Capsule, SizeField, SizeZone
from pfemcut import load_case
from pfemcut.case.particle_count import LARGEST_COUNT, particle_estimate
from pfemcut.case.plausible import implausible
from pfemcut.inputs import InputError
from pfemcut.problem import Problem

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mesh.tip_size": 0.02}, "resolves the tip radius of 0.025 mm poorly"),
        ({"time.step": 1e-6}, r"\[time\] step moves the tool by 0.00333 mm"),
        ({"time.largest_step": 4e-6}, "largest_step moves the tool by more .* at most 2.4e-06 s"),
        ({"cutting.depth": 0.02}, "ploughs more than it cuts"),
        ({"cutting.depth": 0.004}, "below a fifth of the tip radius: no chip"),
        ({"workpiece.temperature": 1900.0}, "1900 K, is not below 1793 K, where 'workpiece' melts"),
        ({"tool.temperature": 2500.0}, "temperature of the tool, 2500 K, is not below 1793 K"),
        ({"workpiece.temperature": 20.0}, "temperature of 'workpiece', 20, is in K: did you mean 293.15"),
        ({"cutting.speed": 1e6}, r"speed, 1e\+06 mm/s, is above 10% of the speed of elastic waves .* 5.06e\+06 mm/s"),
        ({"cutting.speed": 1e5}, "inertial stress rho v² = 78.* MPa is above 2% .* inertia = true"),
        ({"contact.penalty": 1e5}, r"penalty = 100000 MPa/mm is soft: .* sink 0.024 mm .* advised: at least 3e\+06"),
        ({"contact.penalty": 1e12}, "above 100 times Young's modulus over the finest spacing"),
        ({"contact.friction": 1.5}, r"\[contact\] friction = 1.5 is above 1"),
        ({"contact.friction": {"law": "coulomb", "coefficient": 1.2}}, "friction = 1.2 is above 1"),
        ({"contact.self": {"friction": 1.2}}, r"\[contact.self\] friction = 1.2 is above 1"),
        ({"time.step": 1e-11}, r"about 1.5e\+07 steps"),
        ({"mesh.tip_size": 2e-5, "mesh.shear_zone_size": 1e-4, "mesh.growth": 0.05}, "particles at the start"),
        ({"mesh.chip_size": 4e-4}, r"the chip has about 3.6e\+05 particles at the end"),
        ({"workpiece.material": {"base": "aisi4340", "density": 7.8e-8}}, "density = 7.8e-08 is far from"),
        ({"workpiece.material": {"base": "aisi4340", "capacity": 460.0}}, "capacity = 460 is far from .* 1e6 of"),
        ({"workpiece.material": {"base": "aisi4340", "conductivity": 45000.0}}, "conductivity = 45000 is far from"),
        ({"workpiece.material": {"base": "aisi4340", "expansion": 0.012}}, "expansion = 0.012 is far from"),
        ({"workpiece.material": {"base": "aisi4340", "young_modulus": 210.0}}, "are both in MPa"),
    ],
)  # fmt: skip
def test_what_makes_no_physical_sense_is_flagged(changes: dict, words: str) -> None:
    found = load_case(SHORT_CUT, changes).warnings()
    plain = load_case(SHORT_CUT).warnings()
    new = [text for text in found if text not in plain]
    assert any(re.search(words, text) for text in new), new
    assert all("\n" not in text for text in found)


def test_inertia_stops_the_warning_of_missing_inertia() -> None:
    case = load_case(SHORT_CUT, {"cutting.speed": 1e5, "time.inertia": True})
    assert not any("rho v²" in text for text in case.warnings())


@pytest.mark.parametrize("path", sorted(ROOT.glob("demos/*/case.toml")), ids=lambda path: path.parent.name)
def test_published_and_measured_cases_raise_no_false_alarm(path: Path) -> None:
    case = load_case(path)
    problem = case.problem()
    assert (implausible(problem) if isinstance(problem, Problem) else case.warnings()) == []


def test_a_general_problem_is_looked_at_too() -> None:
    case = load_case(ROOT / "tests/verification/hertz/case.toml", {"body.0.temperature": 20.0})
    assert any("did you mean 293.15" in text for text in case.warnings())


def test_more_particles_than_could_be_run_are_refused() -> None:
    for changes in ({"mesh.far_size": 1e-4}, {"mesh.chip_size": 1e-5}):
        case = load_case(SHORT_CUT, changes)
        with pytest.raises(InputError, match="more than 2 million particles in '(workpiece|the chip)'"):
            case.problem()


def test_counting_stops_at_a_limit_and_not_before() -> None:
    assert particle_estimate(SizeField((), 1e-300), 1.0, 1.0) == math.inf
    assert particle_estimate(SizeField((), 1.0), 1e300, 1e300) == math.inf
    spot = SizeZone(Capsule((0.5, 0.5), (0.5, 0.5), 0.01), 1e-12, 0.1)
    assert particle_estimate(SizeField((spot,), 0.1), 1.0, 1.0) == math.inf
    size = (1.1547 / (0.5 * LARGEST_COUNT)) ** 0.5
    assert particle_estimate(SizeField((), size), 1.0, 1.0) == pytest.approx(0.5 * LARGEST_COUNT, rel=0.01)


def test_where_a_block_lies_does_not_change_its_count() -> None:
    spot = SizeZone(Capsule((0.5, 0.5), (0.5, 0.5), 0.0), 0.01, 0.1)
    moved = SizeZone(Capsule((7.5, -2.5), (7.5, -2.5), 0.0), 0.01, 0.1)
    here = particle_estimate(SizeField((spot,), 0.2), 1.0, 1.0)
    assert particle_estimate(SizeField((moved,), 0.2), 1.0, 1.0, (7.0, -3.0)) == pytest.approx(here, rel=1e-9)


@pytest.mark.parametrize("value", [1e31, -1e31, 1e-31, 5e-324, 1.7e308, 10**400])
def test_numbers_that_cannot_be_computed_with_are_refused(value: float) -> None:
    with pytest.raises(InputError, match="reference_speed: given"):
        load_case(SHORT_CUT, {"contact.reference_speed": value})


def test_numbers_at_the_ends_are_computed_with() -> None:
    for value in (1e-30, 1e30):
        load_case(SHORT_CUT, {"contact.reference_speed": value}).problem()
