"""Several bodies in one problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from problems import (
    REFERENCE_TEMPERATURE,
    advanced,
    block_problem,
    fixed_x,
    fixed_y,
    heated,
    moving,
    steel,
    voce,
)

from meshing.bodies import joined, renumbered, separated
from pfemcut.materials.material import Property
from pfemcut.problem import Axis, Integrator, Problem


def soft() -> Problem:
    """A block of a soft material that yields, squeezed and heated."""
    material = replace(steel(voce(150.0, 500.0, 1e-3)), young_modulus=7e4, density=2.7e-9)
    material = replace(material, conductivity=Property((300.0, 600.0), (200.0, 150.0)), taylor_quinney=0.5)
    return one_block(material, "a")


def hard() -> Problem:
    material = steel(voce(300.0, 1000.0), poisson_ratio=0.25, expansion=2e-5)
    return one_block(material, "b", 3.0, 900.0)


def one_block(material, suffix: str, shift: float = 0.0, flux: float = 500.0) -> Problem:
    problem = block_problem(
        material=material,
        size=0.25,
        motions=(
            fixed_x("left" + suffix),
            fixed_y("bottom" + suffix),
            moving("top" + suffix, Axis.Y, -200.0),
        ),
        fluxes=(heated("right" + suffix, flux),),
        remesh=True,
        step=1e-5,
        steps=8,
        integrator=Integrator.IMPLICIT,
        tolerance=1e-11,
    )
    body = replace(
        problem.body,
        name=suffix,
        outline=tuple((x + shift, y) for x, y in problem.body.outline),
        parts=tuple(name + suffix for name in problem.body.parts),
    )
    return replace(problem, body=body)


def both(a: Problem, b: Problem) -> Problem:
    return replace(a, others=(b.body,), motions=a.motions + b.motions, fluxes=a.fluxes + b.fluxes)


def test_two_bodies_that_do_not_touch_do_what_each_does_alone() -> None:
    a, b = soft(), hard()
    together = advanced(both(a, b), 8)
    mesh, fields = together.current.mesh, together.current.fields
    ledger = together.current.ledger
    plastic = heat = 0.0
    for alone, particles, cells in zip(
        (advanced(a, 8), advanced(b, 8)), mesh.particle_ranges, mesh.cell_ranges, strict=True
    ):
        state = alone.current
        # The tolerance of Newton's method is one of both bodies' forces together.
        np.testing.assert_allclose(mesh.points[particles], state.mesh.points, atol=1e-9)
        np.testing.assert_allclose(fields.temperature[particles], state.fields.temperature, rtol=1e-8)
        np.testing.assert_allclose(fields.pressure[particles], state.fields.pressure, atol=1e-4)
        np.testing.assert_allclose(fields.eqps[cells], state.fields.eqps, atol=1e-9)
        np.testing.assert_allclose(fields.b_elastic[cells], state.fields.b_elastic, atol=1e-9)
        assert state.fields.eqps.min() > 1e-3
        assert state.fields.temperature.max() > REFERENCE_TEMPERATURE + 1.0
        plastic += state.ledger.plastic
        heat += state.ledger.heat_generated
    assert ledger.plastic == pytest.approx(plastic, rel=1e-8)
    assert ledger.heat_generated == pytest.approx(heat, rel=1e-8)
    own = together.own_measures()
    assert abs(own["heat_error"]) < 1e-9 and abs(own["mass_drift"]) < 1e-3


def test_joined_meshes_come_apart_as_they_were() -> None:
    meshes = [advanced(each, 0).current.mesh for each in (soft(), hard())]
    whole = joined([meshes[0], renumbered(meshes[1], meshes[0].next_id)], [0, 4])
    assert whole.boundary.loops[1].min() >= len(meshes[0].points)
    assert len(np.unique(whole.ids)) == len(whole.points)
    for before, after in zip(meshes, separated(whole, [0, 4]), strict=True):
        np.testing.assert_array_equal(before.points, after.points)
        np.testing.assert_array_equal(before.cells, after.cells)
        np.testing.assert_array_equal(before.boundary.particles, after.boundary.particles)
        np.testing.assert_array_equal(before.boundary.starts, after.boundary.starts)
    assert set(whole.boundary.parts[len(meshes[0].boundary.parts) :]) == {4, 5, 6, 7}


def test_a_body_that_is_not_remeshed_keeps_its_mesh() -> None:
    a, b = soft(), hard()
    problem = both(a, b)
    problem = replace(problem, others=(replace(b.body, remesh=False),))
    start, end = advanced(problem, 0).current.mesh, advanced(problem, 4).current.mesh
    cells = [each.cells[each.first_cells[1] :] - each.first_particles[1] for each in (start, end)]
    np.testing.assert_array_equal(*cells)
    assert end.next_id >= start.next_id
