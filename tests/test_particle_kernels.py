"""Kernels, neighbours, gradients and stress of explicit particles against what they are exactly."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from particle_problems import ELASTIC, block

from pfemcut.materials.load import load_material
from pfemcut.particles.kernel import SUPPORT, normalisation, shape, shape_slope, slopes, weights
from pfemcut.particles.lattice import box_lattice, cylinder_lattice
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.neighbours import neighbours_within
from pfemcut.particles.small_matrices import determinant, inverse, product, transposed
from pfemcut.particles.stress import (
    PointState,
    cauchy_stress,
    initial_points,
    linear_pressure,
    updated,
    von_mises,
)
from pfemcut.sph.damping import Springs, carried, damping_force, hidden_length
from pfemcut.sph.reference import INSIDE, STEEPEST, Reference, moments, reference_of, steepness
from pfemcut.sph.tlsph import TotalLagrangian
from pfemcut.sph.total_lagrangian import deformation_gradient, internal_force

Array = NDArray[np.float64]
SPACING, SMOOTHING = 0.1, 0.15
CONTROL_ALONE = (SMOOTHING, 0.0, 0.0, 5e6, 1e4)


def irregular(dimension: int, seed: int = 1) -> tuple[Array, Array]:
    """A block of disturbed particles, and their volumes."""
    size = np.array([1.0, 0.7, 0.6])[:dimension]
    points, volume = box_lattice(np.zeros(dimension), size, SPACING)
    random = np.random.default_rng(seed)
    points += random.uniform(-0.2, 0.2, points.shape) * SPACING
    return points, volume * random.uniform(0.9, 1.1, len(points))


def reference(dimension: int, corrected: bool = True) -> Reference:
    points, volume = irregular(dimension)
    return reference_of(points, volume, np.zeros(len(points), dtype=np.int64), SMOOTHING, corrected)


def relaxed(body: Reference) -> Springs:
    """Springs without slip that are strong enough for everything."""
    return Springs(np.zeros(len(body.distance)), np.full(len(body.points), np.inf))


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_kernel_integrates_to_one(dimension: int) -> None:
    """To 1e-6 with the midpoint rule in spherical shells; its slope is its derivative, to 1e-6 of the largest."""
    edges = np.linspace(0.0, SUPPORT * SMOOTHING, 4001)
    radius = 0.5 * (edges[1:] + edges[:-1])
    shell = {1: 2.0 + 0.0 * radius, 2: 2.0 * np.pi * radius, 3: 4.0 * np.pi * radius**2}[dimension]
    value = weights(radius, SMOOTHING, dimension)
    assert np.sum(value * shell * np.diff(edges)) == pytest.approx(1.0, abs=1e-6)
    slope = slopes(radius, SMOOTHING, dimension)
    assert np.allclose(
        np.diff(weights(edges, SMOOTHING, dimension)) / np.diff(edges), slope, atol=1e-6 * np.abs(slope).max()
    )
    q = radius[::100] / SMOOTHING
    scale = normalisation(SMOOTHING, dimension)
    assert np.allclose([scale * shape(each) for each in q], value[::100])
    assert np.allclose([scale / SMOOTHING * shape_slope(each) for each in q], slope[::100])


def test_neighbours_are_all_pairs_of_a_group_from_both_sides() -> None:
    points, _ = irregular(2)
    group = (points[:, 0] > 0.5).astype(np.int64)
    rows = neighbours_within(points, 0.3, group)
    found = set(zip(rows.owners.tolist(), rows.indices.tolist(), strict=True))
    expected = {
        (i, j)
        for i, j in itertools.permutations(range(len(points)), 2)
        if group[i] == group[j] and np.hypot(*(points[i] - points[j])) <= 0.3
    }
    assert found == expected
    assert (rows.indices[rows.reverse] == rows.owners).all()
    assert (rows.reverse[rows.reverse] == np.arange(len(rows.indices))).all()


def test_lattices_have_the_volume_of_their_shapes() -> None:
    points, volume = cylinder_lattice(2.0, 5.0, 0.3)
    assert volume * len(points) == pytest.approx(np.pi * 4.0 * 5.0)
    assert np.hypot(points[:, 0], points[:, 1]).max() < 2.0
    assert np.allclose(points.mean(axis=0), [0.0, 0.0, 2.5])
    points, volume = box_lattice(np.array([1.0, 2.0]), np.array([2.0, 2.55]), 0.1)
    assert volume * len(points) == pytest.approx(0.55)


@pytest.mark.parametrize("dimension", [2, 3])
def test_corrected_gradients_are_exact_for_linear_fields(dimension: int) -> None:
    """To 1e-12 on disturbed particles, at the surface too; without correction they are wrong there by tens of %."""
    exact = np.eye(dimension) + 0.3 * np.random.default_rng(2).normal(size=(dimension, dimension))
    body = reference(dimension)
    found = deformation_gradient(body, body.points @ exact.T + 3.0)
    assert np.abs(found - exact).max() < 1e-12
    plain = reference(dimension, corrected=False)
    assert np.abs(deformation_gradient(plain, plain.points @ exact.T) - exact).max() > 0.1


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("corrected", [True, False])
def test_internal_force_is_minus_the_gradient_of_the_energy(dimension: int, corrected: bool) -> None:
    """Work of the forces on a small displacement against that of the stress on the gradients: the same, to 1e-12."""
    body = reference(dimension, corrected)
    random = np.random.default_rng(3)
    stress = random.normal(size=(len(body.points), dimension, dimension))
    displacement = random.normal(size=body.points.shape)
    force = internal_force(body, stress)
    strain = deformation_gradient(body, body.points + displacement) - np.eye(dimension)
    inner = np.einsum("n,nab,nab->", body.volume, stress, strain)
    assert np.vdot(force, displacement) == pytest.approx(-inner, rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_all_forces_conserve_momentum_and_damping_angular_momentum(dimension: int) -> None:
    """To 1e-13 of the sum of their magnitudes."""
    body = reference(dimension)
    random = np.random.default_rng(4)
    count = len(body.points)
    positions = body.points + 0.02 * random.normal(size=body.points.shape)
    velocities = random.normal(size=positions.shape)
    gradient = deformation_gradient(body, positions)
    mass = 7.8e-9 * body.volume
    springs = Springs(relaxed(body).slip, random.uniform(0.0, 0.02, count))
    density = np.full(count, 7.8e-9)
    viscous, control, slip = damping_force(
        body, positions, velocities, gradient, mass, density, springs, (SMOOTHING, 1.0, 1.0, 5e6, 1e4)
    )
    assert (slip == slip[body.neighbours.reverse]).all()
    internal = internal_force(body, random.normal(size=(count, dimension, dimension)))
    for force in (viscous, control, internal):
        assert np.abs(force).max() > 0.0
        assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    for force in (viscous, control):
        moment = positions[:, 0] * force[:, 1] - positions[:, 1] * force[:, 0]
        assert abs(moment.sum()) < 1e-13 * np.abs(moment).sum()
    assert np.vdot(viscous, velocities) < 0.0


def test_zero_energy_control_does_not_resist_what_gradients_see() -> None:
    body = reference(2)
    exact = np.array([[1.1, 0.2], [-0.1, 0.9]])
    positions = body.points @ exact.T
    gradient = deformation_gradient(body, positions)
    mass = 7.8e-9 * body.volume
    rest = np.zeros_like(positions)
    _, control, _ = damping_force(
        body, positions, rest, gradient, mass, mass / body.volume, relaxed(body), CONTROL_ALONE
    )
    positions[20] += 0.01
    _, shifted, _ = damping_force(
        body, positions, rest, gradient, mass, mass / body.volume, relaxed(body), CONTROL_ALONE
    )
    assert np.abs(control).max() < 1e-10 * np.abs(shifted).max()


def test_springs_of_the_control_slip_at_their_limit() -> None:
    """Each spring bears what is hidden, cut at the smaller limit of the two; the rest has slipped, to 1e-14."""
    body = reference(2)
    random = np.random.default_rng(5)
    positions = body.points + 0.01 * random.normal(size=body.points.shape)
    gradient = deformation_gradient(body, positions)
    limit = np.where(random.uniform(size=len(positions)) < 0.3, np.inf, 0.01)
    slip = 0.001 * random.normal(size=len(body.distance))
    mass = 7.8e-9 * body.volume
    rest = np.zeros_like(positions)
    _, control, new = damping_force(
        body, positions, rest, gradient, mass, mass / body.volume, Springs(slip, limit), CONTROL_ALONE
    )
    hidden = hidden_length(body, positions, gradient)
    rows = body.neighbours
    most = np.minimum(limit[rows.owners], limit[rows.indices]) * body.distance
    borne = np.clip(hidden - slip, -most, most)
    assert (np.abs(hidden - slip) > most).any()
    assert np.abs(hidden - new - borne).max() < 1e-14
    now = positions[rows.indices] - positions[rows.owners]
    far = np.linalg.norm(body.points[rows.indices] - body.points[rows.owners], axis=1)
    kernel = weights(far, SMOOTHING, 2)
    size = CONTROL_ALONE[-1] * body.volume[rows.owners] * body.volume[rows.indices] * kernel * borne / far**2
    pull = size[:, None] * now / np.linalg.norm(now, axis=1)[:, None]
    total = np.column_stack([np.bincount(rows.owners, pull[:, axis]) for axis in range(2)])
    assert np.abs(control - total).max() < 1e-12 * np.abs(total).max()


def test_pairs_keep_their_values_among_new_neighbours() -> None:
    random = np.random.default_rng(6)
    points = random.uniform(size=(60, 2))
    group = np.zeros(60, dtype=np.int64)
    old, new = neighbours_within(points, 0.3, group), neighbours_within(points, 0.25, group)
    other = neighbours_within(points + 0.05 * random.normal(size=points.shape), 0.3, group)
    values = random.normal(size=len(old.indices))
    for rows in (new, other, old, neighbours_within(points, 1e-9, group)):
        table = dict(zip(zip(old.owners, old.indices, strict=True), values, strict=True))
        expected = [table.get(pair, 0.0) for pair in zip(rows.owners, rows.indices, strict=True)]
        assert (carried(values, old, rows) == expected).all()
    assert (carried(values[:0], neighbours_within(points, 1e-9, group), old) == 0.0).all()


@pytest.mark.parametrize("dimension", [2, 3])
def test_small_matrices_are_those_of_numpy(dimension: int) -> None:
    """To 1e-13 of the largest."""
    a, b = np.random.default_rng(7).normal(size=(2, 50, dimension, dimension)) + 2.0 * np.eye(dimension)
    for found, exact in (
        (product(a, transposed(b)), a @ b.transpose(0, 2, 1)),
        (inverse(a), np.linalg.inv(a)),
        (determinant(a), np.linalg.det(a)),
    ):
        assert np.abs(found - exact).max() < 1e-13 * np.abs(exact).max()


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rigid_rotation_gives_no_stress(dimension: int) -> None:
    """A body without stress stays so to round-off, and stress turns with the body to 1e-3 over a quarter turn."""
    material = load_material("aisi4340", Path())
    steps, angle = 500, 0.5 * np.pi / 500
    body = reference(dimension)
    before = np.broadcast_to(np.eye(dimension), (len(body.points), dimension, dimension))
    free, stressed = initial_points(np.full(len(body.points), 293.15)), None
    start = np.tile([200.0, -100.0, -100.0, 50.0, 0.0, 0.0], (len(body.points), 1))
    stressed = PointState(start, free.eqps, free.rate, free.temperature)
    for step in range(1, steps + 1):
        turn = np.eye(dimension)
        c, s = np.cos(step * angle), np.sin(step * angle)
        turn[:2, :2] = [[c, -s], [s, c]]
        after = deformation_gradient(body, body.points @ turn.T)
        rate = (after - before) @ np.linalg.inv(0.5 * (after + before)) / 1e-8
        free, stressed = (
            updated(material, each, rate, 1e-8, np.ones(len(before))).state for each in (free, stressed)
        )
        before = after
    assert np.abs(free.deviator).max() < 1e-6
    expected = np.tile([-100.0, 200.0, -100.0, -50.0, 0.0, 0.0], (len(body.points), 1))
    assert np.abs(stressed.deviator - expected).max() < 1e-3 * 200.0


def test_plasticity_at_a_point_is_the_pfem_s() -> None:
    """Simple shear at a constant rate: the flow stress is the law's at the strain, rate and temperature found."""
    material = load_material("aisi4340", Path())
    rate, dt = 1e4, 1e-8
    state = initial_points(np.array([293.15]))
    gradient = np.array([[[0.0, rate], [0.0, 0.0]]])
    work = 0.0
    for _ in range(2000):
        last = state
        state = updated(material, state, gradient, dt, np.ones(1)).state
        work += float((von_mises(state.deviator) * (state.eqps - last.eqps))[0])
    law = material.hardening.flow_stress(state.eqps, state.rate, last.temperature)
    assert von_mises(state.deviator) == pytest.approx(law.value, rel=1e-9)
    # Elastic strain is small, so plastic strain is nearly gamma / sqrt(3).
    assert state.eqps[0] == pytest.approx(rate * dt * 2000 / np.sqrt(3.0), rel=0.05)
    heat = material.density * material.capacity(np.array([293.15]))[0] * (state.temperature[0] - 293.15)
    assert heat == pytest.approx(0.9 * work, rel=1e-9)


