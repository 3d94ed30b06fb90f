"""The search of a calibration on stand-ins with known parameters, and its parameters."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from calibrations import FRICTION, STRENGTH, UNCERTAINTY, Array, Model, calibrated, merchant

from pfemcut.calibrate.fit import Controls, NotComputed
from pfemcut.calibrate.parameters import Parameter, read_parameters
from pfemcut.inputs import InputError


def test_friction_and_strength_of_a_shear_plane_come_back_exactly_from_exact_figures() -> None:
    true = (0.5, 600.0)
    fit, known, evaluate = calibrated((FRICTION, STRENGTH), merchant(true), UNCERTAINTY, merchant)
    assert fit.converged
    # Differences are secants, which end near the minimum: a hundredth of the bounds' range.
    assert fit.point[0] == pytest.approx(true[0], abs=0.01 * 0.85)
    assert fit.point[1] == pytest.approx(true[1], abs=0.01 * 700.0)
    assert [each.low <= value <= each.high for each, value in zip(known.estimates, true, strict=True)] == [
        True,
        True,
    ]
    assert known.warnings == ()
    # Dear runs: few points, none of them twice, and no derivatives for a last step that hardly moves.
    assert len(evaluate.asked) == len(set(evaluate.asked)) <= 14


def test_differences_stay_within_the_bounds_and_are_taken_over_the_rounded_step() -> None:
    near = Parameter("a.b", 0.0, 1.0, 0.98)
    x = np.array([1.0, 2.0])
    for central in (False, True):
        fit, _, evaluate = calibrated(
            (near,), 0.99 * x, np.full(2, 0.01), lambda p: p[0] * x, controls=Controls(central=central)
        )
        assert all(0.0 <= point[0] <= 1.0 for point in evaluate.asked)
        assert fit.jacobian[:, 0] == pytest.approx(x / 0.01, rel=1e-9)


def test_a_point_that_can_not_be_computed_is_avoided_and_a_start_that_can_not_ends_the_search() -> None:
    slope, x = Parameter("a.b", 0.0, 10.0, 1.0), np.array([1.0, 2.0, 3.0])

    def fails(beyond: float) -> Model:
        return lambda p: np.full(3, math.nan) if p[0] > beyond else p[0] ** 0.5 * x

    # The first step, of the slope at the start, goes beyond.
    fit, _, evaluate = calibrated((slope,), math.sqrt(6.0) * x, np.full(3, 0.1), fails(7.0))
    assert fit.point[0] == pytest.approx(6.0, abs=0.1)
    with pytest.raises(NotComputed):
        calibrated((slope,), 2.0 * x, np.full(3, 0.1), fails(0.5))


def test_parameters_from_a_file_and_of_the_material(tmp_path: Path) -> None:
    path = tmp_path / "fit.toml"
    path.write_text(
        '"contact.friction" = {low = 0.1, high = 0.6, start = 0.2}\n'
        "[material.hardening]\nA = {low = 500.0, high = 900.0}\n",
        encoding="utf-8",
    )
    friction, hardening = read_parameters([str(path)])
    assert friction == Parameter("contact.friction", 0.1, 0.6, 0.2)
    assert (hardening.key, hardening.low, hardening.high) == ("workpiece.material.hardening.A", 500.0, 900.0)
    assert math.isnan(hardening.start)
    path.write_text("[contact]\nfriction = 0.3\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"contact\.friction: given 0\.3, must be a table"):
        read_parameters([str(path)])


def test_the_search_ends_with_a_step_below_the_tolerance_in_every_parameter() -> None:
    """One that depends on where the range begins, or on the number of parameters, ended this one a step too early."""
    rng = np.random.default_rng(1)
    slopes, only = rng.standard_normal(4), Parameter("a.b", 0.0, 1.0, 0.1)

    def model(point: tuple[float, ...]) -> Array:
        return slopes * (point[0] ** 2 + 0.3 * point[0] ** 3)

    true = float(rng.uniform(0.3, 0.7))
    measured = model((true,)) + 0.1 * rng.standard_normal(4)
    fit, _, evaluate = calibrated((only,), measured, np.full(4, 0.1), model)
    assert fit.converged
    assert "steps are below 0.002" in fit.ending
    # The last two points are the last two of the search: no difference is taken where it hardly moves.
    assert abs(evaluate.asked[-1][0] - evaluate.asked[-2][0]) < 0.002


def test_central_differences_take_both_sides_unless_a_bound_is_nearer_than_their_step() -> None:
    x = np.array([1.0, 2.0])
    for start, central, sides in ((0.5, True, {0.45, 0.55}), (0.5, False, {0.55}), (0.97, True, {0.92})):
        only = Parameter("a.b", 0.0, 1.0, start)
        _, _, evaluate = calibrated(
            (only,), start * x, np.full(2, 0.01), lambda p: p[0] * x, controls=Controls(central=central)
        )
        assert {point[0] for point in evaluate.asked} == {start, *sides}


def test_values_near_bounds_that_are_near_to_each_other_are_told_apart_and_stay_within() -> None:
    narrow = Parameter("a.b", 1000.0, 1000.002, 1000.001)
    assert narrow.value(0.25) == 1000.0005
    assert narrow.value(0.3) != narrow.value(0.3001)
    uneven = Parameter("a.b", 0.123456789, 0.987654321, 0.5)
    assert [uneven.value(end) for end in (0.0, 1.0)] == [0.123457, 0.987654]
    upper = Parameter("a.b", 0.1, 0.1234567, 0.11)
    assert upper.value(1.0) == 0.1234567
    # As before where six digits do.
    assert Parameter("a.b", 0.05, 0.6, 0.1).value(1.0 / 3.0) == 0.233333
    x = np.array([1.0, 2.0, 3.0])
    fit, _, _ = calibrated((narrow,), 1000.0016 * x, np.full(3, 1e-4), lambda p: p[0] * x)
    assert fit.point[0] == pytest.approx(1000.0016, abs=1e-6)
