"""Cutting off the end of a chip: what is left keeps every bit, what goes is booked."""

from __future__ import annotations

import numpy as np
import pytest
from problems import cut_problem, start_on, with_fields

from meshing.initial import outline_mesh
from meshing.mesh import Mesh, boundary_area, signed_areas
from meshing.severing import crossing, loop_after, sever
from meshing.sizes import SizeField
from pfemcut.pfem import energies
from pfemcut.pfem.chip_cut_off import cut_off_chip
from pfemcut.pfem.method import PfemMethod
from pfemcut.problem import Problem

WIDTH = 0.15
LENGTH = 1.0
"""Length of the chip above the tip (mm)."""


def problem(chip_length: float | None, *, inertia: bool = False) -> Problem:
    cutting = {} if chip_length is None else {"chip_length": chip_length}
    return cut_problem(cutting=cutting, time={"inertia": inertia})


def chip_mesh(of: Problem) -> Mesh:
    """The workpiece with a straight chip that stands on the rake face of the tool (rake 0)."""
    (width, _), (_, height) = of.body.outline[1], of.body.outline[2]
    foot = of.tool[0].shape.rake_tangent_point
    right, left = float(foot[0]), float(foot[0]) - WIDTH
    corners = [
        (0.0, 0.0),
        (width, 0.0),
        (width, foot[1]),
        (right, foot[1] + LENGTH),
        (left, foot[1] + LENGTH),
        (left, height),
        (0.0, height),
    ]
    return outline_mesh(np.array(corners), SizeField((), 0.03), np.array([0, 1, 1, 1, 2, 2, 3]))


def cut_off(chip_length: float | None, *, inertia: bool = False) -> tuple[PfemMethod, PfemMethod]:
    """The run before and after, with a temperature and a plastic strain that vary from place to place; it moves."""
    of = problem(chip_length, inertia=inertia)
    method = start_on(of, chip_mesh(of))
    points, cells = method.current.mesh.points, method.current.mesh.cells
    middles = points[cells].mean(axis=1)
    method = with_fields(
        of,
        method,
        temperature=300.0 + 100.0 * points[:, 1],
        pressure=50.0 * np.sin(5.0 * points[:, 1]),
        eqps=middles[:, 1],
        last_displacement=1e-4 * points,
    )
    state = cut_off_chip(of, method.current)
    after = with_fields(of, method)
    after._state = state
    return method, after


def test_a_long_chip_is_cut_at_its_length() -> None:
    """On the rake side to an edge of 0.03 mm; the path across climbs no more than its two edges."""
    before, after = cut_off(0.6)
    tip = before._problem.tool[0].shape.rake_tangent_point
    points = after.current.mesh.points
    on_rake_side = np.abs(points[:, 0] - tip[0]) < 1e-9
    assert abs(points[on_rake_side, 1].max() - tip[1] - 0.6) < 0.03
    assert abs(points[:, 1].max() - tip[1] - 0.6) < 0.06
    assert len(after.current.mesh.points) < len(before.current.mesh.points)


def test_what_is_left_keeps_every_bit() -> None:
    before, after = cut_off(0.6)
    old, new = before.current, after.current
    stays = np.isin(old.mesh.ids, new.mesh.ids)
    assert np.array_equal(old.mesh.points[stays], new.mesh.points)
    assert np.array_equal(old.fields.temperature[stays], new.fields.temperature)
    triples = {
        tuple(sorted(old.mesh.ids[cell])): value
        for cell, value in zip(old.mesh.cells, old.fields.eqps, strict=True)
    }
    assert all(
        triples[tuple(sorted(new.mesh.ids[cell]))] == value
        for cell, value in zip(new.mesh.cells, new.fields.eqps, strict=True)
    )


def test_the_boundary_encloses_the_elements_and_keeps_its_parts() -> None:
    before, after = cut_off(0.6)
    mesh = after.current.mesh
    areas = signed_areas(mesh.points, mesh.cells)
    assert areas.min() > 0.0
    assert boundary_area(mesh.points, mesh.boundary) == pytest.approx(areas.sum(), rel=1e-12)
    assert len(np.unique(mesh.boundary.particles)) == len(mesh.boundary.particles)
    for part in (0, 3):
        old = before.current.mesh.boundary
        assert np.count_nonzero(mesh.boundary.parts == part) == np.count_nonzero(old.parts == part)


def test_mass_energy_and_heat_of_what_goes_are_booked() -> None:
    """To round-off."""
    before, after = cut_off(0.6)
    of, ledger = before._problem, after.current.ledger
    for name, amount in (
        ("cut_off_mass", energies.mass),
        ("cut_off_heat", energies.heat_content),
        ("cut_off_energy", energies.elastic_energy),
    ):
        gone = amount(of, before.current.mesh, before.current.fields) - amount(
            of, after.current.mesh, after.current.fields
        )
        assert gone > 0.0
        assert getattr(ledger, name) == pytest.approx(gone, rel=1e-10)
    # start_on keeps the mass of the problem's own block.
    assert after.own_measures()["mass_drift"] == pytest.approx(before.own_measures()["mass_drift"], abs=1e-12)
    assert after.own_measures()["cut_off_mass"] == ledger.cut_off_mass


def test_with_inertia_the_kinetic_energy_of_what_goes_is_booked_too() -> None:
    """So the ledger's error stays; without inertia kinetic energy does not count."""
    (_, still), (before, after) = cut_off(0.6), cut_off(0.6, inertia=True)
    kinetic = before.measure().kinetic_energy - after.measure().kinetic_energy
    assert kinetic > 0.1 * before.measure().kinetic_energy
    booked = after.current.ledger.cut_off_energy - still.current.ledger.cut_off_energy
    assert booked == pytest.approx(kinetic, rel=1e-9)


@pytest.mark.parametrize("chip_length", [None, 0.9, 1.5, 4.0])
def test_a_shorter_chip_stays(chip_length: float | None) -> None:
    """Not a quarter longer than its length, or no limit given."""
    before, after = cut_off(chip_length)
    assert after.current is before.current
    assert ("cut_off_mass" in after.own_measures()) == (chip_length is not None)


def test_a_path_crosses_the_body_inside_alone() -> None:
    """In a strip from one long side to the other: about its width, with no boundary particle but its ends."""
    mesh = outline_mesh(
        np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 0.2), (0.0, 0.2)]), SizeField((), 0.04), np.arange(4)
    )
    boundary = mesh.boundary
    at = mesh.points[boundary.particles]
    start = int(np.argmin(np.hypot(*(at - [1.0, 0.0]).T)))
    top = np.flatnonzero(np.abs(at[:, 1] - 0.2) < 1e-12)
    ways = np.full(len(top), 2.2)
    path = crossing(mesh, start, top, ways, 1.0)
    assert path is not None
    assert 0.2 <= path.length < 0.26
    assert not np.isin(path.particles[1:-1], boundary.particles).any()
    left = sever(mesh, path)
    assert boundary_area(left.mesh.points, left.mesh.boundary) == pytest.approx(0.2, rel=0.1)
    assert left.mesh.points[:, 0].max() < 1.1
    assert loop_after(boundary, start)[0] == start
    assert crossing(mesh, start, top, ways, 0.15) is None
    assert crossing(mesh, start, top, 0.1 * ways, 1.0) is None