def test_the_threshold_of_the_rate_is_no_trap() -> None:
    """A step so short that the yield point, the chord of the power and the reference rate lie at one strain.

    Newton's method goes back and forth between two strains there, the ends of its bracket.
    """
    spec = {"base": "aisi4340", "young_modulus": 200e3, "poisson_ratio": 0.29}
    material = load_material(spec, Path())
    state = initial_points(np.array([293.15]))
    stretch = 650.7603315202414 / (2.0 * material.shear_modulus * np.sqrt(2.0 / 3.0))
    dt = 5.476752384284857e-09
    gradient = np.diag([2.0, -1.0, -1.0])[None] / 3.0 * stretch / dt
    found = updated(material, state, gradient, dt, np.ones(1)).state
    law = material.hardening.flow_stress(found.eqps, found.rate, state.temperature)
    assert von_mises(found.deviator) == pytest.approx(law.value, rel=1e-9)
    assert 0.0 < found.eqps[0] < 1e-7


def test_pressure_and_stress() -> None:
    pressure = linear_pressure(np.array([1e5]), np.array([0.99]))
    assert pressure[0] == pytest.approx(1e5 * (1.0 / 0.99 - 1.0))
    stress = cauchy_stress(np.array([[1.0, 2.0, -3.0, 4.0, 5.0, 6.0]]), np.array([10.0]), 3)[0]
    assert (stress == [[-9.0, 4.0, 6.0], [4.0, -8.0, 5.0], [6.0, 5.0, -13.0]]).all()
    assert (cauchy_stress(np.array([[1.0, 2.0, -3.0, 4.0, 0.0, 0.0]]), np.array([0.0]), 2)[0]).shape == (2, 2)


