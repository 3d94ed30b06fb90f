"""Contact of a body with itself: what the search finds, how forces pass, and that runs go on."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from meshing.mesh import Boundary, boundary_area, signed_areas
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.contact.self_search import FacingPoints, facing_points
from pfemcut.method import CutEnded
from pfemcut.pfem.method import PfemMethod
from pfemcut.pfem.self_contact import self_contact_search
from pfemcut.problem import Axis, PrescribedMotion, Problem, Schedule, SelfContact
from tests.launch import mpirun
from tests.problems import (
    REFERENCE_TEMPERATURE,
    SIDES,
    advanced,
    block_problem,
    cut_problem,
    fixed_x,
    fixed_y,
    moving,
    steel,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

THICKNESS = 0.02
SPACING = 0.08


def divided(corners: Array, spacing: float, seed: int = 0) -> Array:
    """The outline with particles about ``spacing`` apart, unevenly."""
    rng = np.random.default_rng(seed)
    sides = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(int(np.hypot(*(b - a)) / spacing), 1)
        place = (np.arange(count) + np.r_[0.0, 0.3 * rng.uniform(-1.0, 1.0, count - 1)]) / count
        sides.append(a + place[:, None] * (b - a))
    return np.vstack(sides)


def jaws(gap: float) -> Array:
    """Corners of a block with a slit of width ``gap`` from x = 0.3 to its right side."""
    low, high = 0.5 - 0.5 * gap, 0.5 + 0.5 * gap
    return np.array([(0, 0), (1, 0), (1, low), (0.3, low), (0.3, high), (1, high), (1, 1), (0, 1)], float)


def search(outline: Array, reach: float = THICKNESS, motion: Array | None = None) -> FacingPoints:
    count = len(outline)
    loop = Boundary(np.arange(count), np.zeros(count, dtype=np.int64), np.array([0, count]))
    motion = np.zeros_like(outline) if motion is None else motion
    return facing_points(outline, loop, np.zeros(count, dtype=np.int64), motion, THICKNESS, reach)


def places(outline: Array, found: FacingPoints) -> Array:
    following = np.roll(outline, -1, axis=0)
    return outline[found.edges] + found.place[:, None] * (following - outline)[found.edges]


@given(seed=st.integers(0, 1000), gap=st.floats(0.005, 0.035))
@settings(max_examples=30, deadline=None)
def test_walls_of_a_slit_face_each_other(seed: int, gap: float) -> None:
    """At the width of the slit, and away from its ends all along; the weights add up to its length.

    Beside the root the nearest point may be too near along the boundary: then it faces one a little farther off.
    """
    outline = divided(jaws(gap), SPACING, seed)
    found = search(outline)
    at = places(outline, found)
    beside_root = at[:, 0] < 0.3 + SPACING
    np.testing.assert_allclose(found.distance[~beside_root], gap, rtol=1e-12)
    assert np.all(found.distance > gap * (1.0 - 1e-12))
    np.testing.assert_allclose(np.abs(at[:, 1] - 0.5), 0.5 * gap, rtol=1e-9)
    for side in (-1.0, 1.0):
        x = at[side * (at[:, 1] - 0.5) > 0.0, 0]
        weight = found.lengths[side * (at[:, 1] - 0.5) > 0.0]
        assert x.max() == pytest.approx(1.0)
        assert 0.7 - 4.0 * SPACING < weight.sum() < 0.7 + 1e-9
        inner = x[(x > 0.6) & (x < 0.99)]
        assert np.diff(np.unique(inner.round(9))).max() < SPACING
    assert np.all(found.thickness(THICKNESS) <= THICKNESS)
    assert np.all(found.thickness(THICKNESS)[at[:, 0] > 0.6] == THICKNESS)


@given(angle=st.floats(0.0, 6.3), x=st.floats(-5.0, 5.0), shift=st.integers(0, 30), mirror=st.booleans())
@settings(max_examples=30, deadline=None)
def test_search_knows_no_place_no_numbering_no_direction(
    angle: float, x: float, shift: int, mirror: bool
) -> None:
    """Moved, turned, mirrored, and numbered from another particle, the same points are found."""
    outline = divided(jaws(0.03), SPACING)
    before = search(outline)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    moved = (outline * [1.0 - 2.0 * mirror, 1.0]) @ turn + x
    other = np.roll(moved, shift, axis=0)
    if mirror:
        other = other[::-1]
    after = search(np.ascontiguousarray(other))
    expected = (places(outline, before) * [1.0 - 2.0 * mirror, 1.0]) @ turn + x
    here = places(other, after)
    assert len(here) == len(expected)
    key = [np.lexsort(points.round(9).T) for points in (here, expected)]
    np.testing.assert_allclose(here[key[0]], expected[key[1]], atol=1e-9)
    assert after.lengths.sum() == pytest.approx(before.lengths.sum(), rel=1e-9)


@given(seed=st.integers(0, 1000), count=st.integers(8, 60))
@settings(max_examples=30, deadline=None)
def test_convex_bodies_and_thin_walls_face_nothing(seed: int, count: int) -> None:
    """Whatever the reach: normals that oppose through the body do not count."""
    rng = np.random.default_rng(seed)
    angle = 2.0 * np.pi * (np.arange(count) + 0.3 * rng.uniform(-1, 1, count)) / count
    for flat in (1.0, 0.01):
        outline = np.column_stack([np.cos(angle), flat * np.sin(angle)])
        assert len(search(outline, reach=10.0).edges) == 0


@pytest.mark.parametrize("opening", [16.0, 40.0, 90.0])
def test_walls_of_an_open_notch_do_not_touch(opening: float) -> None:
    """Down to its root: the distance at which they touch falls with the boundary between them."""
    half = np.radians(0.5 * opening)
    notch = np.array([(0, 0), (2, 0), (2, 1), (1 + 0.9 * np.tan(half), 1), (1, 0.1)], float)
    notch = np.vstack([notch, [(1 - 0.9 * np.tan(half), 1), (0, 1)]])
    found = search(divided(notch, 0.02))
    assert np.all(found.distance > found.thickness(THICKNESS))


def test_a_surface_that_comes_fast_is_seen_before_it_arrives() -> None:
    """Three thicknesses away, and to close three of them in the step: only its motion tells."""
    outline = divided(jaws(3.5 * THICKNESS), SPACING)
    motion = np.where(outline[:, 1:] > 0.5, [0.0, -3.0 * THICKNESS], 0.0)
    assert len(search(outline).edges) == 0
    assert len(search(outline, motion=motion).edges) > 20


def jaws_problem(
    gap: float, size: float, friction: float = 0.0, penalty: float = 1e6, **changes: float
) -> Problem:
    """The slit block, held at the bottom, whose top is pressed down; ``changes`` are those of the block."""
    motions = (fixed_x("bottom"), fixed_y("bottom"), moving("top", Axis.Y, -changes.pop("speed")))
    block = block_problem(size=size, motions=motions, material=steel(poisson_ratio=0.0), **changes)
    outline = tuple((float(x), float(y)) for x, y in jaws(gap))
    parts = ("bottom", "right", "slit", "slit", "slit", "right", "top", "left")
    law = replace(block.contact, penalty=penalty, friction=Coulomb(coefficient=friction))
    return replace(
        block,
        body=replace(block.body, outline=outline, parts=parts, temperature=REFERENCE_TEMPERATURE),
        self_contact=(SelfContact(law, 0.25 * size, size),),
    )


def column_stress(method: PfemMethod, low: float, high: float) -> Array:
    """Vertical stress (MPa) of the elements whose centroids have their x between the limits (mm)."""
    frame = method.frame()
    x = frame.points[frame.cells].mean(axis=1)[:, 0]
    stress: Array = frame.cell_fields["cauchy_stress"][:, 1]
    return stress[(low < x) & (x < high)]


def test_a_slit_that_replaces_the_material_passes_its_stress_on() -> None:
    """Patch test: nu = 0, the slit as wide as the contact thickness d, its penalty E/d that of the material.

    The exact stress is uniform. Particles on the two walls do not match. The stress is uniform to 10 %, its mean to
    1 %, but for half an edge beside the rounded corners at the slit's ends.
    """
    size, strain = 0.1, 3e-4
    width = 0.25 * size
    problem = jaws_problem(
        width, size, penalty=206.9e3 / width, speed=1e5 * strain / 3, remesh=False, step=1e-5, steps=3
    )
    method = advanced(problem, 3)
    uniform = -206.9e3 * strain
    stress = column_stress(method, 0.45, 0.95)
    assert np.abs(stress / uniform - 1.0).max() < 0.1
    assert stress.mean() == pytest.approx(uniform, rel=0.01)
    own = method.own_measures()
    assert own["self_contact_force"] == pytest.approx(-0.7 * uniform, rel=0.1)
    balance = own["reaction_bottom_y"] + own["reaction_top_y"]
    assert abs(balance) < 1e-8 * abs(own["reaction_bottom_y"])


def test_arms_pressed_together_never_cross_and_the_energy_closes() -> None:
    """A slit of 0.03 mm, closed by 0.045 mm, with remeshing: the arms stay apart, and push on each other.

    The energy error is no larger than that of the block without a slit, which its 4.5 % of strain make.
    """
    problem = jaws_problem(0.03, SPACING, speed=500.0, step=1e-5, steps=9)
    square = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    solid = replace(problem, body=replace(problem.body, outline=square, parts=SIDES))
    method = PfemMethod.start(problem)
    forces, nearest = [], []
    for _ in range(9):
        method.advance()
        mesh = method.current.mesh
        (found,) = self_contact_search(problem, mesh, np.zeros_like(mesh.points))
        nearest.append(found.facing.distance.min(initial=np.inf))
        # What the arms enclose is not meshed.
        meshed = signed_areas(mesh.points, mesh.cells).sum()
        assert meshed == pytest.approx(boundary_area(mesh.points, mesh.boundary), rel=1e-12)
        own = method.own_measures()
        forces.append(own["self_contact_force"])
        balance = own["reaction_bottom_y"] + own["reaction_top_y"]
        assert abs(balance) < 1e-7 * abs(own["reaction_bottom_y"])
        # What the springs carry by the distances of the polygons; contact sees the smooth curve.
        closure = np.maximum(found.points.thickness - found.facing.distance, 0.0)
        assert forces[-1] == pytest.approx(1e6 * float(found.points.lengths @ closure), rel=0.05, abs=5.0)
    assert min(nearest) > 0.5 * THICKNESS
    assert forces[0] == 0.0
    assert forces[-1] > 1000.0
    assert abs(method.measure().energy_error) < abs(advanced(solid, 9).measure().energy_error)
    assert own["contact_energy"] > 0.05 * method.measure().elastic_energy
    assert own["step_cuts"] == 0


def test_friction_between_the_arms_takes_work_and_heats() -> None:
    """Pressed and then shifted along each other: friction's work is in both ledgers, and both close."""
    problem = jaws_problem(0.03, SPACING, friction=0.3, speed=500.0, step=1e-5, steps=14)
    pressing = Schedule((0.0, 7e-5, 1e-3), (0.0, -0.035, -0.035))
    shifting = Schedule((0.0, 7e-5, 1e-4, 1e-3), (0.0, 0.0, -0.012, -0.012))
    motions = tuple(
        replace(each, displacement=pressing) if each.part == "top" else each for each in problem.motions
    )
    motions = (*motions, PrescribedMotion("top", Axis.X, shifting))
    problem = replace(problem, motions=motions)
    method = advanced(problem, 7)
    pressed = method.measure()
    for _ in range(7):
        method.advance()
    measures, own = method.measure(), method.own_measures()
    assert pressed.friction_work < 1e-2 * measures.friction_work
    assert measures.friction_work > 1.0
    assert own["heat_generated"] == pytest.approx(measures.friction_work, rel=1e-12)
    assert abs(own["heat_error"]) < 1e-5
    # The shift adds no more than 0.1 % to the error that pressing made.
    assert measures.energy_error == pytest.approx(pressed.energy_error, abs=1e-3)


