"""Contact of a body with itself in total-Lagrangian SPH: what folds touches, what flows stays joined."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from particle_problems import ELASTIC, block

from pfemcut.particles.frames import frame_of, joined
from pfemcut.particles.method import ParticleMethod
from pfemcut.particles.problem import ParticleProblem
from pfemcut.sph.connectivity import Connectivity, connectivity, renewed_connectivity
from pfemcut.sph.tlsph import Deformation, TotalLagrangian
from pfemcut.sph.touching import TouchingPairs

Array = NDArray[np.float64]

SPACING, REACH = 0.1, 0.3
NONE = np.empty((0, 2), dtype=np.int64)


def lattice(*counts: int) -> Array:
    axes = [SPACING * (np.arange(count) + 0.5) for count in counts]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(counts))


def one_body(points: Array) -> Connectivity:
    return connectivity(points, REACH, np.zeros(len(points), dtype=np.int64), NONE)


def renewed(old: Connectivity, points: Array) -> Connectivity:
    return renewed_connectivity(old, points, REACH, np.zeros(len(points), dtype=np.int64))


def fork() -> ParticleProblem:
    """A fork of elastic metal whose two prongs move towards each other with up to 150 m/s."""
    x, y = lattice(24, 14).T
    inside = (x < 0.4) | (y < 0.5) | (y > 0.9)
    points = np.column_stack([x, y])[inside]
    reach = np.maximum(points[:, 0] - 0.4, 0.0) / 2.0
    velocity = np.column_stack([0.0 * reach, -1.5e5 * np.sign(points[:, 1] - 0.7) * reach**2])
    plain = block(material=ELASTIC, end=6e-6, alpha=0.0, beta=0.0, batch=5, reference_update=0.03)
    (body,) = plain.bodies
    bent = replace(body, points=points, velocity=velocity, held=np.zeros(points.shape, dtype=bool))
    return replace(plain, bodies=(bent,))


def in_touch(method: ParticleMethod[Any]) -> bool:
    return bool(np.abs(method.current.loads.between).max() > 0.0)


def across(pairs: Any, upper: NDArray[np.bool_]) -> int:
    """Entries between the prongs, away from where they meet."""
    return int(np.count_nonzero(upper[pairs.owners] != upper[pairs.indices]))


@pytest.fixture(scope="module")
def course() -> list[ParticleMethod[Deformation]]:
    """The fork's run after each batch, and at time zero."""
    model = TotalLagrangian(fork())
    method = ParticleMethod.start(model)
    states = [method]
    while not method.finished:
        method = ParticleMethod(model, method.current)
        method.advance()
        states.append(method)
    return states


def test_prongs_of_one_body_bounce_off_each_other(course: list[ParticleMethod[Deformation]]) -> None:
    """They touch, never nearer than 0.6 spacings, and part again; energy to 1 %, momentum to 1e-12.

    The reference is renewed while they are in touch, and never joins them.
    """
    start = course[0].current.positions
    free = start[:, 0] > 0.8
    upper, lower = free & (start[:, 1] > 0.7), free & (start[:, 1] < 0.7)
    gaps = [
        min(
            float(np.hypot(*(x[lower] - point).T).min())
            for point in x[upper][np.argsort(x[upper][:, 1])[:20]]
        )
        for x in (each.current.positions for each in course)
    ]
    touching = [k for k, each in enumerate(course) if in_touch(each)]
    updates = [each.current.clock.updates for each in course]
    assert touching
    assert updates[touching[-1]] > updates[touching[0]]
    assert 0.6 * SPACING < min(gaps) < SPACING
    assert gaps[-1] > 2.0 * SPACING
    assert not in_touch(course[-1])
    for each in course:
        pairs = each.current.memory.reference.neighbours
        prongs = upper.astype(int) - lower.astype(int)
        assert (prongs[pairs.owners] * prongs[pairs.indices] >= 0).all()
        assert abs(each.measure().energy_error) < 0.01
        assert each.own_measures()["momentum_error"] < 1e-12
    stored = min(each.own_measures()["pinball_work"] for each in course)
    supply = 0.5 * float(fork().mass @ (fork().velocities ** 2).sum(axis=1))
    assert stored < -0.01 * supply
    # Hertz's force has a potential: what the contact took it gives back.
    assert abs(course[-1].own_measures()["pinball_work"]) < 0.02 * abs(stored)