def exactness(body: Reference, smoothing: float) -> tuple[Array, Array]:
    """How far K⁻¹ K is from the identity, and the steepness of the corrected gradients over that inside of a body."""
    rows = body.neighbours
    apart = body.points[rows.indices] - body.points[rows.owners]
    product = body.correction @ moments(rows, apart, body.gradient_weight, body.volume)
    steep = steepness(body.correction, rows, apart * body.gradient_weight[:, None], body.volume)
    return np.abs(product - np.eye(apart.shape[1])).max(axis=(1, 2)), smoothing * steep / INSIDE[
        apart.shape[1]
    ]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("smoothing", [1.2, 1.5, 2.0])
def test_a_lattice_is_corrected_in_full(dimension: int, smoothing: float) -> None:
    axes = np.meshgrid(*[np.arange(9.0)] * dimension, indexing="ij")
    points = np.stack(axes, axis=-1).reshape(-1, dimension)
    group = np.zeros(len(points), dtype=np.int64)
    found, steep = exactness(reference_of(points, np.ones(len(points)), group, smoothing, True), smoothing)
    assert found.max() < 1e-12
    assert steep.max() < 0.87 * STEEPEST


def drawn_together() -> Array:
    """Rows of particles 0.25 mm apart, 0.04 mm apart in each, and one pushed out of the first."""
    x, y = np.meshgrid(0.25 * np.arange(6), 0.04 * np.arange(30), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    points[15, 0] -= 0.03
    return points


def test_gradients_are_never_too_steep() -> None:
    points = drawn_together()
    group = np.zeros(len(points), dtype=np.int64)
    body = reference_of(points, np.full(len(points), SPACING**2), group, SMOOTHING, True)
    found, steep = exactness(body, SMOOTHING)
    assert 0.99 * STEEPEST < steep.max() < 1.01 * STEEPEST
    assert found[15] > 0.1
    assert (found[steep < 0.99 * STEEPEST] < 1e-12).all()


def test_a_particle_pushed_out_of_its_surface_keeps_the_energy() -> None:
    """Elastic particles that tremble gain no energy (less than 10 % lost in damping); unbounded 10⁵ times what was."""
    plain = block(material=ELASTIC, end=4e-6, courant=0.5, reference_update=0.0)
    (body,) = plain.bodies
    points = drawn_together()
    velocity = 1e3 * np.random.default_rng(0).normal(size=points.shape)
    trembling = replace(body, points=points, held=np.zeros(points.shape, dtype=bool), velocity=velocity)
    method = ParticleMethod.start(TotalLagrangian(replace(plain, bodies=(trembling,))))
    while not method.finished:
        method.advance()
    assert abs(method.measure().energy_error) < 0.1