def test_run_with_self_contact_restarts_bit_for_bit() -> None:
    problem = rubbing_jaws()
    method = advanced(problem, 7)
    assert method.own_measures()["self_contact_force"] > 0.0
    other = PfemMethod.restore(problem, dict(method.state()))
    for each in (method, other):
        each.advance()
        each.advance()
    one, two = method.state(), other.state()
    assert all(np.array_equal(one[name], two[name]) for name in one)
    assert method.own_measures() == other.own_measures()


def cut_under_a_ledge(**self_contact: object) -> Problem:
    """A coarse cut with a ledge above the uncut surface, 0.2 mm from the end face, which the chip meets soon."""
    sizes = {"tip_size": 0.012, "shear_zone_size": 0.03, "chip_size": 0.04, "surface_size": 0.05}
    problem = cut_problem(contact={"self": self_contact}, mesh=sizes, time={"step": 6e-7})
    length, height = 1.2, 0.6
    ledge = [(-0.36, 0.0), (-0.2, 0.04), (-0.2, 0.14), (-0.42, 0.14), (-0.42, 0.0)]
    outline = (
        (0.0, 0.0),
        (length, 0.0),
        (length, height),
        *((length + x, height + y) for x, y in ledge),
        (0.0, height),
    )
    parts = ("bottom", "side", *(["top"] * 6), "fixed")
    return replace(problem, body=replace(problem.body, outline=outline, parts=parts))


