"""Contact between meshed surfaces: continuity of the curve, balance of forces, exact tangent."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from meshing.mesh import Boundary
from pfemcut.contact.node_to_segment import ContactPoints, SurfaceContact, surface_contact
from pfemcut.contact.surface import Arcs, BodySurface, surface_arcs

Array = NDArray[np.float64]
PENALTY, STEP, COULOMB, REFERENCE = 4e4, 1e-3, 0.3, 20.0


def polygon(count: int = 24, radius: float = 1.0, noise: float = 0.0) -> tuple[Array, Boundary]:
    rng = np.random.default_rng(1)
    angle = 2 * np.pi * (np.arange(count) + noise * rng.uniform(-1, 1, count)) / count
    points = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return points, Boundary(np.arange(count), np.zeros(count, dtype=np.int64), np.array([0, count]))


def coulomb(pressure: Array, speed: Array, _: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    ratio = np.tanh(speed / REFERENCE)
    return COULOMB * pressure * ratio, COULOMB * ratio, COULOMB * pressure * (1 - ratio**2) / REFERENCE


def pressed(smooth: bool, thickness: float = 0.0) -> tuple[Arcs, ContactPoints, Array, Array]:
    """Points just inside an uneven polygon, or less than ``thickness`` off it: nodes, and points of slave edges."""
    rng = np.random.default_rng(3)
    points, boundary = polygon(noise=0.3)
    arcs = surface_arcs(points, boundary, np.array([0]), smooth)
    angle = rng.uniform(0, 2 * np.pi, 40)
    slave = (1.03 if thickness else 0.93) * np.column_stack([np.cos(angle), np.sin(angle)])
    positions = np.vstack([points, slave])
    first = len(points) + np.arange(0, 40, 2)
    particles = np.column_stack([first, first + 1])
    particles[:10, 1] = particles[:10, 0]
    share = np.where(np.arange(20) < 10, 1.0, rng.uniform(0.9, 1.0, 20))
    shares = np.column_stack([share, np.where(np.arange(20) < 10, 0.0, 1 - share)])
    at = np.einsum("kb,kbi->ki", shares, positions[particles])
    candidates = BodySurface(arcs, positions).nearest_arcs(at)
    lengths = rng.uniform(0.5, 1.5, 20)
    displacement = 0.02 * rng.standard_normal(positions.shape)
    thick = np.full(20, thickness)
    return arcs, ContactPoints(particles, shares, lengths, candidates, thick), positions, displacement


def contact(arcs: Arcs, points: ContactPoints, positions: Array, displacement: Array) -> SurfaceContact:
    return surface_contact(arcs, points, positions, displacement, STEP, PENALTY, coulomb)


def nodal(found: SurfaceContact, count: int) -> Array:
    total = np.zeros((count, 2))
    np.add.at(total, found.particles, found.forces)
    return total


@pytest.mark.parametrize("thickness", [0.0, 0.2])
@pytest.mark.parametrize("smooth", [True, False])
def test_tangent_is_the_derivative_of_the_forces(smooth: bool, thickness: float) -> None:
    arcs, points, positions, displacement = pressed(smooth, thickness)
    found = contact(arcs, points, positions, displacement)
    assert len(found.points) >= 15
    # Points at a kink of the polygon have no derivative: leave out those whose foot is an end of an edge.
    inside = (found.foot.t > 1e-3) & (found.foot.t < 1 - 1e-3)
    assert inside.sum() >= 10
    points = ContactPoints(
        *(
            each[found.points[inside]]
            for each in (
                points.particles,
                points.shares,
                points.lengths,
                points.candidates,
                points.thickness,
            )
        )
    )
    found = contact(arcs, points, positions, displacement)
    count = len(positions)
    exact = np.zeros((count, 2, count, 2))
    for particles, stiffness in zip(found.particles, found.stiffness, strict=True):
        for i, a in enumerate(particles):
            for j, b in enumerate(particles):
                exact[a, :, b, :] -= stiffness[i, :, j, :]
    numeric = np.zeros_like(exact)
    h = 1e-6
    for b in range(count):
        for j in range(2):
            shift = np.zeros_like(positions)
            shift[b, j] = h
            after = nodal(contact(arcs, points, positions + shift, displacement + shift), count)
            before = nodal(contact(arcs, points, positions - shift, displacement - shift), count)
            numeric[:, :, b, j] = (after - before) / (2 * h)
    assert np.abs(exact - numeric).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.parametrize("smooth", [True, False])
def test_tangent_is_symmetric_without_friction(smooth: bool) -> None:
    arcs, points, positions, displacement = pressed(smooth, 0.2)

    def none(pressure: Array, *_: object) -> tuple[Array, Array, Array]:
        return 0.0 * pressure, 0.0 * pressure, 0.0 * pressure

    found = surface_contact(arcs, points, positions, displacement, STEP, PENALTY, none)
    inside = (found.foot.t > 1e-3) & (found.foot.t < 1 - 1e-3)
    stiffness = found.stiffness[inside].reshape(-1, 10, 10)
    assert len(stiffness) >= 10
    assert np.abs(stiffness - stiffness.transpose(0, 2, 1)).max() < 1e-12 * np.abs(stiffness).max()


@pytest.mark.parametrize("thickness", [0.0, 0.2])
@pytest.mark.parametrize("smooth", [True, False])
def test_forces_balance_and_friction_takes_their_power(smooth: bool, thickness: float) -> None:
    """Momentum, moment of momentum and power, to round-off, at whatever distance the surfaces touch."""
    arcs, points, positions, displacement = pressed(smooth, thickness)
    found = contact(arcs, points, positions, displacement)
    assert len(found.points) >= 15
    scale = np.abs(found.forces).max()
    assert np.abs(found.forces.sum(axis=1)).max() < 1e-13 * scale
    at = positions[found.particles]
    moment = np.sum(at[..., 0] * found.forces[..., 1] - at[..., 1] * found.forces[..., 0], axis=1)
    inside = (found.foot.t > 1e-3) & (found.foot.t < 1 - 1e-3)
    assert inside.sum() >= 10
    assert np.abs(moment[inside]).max() < 1e-9 * scale
    shear = np.einsum("kai,kai->k", found.forces, displacement[found.particles]) / STEP
    _, slope, _ = arcs.at(found.foot.arc, found.foot.t)
    tangent = np.einsum("ka,kai->ki", slope, positions[arcs.nodes[found.foot.arc]])
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]
    slip = np.einsum("ka,kai->ki", found.shape, displacement[found.particles])
    pushing = found.normal_force * np.sum(slip * normal, axis=1) / STEP
    np.testing.assert_allclose(pushing - shear, found.friction_power, rtol=1e-9, atol=1e-9 * scale)
    assert (found.friction_power >= 0).all()


@pytest.mark.parametrize("smooth", [True, False])
def test_rigid_rotation_does_not_slip(smooth: bool) -> None:
    """Also where the surfaces are apart by the contact thickness."""
    arcs, points, positions, _ = pressed(smooth, 0.2)
    spin = 1e-3 * np.column_stack([-positions[:, 1], positions[:, 0]])
    found = contact(arcs, points, positions, spin)
    inside = (found.foot.t > 1e-3) & (found.foot.t < 1 - 1e-3)
    assert np.abs(found.slip_speed[inside]).max() < 1e-9 * np.abs(spin).max() / STEP


def test_force_is_continuous_where_a_point_passes_from_arc_to_arc() -> None:
    points, boundary = polygon()
    arcs = surface_arcs(points, boundary, np.array([0]))
    angle = np.linspace(0.0, 1.0, 2001)
    queries = 0.95 * np.column_stack([np.cos(angle), np.sin(angle)])
    surface = BodySurface(arcs, points)
    closest = surface.closest(queries)
    turn = np.arccos(np.clip(np.sum(closest.normal[1:] * closest.normal[:-1], axis=1), -1, 1))
    # One step of the angle is 5e-4; at a corner of the polygon the normal would turn by 0.26.
    assert turn.max() < 1.5e-3
    # The curve lies a sagitta inside the polygon's corners, all along.
    np.testing.assert_allclose(closest.gap, -0.05 + (1 - np.cos(np.pi / 24)), atol=1.5e-3)
    np.testing.assert_allclose(closest.curvature, 1 / 0.95, rtol=0.08)


def test_straight_unevenly_divided_surface_is_exactly_straight() -> None:
    x = np.array([0.0, 0.1, 0.15, 0.4, 0.42, 1.0])
    points = np.vstack([np.column_stack([x, 0 * x]), [(1.0, -1.0), (0.0, -1.0)]])[::-1].copy()
    boundary = Boundary(np.arange(8), np.array([1, 1, 0, 0, 0, 0, 0, 1]), np.array([0, 8]))
    arcs = surface_arcs(points, boundary, np.array([0]))
    queries = np.column_stack([np.linspace(0.0, 1.0, 101), np.full(101, -0.01)])
    foot = BodySurface(arcs, points).foot(queries)
    np.testing.assert_allclose(foot.gap[~foot.beyond], -0.01, atol=1e-14)
    outside = BodySurface(arcs, points).foot(np.array([[-0.2, 0.1], [1.2, -0.1]]))
    assert outside.beyond.all() and (outside.gap > 0).all()
