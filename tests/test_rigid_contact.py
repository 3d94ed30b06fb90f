"""The rigid tool's geometry, and contact forces with their stiffness."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import Array

from pfemcut.contact.friction_laws.base import LawModel
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.contact.friction_laws.norton_hoff import NortonHoff
from pfemcut.contact.friction_laws.power import PowerLaw
from pfemcut.contact.friction_laws.usui import Usui
from pfemcut.contact.penalty import ContactForces, contact_forces, facing_lengths
from pfemcut.problem import ContactLaw, MovingTool
from pfemcut.tools.rigid_wedge import RigidWedge

RADIUS = 0.025
RAKES = [-10.0, 0.0, 6.0, 15.0]
CENTRE = (0.4, -0.2)
STEP = 1e-7
seeds = st.integers(0, 2**31)
rakes = st.sampled_from(RAKES)


def wedge(rake: float) -> RigidWedge:
    return RigidWedge(CENTRE, rake, 5.0, RADIUS)


def near_surface(tool: RigidWedge, seed: int, depth: float = 0.4, height: float = 1.0) -> Array:
    """Points from ``depth`` below to ``height`` above the surface (in tip radii), all along it."""
    rng = np.random.default_rng(seed)
    count = 20
    along = rng.uniform(-1.0, 1.0, count)
    above = RADIUS * (1.0 + rng.uniform(-depth, height, count))
    angle = rng.uniform(0.0, tool.arc_angle, count)
    n, t = tool.rake_normal, -tool.rake_direction
    arc = above[:, None] * (np.cos(angle)[:, None] * n + np.sin(angle)[:, None] * t)
    rake = above[:, None] * n + 0.3 * np.abs(along)[:, None] * tool.rake_direction
    flank = above[:, None] * tool.flank_normal + 0.3 * np.abs(along)[:, None] * tool.flank_direction
    return np.asarray(CENTRE) + np.vstack([arc, rake, flank])


@pytest.mark.parametrize("rake", RAKES)
def test_directions_and_normals_are_orthonormal(rake: float) -> None:
    tool = wedge(rake)
    for along, normal in ((tool.rake_direction, tool.rake_normal), (tool.flank_direction, tool.flank_normal)):
        assert np.array([along @ along, normal @ normal, along @ normal]) == pytest.approx([1.0, 1.0, 0.0])
    # Rake face leans back for a positive rake, and the flank rises behind the tip.
    assert np.sign(tool.rake_direction[0]) == np.sign(rake)
    assert tool.rake_normal[0] < 0.0 < tool.flank_direction[1]
    # The rake normal turned through the arc is the flank normal.
    cosine = tool.rake_normal @ tool.flank_normal
    assert cosine == pytest.approx(np.cos(tool.arc_angle), abs=1e-14)


@pytest.mark.parametrize("rake", RAKES)
def test_outline_has_no_gap(rake: float) -> None:
    """Zero to 1e-15 mm at the outline's points, and the outline is as long as said."""
    tool = wedge(rake)
    outline = tool.outline(0.5)
    assert np.abs(tool.closest(outline).gap).max() < 1e-15
    assert np.diff(tool.arc_length(outline)).max() < 0.0
    assert tool.arc_length(outline[[0, -1]]) == pytest.approx(
        [0.5, -RADIUS * tool.arc_angle - 0.5], rel=1e-12
    )


@pytest.mark.parametrize("rake", RAKES)
def test_lowest_point_of_the_tip_is_one_radius_below_its_centre(rake: float) -> None:
    bottom = np.array([[CENTRE[0], CENTRE[1] - RADIUS]])
    assert wedge(rake).closest(bottom).gap == pytest.approx([0.0], abs=1e-16)
    assert wedge(rake).closest(bottom).normal[0] == pytest.approx([0.0, -1.0], abs=1e-14)