@cache
def approached() -> dict[str, NDArray[np.generic]]:
    """The cut shortly before the chip meets the ledge."""
    return dict(advanced(cut_under_a_ledge(), 40).state())


def test_cut_goes_on_after_the_chip_touches() -> None:
    """The chip meets the ledge and pushes it aside: forces, ledgers and area stay sound."""
    method = PfemMethod.restore(cut_under_a_ledge(), approached())
    before = after = 0
    while after < 15:
        method.advance()
        touches = method.own_measures()["self_contact_force"] > 0.0
        before, after = before + (not touches and not after), after + touches
        assert before < 20
    measures, own = method.measure(), method.own_measures()
    assert own["self_contact_force"] > 5.0
    assert 100.0 < measures.cutting_force < 300.0
    assert abs(measures.energy_error) < 0.01
    assert abs(own["heat_error"]) < 0.01
    assert abs(own["area_drift"]) < 1e-10


def test_cut_without_self_contact_ends_at_the_ledge() -> None:
    """With the message that says where, as before."""
    method = PfemMethod.restore(cut_under_a_ledge(enabled=False), approached())
    with pytest.raises(CutEnded, match="touches itself: boundary edges cross near"):
        for _ in range(30):
            method.advance()


RANK_SCRIPT = """
import sys
import numpy as np
from mpi4py import MPI
from tests.problems import advanced
from tests.test_self_contact import rubbing_jaws
method = advanced(rubbing_jaws(), 6)
state = method.state()
assert MPI.COMM_WORLD.size == 2
if MPI.COMM_WORLD.rank == 0:
    np.savez(sys.argv[1], force=method.own_measures()["self_contact_force"], **state)
"""


def rubbing_jaws() -> Problem:
    return jaws_problem(0.03, SPACING, friction=0.1, speed=500.0, step=1e-5, steps=9)


def test_two_ranks_agree_with_one(tmp_path: Path) -> None:
    """The same triangles, and contact force and all fields to 1e-8 of their size."""
    script, result = tmp_path / "press.py", tmp_path / "press.npz"
    script.write_text(RANK_SCRIPT)
    done = mpirun(script, result)
    assert done.returncode == 0, done.stderr
    method = advanced(rubbing_jaws(), 6)
    two, one = np.load(result), method.state()
    assert float(two["force"]) == pytest.approx(method.own_measures()["self_contact_force"], rel=1e-8)
    assert float(two["force"]) > 1000.0
    assert np.array_equal(two["mesh/cells"], one["mesh/cells"])
    for name in ("mesh/points", "fields/pressure", "fields/displacement", "fields/b_elastic"):
        size = np.abs(one[name].astype(float)).max()
        assert np.abs(two[name] - one[name]).max() <= 1e-8 * size, name
