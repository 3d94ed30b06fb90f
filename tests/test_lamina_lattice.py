"""The lattice of a lamina: geometry, equal energies, micromodulus, strength, what a crack's tip releases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from pfemcut.particles.neighbours import neighbours_within
from pfemcut.peridynamics.bonds import bonds_of
from pfemcut.peridynamics.crack_tip import elongation_matrix, tip_release
from pfemcut.peridynamics.cracks import cracks, damage, parts
from pfemcut.peridynamics.fracture_mechanics import hoop_stress, start_at_hole
from pfemcut.peridynamics.lamina import strain_rotation, turned_stiffness, young_modulus
from pfemcut.peridynamics.micromodulus import (
    CELL,
    BondStiffness,
    bond_stiffness,
    continuum_micromodulus,
    critical_stretch,
)
from pfemcut.peridynamics.plate import Hole, LineCrack, Plate, lattice_sites
from tests.laminae import CARBON, plate

THICKNESS = 1.5


@pytest.mark.parametrize(
    "strain", [(1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-3), (3e-4, -2e-4, 5e-4)]
)
def test_the_lattice_stores_the_energy_of_the_lamina(strain: tuple[float, float, float]) -> None:
    stiffness = bond_stiffness(CARBON, THICKNESS)
    e11, e22, g12 = strain
    energy = 0.0
    for angle, k in (
        (0.0, stiffness.fibre),
        (np.pi / 3, stiffness.matrix),
        (2 * np.pi / 3, stiffness.matrix),
    ):
        c, s = np.cos(angle), np.sin(angle)
        energy += 0.5 * k * (e11 * c * c + e22 * s * s + g12 * s * c) ** 2 / CELL
    exact = 0.5 * THICKNESS * np.array(strain) @ CARBON.stiffness @ np.array(strain)
    assert energy == pytest.approx(exact, rel=1e-12)


def test_the_micromodulus_of_an_isotropic_sheet_is_the_known_constant() -> None:
    young, horizon = 70e3, 0.9
    q11 = young / (1.0 - 1.0 / 9.0)
    c = continuum_micromodulus((q11, q11 / 3.0, q11), THICKNESS, horizon, np.linspace(0.0, np.pi, 7))
    assert c == pytest.approx(9.0 * young / (np.pi * THICKNESS * horizon**3), rel=1e-12)


def test_the_micromodulus_gives_the_stiffness_back() -> None:
    horizon, angle = 0.9, (np.arange(720) + 0.5) * np.pi / 360.0
    c = continuum_micromodulus((CARBON.q11, CARBON.q12, CARBON.q22), THICKNESS, horizon, angle)
    scale = THICKNESS * horizon**3 / 6.0 * 2.0 * np.pi
    for exact, stretch in (
        (CARBON.q11, np.cos(angle) ** 4),
        (CARBON.q22, np.sin(angle) ** 4),
        (CARBON.q12, np.cos(angle) ** 2 * np.sin(angle) ** 2),
    ):
        assert scale * np.mean(c * stretch) == pytest.approx(exact, rel=1e-10)
    # Why it can't be put on the lattice's bonds.
    assert continuum_micromodulus((CARBON.q11, CARBON.q12, CARBON.q22), 1.0, 1.0, np.array(np.pi / 3)) < 0.0


def test_laminate_theory_has_its_limits() -> None:
    assert young_modulus(CARBON, 0.0) == pytest.approx(120e3)
    assert young_modulus(CARBON, np.pi / 2) == pytest.approx(8600.0)
    g, nu = CARBON.shear_modulus, 1.0 / 3.0
    at_45 = 4.0 / (1 / 120e3 + 1 / 8600.0 + 1 / g - 2 * nu / 120e3)
    assert young_modulus(CARBON, np.pi / 4) == pytest.approx(at_45, rel=1e-12)
    turn = strain_rotation(0.7) @ strain_rotation(-0.7)
    assert turn == pytest.approx(np.eye(3), abs=1e-14)
    assert turned_stiffness(CARBON, 0.4) == pytest.approx(turned_stiffness(CARBON, 0.4 + np.pi), rel=1e-9)


def test_the_stress_at_a_hole_has_its_limits() -> None:
    n = np.sqrt(2.0 * (np.sqrt(120e3 / 8600.0) - 1.0 / 3.0) + 120e3 / CARBON.shear_modulus)
    assert hoop_stress(CARBON, 0.0, np.array(np.pi / 2)) == pytest.approx(1.0 + n)
    sheet = replace(CARBON, axial_modulus=9e3, transverse_modulus=9e3)
    found = hoop_stress(sheet, 0.3, np.array([0.3, 0.3 + np.pi / 2]))
    assert found == pytest.approx([-1.0, 3.0])
    # A pull across the fibre cracks the hole where its edge is straight across the pull; at 45 degrees beside it.
    assert start_at_hole(CARBON, np.pi / 2, 3.0) == pytest.approx((0.0, 3.0), abs=0.01)
    assert start_at_hole(CARBON, np.pi / 4, 3.0) == pytest.approx((1.21, 2.75), abs=0.02)


def test_bonds_at_the_critical_stretch_hold_the_energy_of_the_faces() -> None:
    stiffness, spacing = bond_stiffness(CARBON, THICKNESS), 0.4
    found = critical_stretch(CARBON, stiffness, THICKNESS, spacing, (4.0, 2.25))
    faces = THICKNESS * spacing
    assert stiffness.matrix * (spacing * found.opening) ** 2 == pytest.approx(0.28 * faces)
    assert stiffness.matrix * (spacing * found.shear) ** 2 == pytest.approx(0.8 * faces)
    assert found.growth_opening == pytest.approx(found.opening / 2.0)
    assert found.growth_shear == pytest.approx(found.shear / 1.5)


def test_a_tip_releases_what_the_lattice_loses_without_the_pair() -> None:
    stiffness = BondStiffness(fibre=10.0, matrix=1.0)
    side, crack = 60.0, 20.2
    given = Plate(side, side, 1.0, 0.0, 0.0, (), (LineCrack(crack, 0.0, (0.0, 0.0)),))
    sites = lattice_sites(given, 1.0)
    bonds = bonds_of(given, sites, neighbours_within(sites, 1.1, np.zeros(len(sites), dtype=np.int64)))
    k = np.where(bonds.fibre, 10.0, 1.0) * ~bonds.cut * bonds.once
    middles = 0.5 * (sites[bonds.owners] + sites[bonds.neighbours.indices])
    ahead = bonds.once & (np.abs(middles[:, 1]) < 1e-9) & (middles[:, 0] > 0.5 * crack)
    pair = np.flatnonzero(ahead)[np.argsort(middles[ahead, 0])][:2]
    elongation = elongation_matrix(bonds)
    free = np.repeat((np.abs(sites) < 0.5 * side - 1.0).all(axis=1), 2)

    def solved(k: np.ndarray, strain: np.ndarray) -> tuple[float, np.ndarray]:
        matrix = (elongation.T @ elongation.multiply(k[:, None])).tocsc()
        u = (sites @ strain.T).ravel()
        u[free] = 0.0
        u[free] = spsolve(matrix[free][:, free], -(matrix @ u)[free])
        e = elongation @ u
        return float(0.5 * k @ e**2), e

    without = k.copy()
    without[pair] = 0.0
    for found, strain in zip(
        tip_release(stiffness), (np.diag([0.0, 1.0]), np.array([[0.0, 1.0], [0.0, 0.0]])), strict=True
    ):
        before, e = solved(k, strain)
        after, _ = solved(without, strain)
        assert found == pytest.approx((before - after) / (0.5 * float(e[pair] @ e[pair])), rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 33.0, 45.0, 90.0, -60.0])
def test_the_lattice_fills_the_plate_and_turns_with_the_fibre(angle: float) -> None:
    problem = plate(angle, lattice={"spacing": 0.4})
    area = 16.0 * (24.0 + 4.0 * 0.4)
    assert len(problem.sites) * CELL * 0.4**2 == pytest.approx(area, rel=0.02)
    # Point-symmetric about the middle.
    mirrored = -problem.sites[np.lexsort(np.round(-problem.sites, 6).T)]
    assert mirrored == pytest.approx(problem.sites[np.lexsort(np.round(problem.sites, 6).T)], abs=1e-5)
    bonds = problem.bonds
    between = problem.sites[bonds.neighbours.indices] - problem.sites[bonds.owners]
    assert between == pytest.approx(0.4 * bonds.direction[bonds.family], abs=1e-9)
    turn = np.radians(angle)
    assert bonds.direction[0] == pytest.approx([np.cos(turn), np.sin(turn)])
    inner = np.flatnonzero((np.abs(problem.sites) < [10.0, 6.0]).all(axis=1))
    assert (np.diff(bonds.neighbours.offsets)[inner] == 6).all()


def test_holes_have_no_sites_and_line_cracks_no_bonds() -> None:
    holed = plate(20.0, hole=[{"radius": 3.0, "centre": [1.0, 2.0]}])
    assert np.hypot(*(holed.sites - [1.0, 2.0]).T).min() >= 3.0
    cracked = plate(20.0, crack=[{"length": 6.0, "angle": 90.0}])
    bonds, sites = cracked.bonds, cracked.sites
    one, other = sites[bonds.owners], sites[bonds.neighbours.indices]
    along = one[:, 1] - one[:, 0] * (other[:, 1] - one[:, 1]) / np.where(
        one[:, 0] == other[:, 0], 1.0, other[:, 0] - one[:, 0]
    )
    crossing = (one[:, 0] * other[:, 0] < 0.0) & (np.abs(along) < 3.0)
    assert (bonds.cut == crossing).all() and bonds.cut.any()


def test_damage_parts_and_cracks_of_a_plate_that_is_split_along_the_fibre() -> None:
    problem = plate(0.0)
    bonds, sites = problem.bonds, problem.sites
    row = np.sort(np.unique(np.round(sites[:, 1], 6)))
    level = 0.5 * (row[7] + row[8])
    gone = (sites[bonds.owners, 1] - level) * (sites[bonds.neighbours.indices, 1] - level) < 0.0
    assert parts(bonds, np.zeros_like(gone), problem.inner) == 1
    assert parts(bonds, gone, problem.inner) == 2
    found = damage(bonds, gone)
    touched = np.abs(sites[:, 1] - level) < 0.6
    inside = touched & (np.abs(sites[:, 0]) < 10.0)
    assert found.matrix[inside] == pytest.approx(0.5) and found.total[inside] == pytest.approx(1.0 / 3.0)
    assert not found.fibre.any() and not found.total[~touched].any()
    when = np.where(gone, 1e-6 * (20.0 + sites[bonds.owners, 0] + sites[bonds.neighbours.indices, 0]), np.inf)
    (crack,) = cracks(bonds, sites, when, 1.0)
    assert crack.angle == pytest.approx(0.0, abs=1e-6)
    assert crack.start == pytest.approx((0.5 * (crack.start[0] * 2.0), level), abs=0.01)
    assert crack.start[0] < -12.0 and crack.length == pytest.approx(np.ptp(sites[touched, 0]) - 0.5, abs=0.6)


def test_a_hole_is_where_it_is_asked_for() -> None:
    given = Plate(20.0, 20.0, 1.0, 0.0, 0.3, (Hole(4.0, (2.0, -3.0)),), ())
    sites = lattice_sites(given, 0.5)
    whole = lattice_sites(Plate(20.0, 20.0, 1.0, 0.0, 0.3, (), ()), 0.5)
    missing = len(whole) - len(sites)
    assert missing * CELL * 0.25 == pytest.approx(np.pi * 16.0, rel=0.03)