def test_a_run_goes_on_bit_for_bit_in_touch_with_itself(course: list[ParticleMethod[Deformation]]) -> None:
    near = [k for k, each in enumerate(course) if in_touch(each)]
    middle = near[len(near) // 2]
    arrays = {name: np.array(array) for name, array in course[middle].state().items()}
    assert len(arrays["reference/apart"]) > 0
    method = ParticleMethod.restore(TotalLagrangian(fork()), arrays)
    while not method.finished:
        method.advance()
    for name, array in course[-1].state().items():
        assert np.array_equal(method.state()[name], array), name


def test_what_older_checkpoints_hold_is_all_joined(course: list[ParticleMethod[Deformation]]) -> None:
    arrays = dict(course[0].state())
    del arrays["reference/apart"]
    memory = TotalLagrangian(fork()).restored(arrays)
    assert len(memory.reference.connectivity.apart_pairs) == 0
    same = course[0].current.memory.reference.neighbours
    assert np.array_equal(memory.reference.neighbours.indices, same.indices)


def test_no_triangle_joins_what_only_touches(course: list[ParticleMethod[Deformation]]) -> None:
    closest = next(each for each in course if in_touch(each))
    problem = fork()
    x = closest.current.positions
    start = problem.points
    prong = np.where(start[:, 0] > 0.8, np.sign(start[:, 1] - 0.7), 0.0)
    bridging = joined(x, 1.6 * SPACING)
    assert (np.ptp(prong[bridging], axis=1) == 2.0).any()
    cut = replace(problem, cut=("a cut",))  # type: ignore[arg-type]
    cells = frame_of(TotalLagrangian(cut), closest.current, 0.0).cells
    assert len(cells) > 0.9 * len(joined(start, 0.8 * SPACING))
    assert not (np.ptp(prong[cells], axis=1) == 2.0).any()


@pytest.mark.parametrize("counts", [(24, 24), (10, 10, 10)], ids=["plane", "space"])
@pytest.mark.parametrize("step", [0.5, 1.4], ids=["usual", "late"])
def test_shear_without_end_keeps_all_neighbours(counts: tuple[int, ...], step: float) -> None:
    """Simple shear by 10, and a slip by 30 spacings: nothing comes apart, also with updates that come late.

    Between updates the farthest neighbours are displaced by ``step`` spacings relative to each other; the default
    update comes at 0.75.
    """
    points = lattice(*counts)
    for height, most in ((points[:, 1], 10.0), (REACH * (points[:, 1] > 0.5 * points[:, 1].max()), 10.0)):
        found = one_body(points)
        for shear in np.arange(0.0, most, step * SPACING / REACH):
            moved = points.copy()
            moved[:, 0] += shear * height
            found = renewed(found, moved)
        full = one_body(moved)
        assert len(found.apart.indices) == 0
        assert (found.neighbours.indices == full.neighbours.indices).all()


@pytest.mark.parametrize("closing", [40, 1000], ids=["fast", "slowly"])
def test_a_closed_notch_does_not_heal(closing: int) -> None:
    """The flanks of a notch close on to each other and stay so for thirty updates.

    However slowly they close, no neighbours are across but within three supports of the kernel from its root; with one
    common neighbour being enough the whole notch heals, like a zip.
    """
    points = lattice(40, 40)
    upper = points[:, 1] > 2.0
    # Opened by up to half a right angle about the middle of the left side.
    found = None
    for angle in np.concatenate([np.linspace(0.5, 0.0, closing), np.zeros(30)]):
        moved = points.copy()
        moved[:, 1] += np.where(upper, 1.0, -1.0) * angle * np.maximum(points[:, 0] - 0.3, 0.0)
        found = one_body(moved) if found is None else renewed(found, moved)
    assert found is not None
    rows = found.neighbours
    joint = points[rows.owners, 0][upper[rows.owners] != upper[rows.indices]]
    assert joint.max() < 0.3 + 3.0 * REACH
    assert len(found.apart.indices) > 0


def test_apart_is_all_that_a_checkpoint_needs() -> None:
    points = np.concatenate([lattice(6, 6), lattice(6, 6) + [0.0, 1.0]])
    closed = points - np.outer(points[:, 1] > 0.8, [0.0, 0.35])
    found = renewed(one_body(points), closed)
    group = np.zeros(len(points), dtype=np.int64)
    again = connectivity(closed, REACH, group, found.apart_pairs)
    assert len(found.apart_pairs) > 0
    for pairs, same in ((found.neighbours, again.neighbours), (found.apart, again.apart)):
        assert (pairs.offsets == same.offsets).all()
        assert (pairs.indices == same.indices).all()


def test_what_is_squeezed_does_not_touch_itself() -> None:
    """All pairs that touch at half the size are those of different bodies, or apart."""
    points = lattice(8, 8)
    body = np.zeros(len(points), dtype=np.int64)
    pairs = TouchingPairs(SPACING, body, body)
    pairs.follow(0.5 * points, one_body(points))
    assert len(pairs.indices) == 0
    halves = (points[:, 0] > 0.4).astype(np.int64)
    pairs = TouchingPairs(SPACING, halves, halves)
    pairs.follow(0.5 * points, connectivity(points, REACH, halves, NONE))
    owners = np.repeat(np.arange(len(points)), np.diff(pairs.offsets))
    assert len(owners) > 0
    assert (halves[owners] != halves[pairs.indices]).all()
    # A rigid body's particles have no neighbours, and still don't touch each other.
    each = np.arange(len(points))
    pairs = TouchingPairs(SPACING, body, each)
    pairs.follow(0.5 * points, connectivity(points, REACH, each, NONE))
    assert len(pairs.indices) == 0
