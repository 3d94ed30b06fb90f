"""Where the Zienkiewicz-Zhu estimator lets the mesh coarsen, and where it must not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from problems import Array, block_problem, rectangle_mesh

from meshing.mesh import Mesh
from meshing.remesh import SpacingFactors
from meshing.sizes import Capsule, SizeField, SizeZone
from pfemcut.pfem.estimators import coarsening_factors
from pfemcut.pfem.state import Fields, initial_fields
from pfemcut.problem import Coarsening, ErrorEstimator

SIZE = 0.1
LARGEST = 3.0
MESH = rectangle_mesh(size=SIZE, jitter=0.2)
UNIFORM = SizeField((), SIZE)
STILL = np.zeros(2)
# Fine at the middle of the left side and coarser to the right.
GRADED = SizeField((SizeZone(Capsule((0.0, 0.5), (0.0, 0.5), 0.0), 0.5 * SIZE, 0.3),), 1.0)


def centres(mesh: Mesh) -> Array:
    return mesh.points[mesh.cells].mean(axis=1)


def fields(eqps: Array | float = 0.5, power: Array | float = 0.0) -> Fields:
    count = len(MESH.cells)
    return replace(
        initial_fields(MESH, 300.0),
        eqps=np.broadcast_to(np.asarray(eqps, dtype=np.float64), (count,)),
        plastic_power=np.broadcast_to(np.asarray(power, dtype=np.float64), (count,)),
    )


def factors(
    body: Fields,
    sizes: SizeField = UNIFORM,
    shift: Array = STILL,
    estimator: ErrorEstimator = ErrorEstimator.PLASTIC_STRAIN,
    tolerance: float = 0.01,
) -> SpacingFactors:
    problem = block_problem(size=SIZE)
    rule = Coarsening(estimator, tolerance, LARGEST)
    problem = replace(problem, particles=replace(problem.particles, coarsening=rule))
    return coarsening_factors(problem, MESH, body, sizes, shift)


def test_without_estimator_the_wished_spacing_holds() -> None:
    found = factors(fields(), estimator=ErrorEstimator.NONE)
    assert np.all(found.removal == 1.0) and np.all(found.insertion == 1.0)


def test_a_uniform_field_at_rest_coarsens_to_the_limit() -> None:
    for estimator in (ErrorEstimator.PLASTIC_STRAIN, ErrorEstimator.STRESS):
        found = factors(fields(), estimator=estimator)
        assert np.all(found.removal == LARGEST) and np.all(found.insertion == LARGEST)


def test_a_jump_keeps_its_particles() -> None:
    """Patches across a jump have an error of about a third of it; two spacings away there is none."""
    found = factors(fields(eqps=np.where(centres(MESH)[:, 0] < 0.5, 0.2, 1.0)))
    away = np.abs(MESH.points[:, 0] - 0.5)
    assert np.all(found.removal[away < 0.3 * SIZE] == 1.0)
    assert np.all(found.removal[away > 3.5 * SIZE] == LARGEST)


def test_flow_keeps_its_particles_and_their_neighbours() -> None:
    flowing = np.hypot(*(centres(MESH) - 0.5).T) < 0.15
    found = factors(fields(power=np.where(flowing, 1e6, 1.0)))
    within = np.zeros(len(MESH.points), dtype=bool)
    within[MESH.cells[flowing]] = True
    next_ring = np.zeros(len(MESH.points), dtype=bool)
    next_ring[MESH.cells[within[MESH.cells].any(axis=1)]] = True
    assert np.array_equal(found.insertion == 1.0, within)
    # The next ring keeps its particles but gets no new ones: hysteresis.
    assert np.array_equal(found.removal == 1.0, next_ring) and next_ring.sum() > within.sum()
    assert np.all(found.removal[~next_ring] == LARGEST)


def test_material_that_a_fine_zone_approaches_keeps_its_particles() -> None:
    """The zone moves right, onto the body; moving left it leaves, and standing still it changes nothing."""
    step = 1e-3
    approached, left, still = (
        factors(fields(), GRADED, np.array([motion, 0.0])) for motion in (step, -step, 0.0)
    )
    ahead = MESH.points[:, 0] > 0.1
    assert np.all(approached.removal[ahead] == 1.0) and np.all(approached.insertion[ahead] == 1.0)
    assert np.all(left.removal[ahead] == LARGEST) and np.all(still.removal[ahead] == LARGEST)


def test_material_that_moves_into_a_fine_zone_keeps_its_particles() -> None:
    inflow = np.tile([-1e-3, 0.0], (len(MESH.points), 1))
    ahead = MESH.points[:, 0] > 0.1
    assert np.all(factors(replace(fields(), last_displacement=inflow), GRADED).removal[ahead] == 1.0)
    slow_drift = 1e-3 * inflow  # beside a zone that moves away fast
    found = factors(replace(fields(), last_displacement=slow_drift), GRADED, np.array([-1e-3, 0.0]))
    assert np.all(found.removal[ahead] == LARGEST)


def test_a_hot_layer_keeps_its_particles() -> None:
    """A layer two spacings thick at the surface of a body whose plastic strain is uniform."""
    y = MESH.points[:, 1]
    found = factors(replace(fields(), temperature=300.0 + 500.0 * np.exp((y - 1.0) / SIZE)))
    assert np.all(found.removal[y > 1.0 - SIZE] == 1.0)
    assert np.all(found.removal[y < 0.2] > 2.0)


def test_a_uniform_temperature_gradient_is_no_error() -> None:
    warm = 300.0 + 500.0 * MESH.points[:, 1]
    assert np.all(factors(replace(fields(), temperature=warm)).removal == LARGEST)


@given(st.integers(0, 10_000), st.floats(0.001, 1.0))
def test_what_is_removed_is_not_asked_for_again(seed: int, tolerance: float) -> None:
    """Any field: removal never goes beyond what a neighbour may have without an insertion."""
    rng = np.random.default_rng(seed)
    eqps = rng.uniform(0.0, 1.0) + rng.uniform(0.0, 1.0, len(MESH.cells)) ** rng.integers(1, 8)
    power = np.where(rng.uniform(size=len(MESH.cells)) < 0.05, 1.0, 0.0)
    found = factors(fields(eqps, power), tolerance=tolerance)
    assert found.removal.min() >= 1.0 and found.insertion.max() <= LARGEST
    for a in range(3):
        for b in range(3):
            assert np.all(found.removal[MESH.cells[:, a]] <= found.insertion[MESH.cells[:, b]])
