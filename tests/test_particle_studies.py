"""What the studies of particles measure, on clouds that are known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from pfemcut.case.load import load_case
from pfemcut.case.particles import SolidsCase
from pfemcut.case.solids import solids_problem
from pfemcut.inputs import UserError
from pfemcut.particles.lattice import cylinder_lattice
from pfemcut.validation.clouds import Cloud
from pfemcut.validation.particle_cuts import chip_of, cuts, tool_force
from pfemcut.validation.pressing import along, found_bands, middle_layer, pressings
from pfemcut.validation.study import run_study
from pfemcut.validation.taylor import ladder, measured

Array = NDArray[np.float64]
DEMOS = Path(__file__).parent.parent / "demos"


def cloud_of(name: str, spacing: float) -> Cloud:
    """A demo's first body at the start, without strain."""
    case, material = load_case(DEMOS / name / "case.toml", [f"particles.spacing={spacing}"])
    assert isinstance(case, SolidsCase)
    problem = solids_problem(case, material, Path())
    first = problem.ranges[0]
    start = problem.points[first]
    none = np.zeros(len(start))
    fields = {"equivalent_plastic_strain": none, "equivalent_plastic_strain_rate": none}
    return Cloud(problem, 0.0, start, start, fields, problem.points[first.stop :])


def test_a_bar_is_measured_in_three_ways() -> None:
    """Twice as thick and a quarter as long: the nominal diameter doubles, whatever the lattice's edge."""
    start, _ = cylinder_lattice(3.7975, 37.97, 0.5)
    bar = measured(start, start * [2.0, 2.0, 0.25], 3.7975, 0.5)
    assert bar.diameter_stretched == pytest.approx(2.0 * 7.595)
    assert bar.diameter - bar.diameter_centres == pytest.approx(0.5)
    assert bar.diameter_centres == pytest.approx(4.0 * np.hypot(*start[:, :2].T).max())
    assert bar.length_centres == pytest.approx(0.25 * np.ptp(start[:, 2]))
    assert bar.length - bar.length_centres == pytest.approx(0.5)


def test_the_force_on_a_rigid_tool_is_its_power_over_its_speed() -> None:
    time = np.linspace(0.0, 1e-5, 11)
    found, force = tool_force({"time": time, "hold_work": 50e3 * 700.0 * time}, 50e3)
    assert force == pytest.approx(700.0)
    assert found[0] == pytest.approx(0.5e-6)


def test_an_upright_chip_has_its_feed_as_thickness_and_bands_where_they_were_made() -> None:
    """The layer to be cut, turned up at x = 1.5 mm without strain; strain and its rate are made up."""
    cloud = cloud_of("cutting_tlsph", 0.02)
    x, y = cloud.start.T
    lifted = (y > 0.7) & (x > 1.5)
    # What is not cut yet makes room for it.
    ahead = np.column_stack([np.where(y > 0.7, x - 0.5, x), y])
    points = np.where(lifted[:, None], np.column_stack([1.5 - (y - 0.7), 0.7 + (x - 1.5)]), ahead)
    strain = np.where(lifted, 1.0 + 0.5 * np.cos(2.0 * np.pi * (x - 1.8) / 0.3), 0.0)
    across = (points - [1.35, 0.85]) @ [np.sin(np.radians(30.0)), np.cos(np.radians(30.0))]
    rate = 1e5 * np.exp(-0.5 * (across / 0.05) ** 2)
    fields = {"equivalent_plastic_strain": strain, "equivalent_plastic_strain_rate": rate}
    chip = chip_of(replace(cloud, points=points, fields=fields), 0.7)
    assert chip.thickness == pytest.approx(0.3, rel=0.01)
    assert chip.band_angle == pytest.approx(30.0, abs=3.0)
    assert chip.band_width == pytest.approx(2.355 * np.hypot(0.05, 0.02), rel=0.1)
    assert (chip.segments, chip.segment_length) == (4, pytest.approx(0.3, abs=0.02))
    assert chip.regularity.clustered == 0.0
    assert chip.strain_noise < 0.05


def test_bands_of_a_pressed_block_are_looked_for_in_its_middle_layer() -> None:
    cloud = cloud_of("pressing_tlsph", 0.02)
    x, y, z = cloud.start.T
    field = np.exp(-0.5 * ((y - x + 0.25) / np.sqrt(2.0) / 0.04) ** 2)
    field += np.exp(-0.5 * ((y + x - 0.75) / np.sqrt(2.0) / 0.04) ** 2)
    # Of the other layers nothing is taken.
    field[np.abs(z - 0.05) > 0.015] = 9.0
    fields = {"equivalent_plastic_strain_rate": field, "equivalent_plastic_strain": x}
    found, _ = found_bands(replace(cloud, fields=fields), "equivalent_plastic_strain_rate")
    assert sorted(found.angles) == [pytest.approx(45.0, abs=3.0), pytest.approx(135.0, abs=3.0)]
    assert middle_layer(cloud).sum() == 50 * 25
    assert along(replace(cloud, fields=fields), 2) == pytest.approx([0.25, 0.75])


STUDIES = {"taylor": ladder, "cutting": cuts, "pressing": pressings}


@pytest.mark.parametrize("method", ["tlsph", "esph"])
@pytest.mark.parametrize("name", STUDIES)
def test_every_variant_is_a_valid_case(name: str, method: str) -> None:
    study = STUDIES[name](DEMOS / f"{name}_{method}", method)
    for variant in study.variants:
        load_case(study.case, variant.changes)
    names = [variant.name for variant in study.variants]
    assert len(set(names)) == len(names)


def test_a_study_of_no_cut_has_no_travel() -> None:
    study = ladder(DEMOS / "taylor_tlsph", "tlsph")
    with pytest.raises(UserError, match="--travel"):
        run_study(study, ["--travel", "0.1"])
