"""Two deformable bodies in contact: patch test, Hertz, and heat through the interface."""

from __future__ import annotations

import numpy as np
import pytest

from tests.verification.two_body_heat.verify import rubbed, touched
from tests.verification.two_body_hertz import verify as hertz
from tests.verification.two_body_patch import verify as patch


@pytest.mark.parametrize("slave", [0.07, 0.15])
def test_edges_pass_the_patch_test(slave: float) -> None:
    """Meshes that do not match, either side finer: the stress is uniform to the tolerance of Newton's method."""
    result = patch.pressed(slave)
    stress, pressure = patch.stresses(result)
    uniform = abs(result.history["reaction_bottom_y"][-1])
    assert np.ptp(stress) < 1e-7 * uniform
    assert np.ptp(pressure) < 1e-7 * uniform


def test_nodes_against_segments_do_not_pass_it() -> None:
    """As is known of the method; with the finer side as slave the error stays below a quarter."""
    result = patch.pressed(0.07, "nodes")
    stress, _ = patch.stresses(result)
    spread = np.ptp(stress) / abs(result.history["reaction_bottom_y"][-1])
    assert 0.01 < spread < 0.25


def test_hertz() -> None:
    # Ten particles over the half-width; on finer meshes both come within 0.3 %.
    row = hertz.row_of(hertz.pressed(0.01, steps=5))
    assert abs(row["a_difference"]) < 0.015
    assert abs(row["p0_difference"]) < 0.015


def test_friction_heat_is_shared_by_the_effusivities() -> None:
    _, row = rubbed(0.04, {"time.end": 2e-4})
    assert abs(row["steel_difference"]) < 0.02
    assert abs(row["carbide_difference"]) < 0.02
    assert abs(row["heat_error"]) < 1e-9


def test_conduction_through_the_interface() -> None:
    # The first of the coarse steps is wrong by 4 % of the difference of the temperatures, at half of them by 2 %.
    _, row = touched(0.04)
    assert abs(row["steel_difference"]) < 0.05
    assert row["steel_end"] == pytest.approx(row["steel_exact_end"], rel=0.015)
    assert abs(row["heat_error"]) < 1e-9