@given(seeds, rakes)
def test_gap_is_the_distance_to_the_outline(seed: int, rake: float) -> None:
    """Against the nearest of 40 000 outline points; the sign from the side of the surface (2e-6 mm)."""
    tool = wedge(rake)
    points = near_surface(tool, seed)[::6]
    outline = tool.outline(0.6, segments=2000)
    a, b = outline[:-1], outline[1:]
    along = np.einsum("kcx,cx->kc", points[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=1)
    foot = a + np.clip(along, 0.0, 1.0)[..., None] * (b - a)
    distance = np.hypot(*(points[:, None] - foot).transpose(2, 0, 1)).min(axis=1)
    assert np.abs(tool.closest(points).gap) == pytest.approx(distance, abs=2e-6)


@given(seeds, rakes)
def test_normal_is_the_gradient_of_the_gap(seed: int, rake: float) -> None:
    """Central differences of 1e-7 mm, to 1e-6."""
    tool = wedge(rake)
    points = near_surface(tool, seed)
    h = 1e-7
    gradient = np.column_stack(
        [(tool.closest(points + d).gap - tool.closest(points - d).gap) / (2.0 * h) for d in h * np.eye(2)]
    )
    assert np.allclose(gradient, tool.closest(points).normal, rtol=0.0, atol=1e-6)


@given(seeds, rakes)
def test_curvature_is_how_the_normal_turns(seed: int, rake: float) -> None:
    """dn/dx = curvature t t^T, by differences, away from the tangent points where it jumps."""
    tool = wedge(rake)
    points = near_surface(tool, seed)
    found = tool.closest(points)
    tangent = np.column_stack([-found.normal[:, 1], found.normal[:, 0]])
    h = 1e-7
    ahead, behind = tool.closest(points + h * tangent), tool.closest(points - h * tangent)
    smooth = (ahead.curvature > 0.0) == (behind.curvature > 0.0)
    turn = np.sum((ahead.normal - behind.normal) * tangent, axis=1) / (2.0 * h)
    assert np.allclose(turn[smooth], found.curvature[smooth], rtol=1e-5, atol=1e-6)


@given(rakes, st.floats(-1.0, 1.0))
def test_gap_normal_and_arc_length_are_continuous_where_faces_meet_the_tip(rake: float, above: float) -> None:
    tool = wedge(rake)
    reach = RADIUS * (1.0 + 0.5 * above)
    for normal, along in (
        (tool.rake_normal, tool.rake_direction),
        (tool.flank_normal, tool.flank_direction),
    ):
        base = np.asarray(CENTRE) + reach * normal
        pair = np.array([base + 1e-10 * along, base - 1e-10 * along])
        found = tool.closest(pair)
        assert found.gap[0] == pytest.approx(found.gap[1], abs=1e-14)
        assert np.allclose(found.normal[0], found.normal[1], rtol=0.0, atol=1e-7)
        arc = tool.arc_length(pair)
        assert arc[0] == pytest.approx(arc[1], abs=1e-9)
    assert tool.arc_length(tool.rake_tangent_point[None]) == pytest.approx([0.0], abs=1e-12)


def test_moving_tool_carries_its_surface_along() -> None:
    tool = MovingTool(wedge(6.0), (-3330.0, 10.0))
    shift = np.array([-3330.0, 10.0]) * 1e-4
    points = near_surface(wedge(6.0), 0)
    assert tool.at(1e-4).closest(points + shift).gap == pytest.approx(
        wedge(6.0).closest(points).gap, abs=1e-14
    )
    assert wedge(6.0).moved(shift).closest(points + shift).gap == pytest.approx(
        wedge(6.0).closest(points).gap, abs=1e-14
    )


FRICTIONS = [
    Coulomb(coefficient=0.0),
    Coulomb(coefficient=0.1),
    Coulomb(coefficient=0.5),
    Usui(law="usui", coefficient=0.5, exponent=1.7),
    PowerLaw(law="power", coefficient=0.3, speed_exponent=-0.1, pressure_exponent=-0.2),
    NortonHoff(law="norton-hoff", coefficient=6e-5, exponent=0.7),
]
frictions = st.sampled_from(FRICTIONS)


def law(friction: LawModel) -> ContactLaw:
    return ContactLaw(penalty=4e7, friction=friction, reference_speed=1.0, heat_partition=0.5)


def forces_on(
    tool: RigidWedge, friction: LawModel, positions: Array, slip: Array, lengths: Array
) -> ContactForces:
    """Forces on particles of 600 K that yield at 800 MPa."""
    count = len(positions)
    return contact_forces(
        tool,
        law(friction),
        positions,
        slip,
        lengths,
        STEP,
        np.full(count, 900.0),
        np.full(count, 600.0),
        np.full(count, 800.0),
    )


def random_contact(
    seed: int, rake: float, friction: LawModel, speed: float
) -> tuple[ContactForces, ContactForces]:
    """Stiffness and its central differences; slip of the order of ``speed`` (mm/s)."""
    tool = wedge(rake)
    rng = np.random.default_rng(seed)
    positions = near_surface(tool, seed, depth=0.01, height=0.002)
    slip = speed * STEP * rng.normal(size=positions.shape)
    lengths = rng.uniform(0.004, 0.02, len(positions))

    def forces(shift: Array) -> ContactForces:
        return forces_on(tool, friction, positions + shift, slip + shift, lengths)

    # The regularised friction changes over 1 mm/s, 1e-7 mm a step: differences must be well below.
    h = 1e-10
    columns = [(forces(d).forces - forces(-d).forces) / (2.0 * h) for d in h * np.eye(2)]
    return forces(np.zeros(2)), np.stack(columns, axis=2)


@given(seeds, rakes, frictions, st.sampled_from([0.3, 3.0, 3000.0]))
def test_stiffness_is_minus_the_derivative_of_the_force(
    seed: int, rake: float, friction: LawModel, speed: float
) -> None:
    """On faces and arc, sticking and slipping, to 1e-5 of the particle's own stiffness."""
    found, difference = random_contact(seed, rake, friction, speed)
    # Differences straddle the surface, or the tangent points, at hardly any point; leave those few out.
    clear = np.abs(found.gap) > 1e-8
    error = np.abs(found.stiffness + difference).max(axis=(1, 2))
    size = np.abs(difference).max(axis=(1, 2)) + 1.0
    assert np.all(error[clear] <= 1e-5 * size[clear])


def test_stiffness_test_meets_all_branches() -> None:
    tool = wedge(6.0)
    positions = near_surface(tool, 0, depth=0.01, height=0.002)
    closest = tool.closest(positions)
    inside = closest.gap < 0.0
    assert {True, False} == set(inside.tolist())
    assert {True, False} == set((closest.curvature[inside] > 0.0).tolist())


@given(
    seeds,
    rakes,
    st.floats(0.0, 1.0).map(lambda value: round(value, 9)),
    st.sampled_from([0.1, 1.0, 3000.0]),
)
def test_coulombs_bound_and_dissipation(seed: int, rake: float, coefficient: float, speed: float) -> None:
    """|shear| <= mu normal, opposed to the slip, friction power never negative, nothing without contact."""
    found, _ = random_contact(seed, rake, Coulomb(coefficient=coefficient), speed)
    assert np.all(found.normal_force >= 0.0)
    assert np.all(np.abs(found.shear_force) <= coefficient * found.normal_force * (1.0 + 1e-14))
    assert np.all(found.friction_power >= 0.0)
    assert found.friction_power == pytest.approx(np.abs(found.shear_force * found.slip_speed))
    free = found.gap >= 0.0
    for each in (found.forces, found.stiffness, found.normal_force, found.friction_power, found.energy):
        assert not each[free].any()


@pytest.mark.parametrize("rake", RAKES)
def test_force_does_not_depend_on_the_spacing(rake: float) -> None:
    """A plate pressed 1e-5 mm into the rake face feels eps g L, however many particles share L."""
    tool = wedge(rake)
    for count in (3, 30):
        s = np.linspace(0.1, 0.3, count)
        positions = tool.rake_tangent_point + np.outer(s, tool.rake_direction) - 1e-5 * tool.rake_normal
        lengths = np.full(count, 0.2 / (count - 1))
        lengths[[0, -1]] *= 0.5
        found = forces_on(tool, FRICTIONS[0], positions, np.zeros_like(positions), lengths)
        assert found.forces.sum(axis=0) == pytest.approx(4e7 * 1e-5 * 0.2 * tool.rake_normal, rel=1e-9)
        assert found.energy.sum() == pytest.approx(0.5 * 4e7 * 1e-10 * 0.2, rel=1e-9)


def test_normal_force_is_the_gradient_of_the_stored_energy() -> None:
    tool = wedge(0.0)
    positions = near_surface(tool, 5, depth=0.01, height=0.0)
    lengths, h = np.full(len(positions), 0.01), 1e-9

    def energy(shift: Array) -> Array:
        return forces_on(tool, FRICTIONS[0], positions + shift, 0.0 * positions, lengths).energy

    gradient = np.column_stack([(energy(d) - energy(-d)) / (2.0 * h) for d in h * np.eye(2)])
    forces = forces_on(tool, FRICTIONS[0], positions, 0.0 * positions, lengths).forces
    assert np.allclose(forces, -gradient, rtol=1e-4, atol=1e-4 * np.abs(forces).max())


def test_only_what_faces_the_tool_counts() -> None:
    # A square under a flat face: its corners count half the top edge, and nothing of the sides.
    tool = RigidWedge((-1.0, 2.0), 0.0, 0.0, 1.0)
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0), (0.0, 1.0)])
    edges = np.column_stack([np.arange(5), np.roll(np.arange(5), -1)])
    assert facing_lengths(tool, square, edges) == pytest.approx([0.0, 0.0, 0.25, 0.5, 0.25])
