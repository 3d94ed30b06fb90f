"""Intervals, correlations and warnings of a calibration, on stand-ins with known parameters."""

from __future__ import annotations

import math

import numpy as np
import pytest
from calibrations import FRICTION, STRENGTH, UNCERTAINTY, Array, calibrated, merchant

from pfemcut.calibrate.confidence import Confidence, confidence_of
from pfemcut.calibrate.fit import Computed, Fit
from pfemcut.calibrate.parameters import Parameter


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Of 100 noisy measurements with noisy models, 95 % intervals of both parameters hold the truth."""
    rng = np.random.default_rng(5)
    true, noise = (0.5, 600.0), 0.3 * UNCERTAINTY
    held = np.zeros(2)
    for _ in range(100):
        measured = merchant(true) + UNCERTAINTY * rng.standard_normal(6)
        _, known, _ = calibrated((FRICTION, STRENGTH), measured, UNCERTAINTY, merchant, noise)
        held += [each.low <= value <= each.high for each, value in zip(known.estimates, true, strict=True)]
    # A share of 95 % of 100 has a standard deviation of 2.2 %; model noise enters search and interval alike.
    assert np.all(held >= 0.88 * 100)
    assert np.all(held <= 99)


def test_intervals_by_hand() -> None:
    """A straight line y = p x: the standard deviation of p is sigma / sqrt(sum x²), without and with model noise."""
    x, sigma = np.array([1.0, 2.0, 3.0]), 0.5
    slope = Parameter("a.b", 0.0, 10.0, 2.0)
    offsets = np.array([0.1, -0.2, 0.1])
    fit, known, _ = calibrated((slope,), 4.0 * x + offsets, np.full(3, sigma), lambda p: p[0] * x)
    (one,) = known.estimates
    assert one.value == pytest.approx(4.0, abs=1e-4)
    assert one.deviation == pytest.approx(sigma / math.sqrt(14.0), rel=1e-6)
    assert one.high - one.value == pytest.approx(1.959964 * one.deviation, rel=1e-5)
    assert known.freedom == 2
    noisy = Fit(fit.point, Computed(fit.computed.values, np.full(3, sigma)), fit.jacobian, True, "", 1)
    (both,) = confidence_of(noisy, (slope,), 4.0 * x, np.full(3, sigma), 0.05, assumed=False).estimates
    assert both.deviation == pytest.approx(math.sqrt(2.0) * one.deviation, rel=1e-6)


def test_a_misfit_that_uncertainties_do_not_explain_widens_intervals_by_students_t() -> None:
    x, slope = np.array([1.0, 2.0, 3.0]), Parameter("a.b", 0.0, 10.0, 2.0)
    measured = 4.0 * x + np.array([3.0, -3.0, 1.0])
    _, known, _ = calibrated((slope,), measured, np.full(3, 0.5), lambda p: p[0] * x)
    (one,) = known.estimates
    residuals = measured - one.value * x
    deviation = math.sqrt(residuals @ residuals / 2.0 / 14.0)
    assert one.deviation == pytest.approx(deviation, rel=1e-4)
    assert one.high - one.value == pytest.approx(4.302653 * deviation, rel=1e-4)
    assert "Student's t, 2 degrees" in known.basis
    assert any("more than the uncertainties explain" in text for text in known.warnings)
    # Uncertainties that are guesses are weights only: the same, whatever they are.
    _, guessed, _ = calibrated((slope,), measured, np.full(3, 50.0), lambda p: p[0] * x, assumed=True)
    assert guessed.estimates[0].deviation == pytest.approx(deviation, rel=1e-4)


def test_parameters_of_which_only_the_product_counts_can_not_be_told_apart() -> None:
    one, two = Parameter("a.a", 0.5, 4.0, 1.0), Parameter("a.b", 0.5, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((one, two), 2.0 * x, np.full(3, 0.02), lambda p: p[0] * p[1] * x)
    assert any("a.a and a.b can't be told apart" in text for text in known.warnings)


def test_nearly_degenerate_parameters_are_warned_of_and_their_intervals_are_wide() -> None:
    one, two = Parameter("a.a", 0.0, 4.0, 1.0), Parameter("a.b", 0.0, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0, 4.0])

    def nearly(p: tuple[float, ...]) -> Array:
        return p[0] * x + p[1] * (x + 0.02 * x**2)

    _, known, _ = calibrated((one, two), nearly((2.0, 1.0)), np.full(4, 0.2), nearly)
    assert known.correlation[0, 1] < -0.95
    assert known.condition > 30.0
    assert sum("can't be told apart" in text for text in known.warnings) == 1
    assert sum("hardly determine" in text for text in known.warnings) == 2


def test_a_parameter_without_effect_is_not_determined() -> None:
    one, two = Parameter("a.a", 0.0, 4.0, 1.0), Parameter("a.b", 0.0, 4.0, 1.0)
    x = np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((one, two), 2.0 * x, np.full(3, 0.2), lambda p: p[0] * x)
    assert math.isinf(known.estimates[1].deviation)
    assert any("hardly determine a.b" in text for text in known.warnings)


def test_warnings_of_bounds_and_of_steps_within_the_noise() -> None:
    slope, x = Parameter("a.b", 0.0, 3.0, 1.0), np.array([1.0, 2.0, 3.0])
    _, known, _ = calibrated((slope,), 4.0 * x, np.full(3, 0.5), lambda p: p[0] * x)
    assert any("ended at its bound 3" in text for text in known.warnings)
    wide = Parameter("a.b", 0.0, 10.0, 2.0)
    fit, _, _ = calibrated((wide,), 4.0 * x, np.full(3, 0.5), lambda p: p[0] * x)
    noisy = Fit(fit.point, Computed(fit.computed.values, np.full(3, 2.0)), fit.jacobian, True, "", 1)
    texts = confidence_of(noisy, (wide,), 4.0 * x, np.full(3, 0.5), 0.05, assumed=False).warnings
    assert any("its derivatives are noise" in text for text in texts)


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1e3, 1e9])
def test_what_is_determined_depends_on_no_unit_and_no_width_of_bounds(factor: float) -> None:
    """The same fit with the second parameter ``factor`` times as large, and with the effect of both so far apart."""
    x, measured = np.array([1.0, 2.0, 3.0, 4.0]), np.array([3.1, 4.9, 7.2, 8.9])

    def known(columns: Array, ranges: tuple[float, float], point: tuple[float, float]) -> Confidence:
        parameters = [
            Parameter(f"a.{name}", 0.0, width, 0.5 * width) for name, width in zip("ab", ranges, strict=True)
        ]
        fit = Fit(point, Computed(columns @ point, np.zeros(4)), columns * ranges / 0.2, True, "", 1)
        return confidence_of(fit, parameters, measured, np.full(4, 0.2), 0.05, assumed=False)

    columns = np.column_stack([x, np.ones(4)])
    plain = known(columns, (4.0, 2.0), (2.0, 1.0))
    # In other units: 1e-3 beside 1e3.
    other = known(columns / [1.0, factor], (4.0, 2.0 * factor), (2.0, 1.0 * factor))
    # With bounds so wide that the second column of the Jacobian is so much longer.
    wide = known(columns, (4.0, 2.0 * factor**2), (2.0, 1.0))
    for each, scale in ((other, factor), (wide, 1.0)):
        assert each.condition == pytest.approx(plain.condition, rel=1e-9)
        assert each.correlation == pytest.approx(plain.correlation, rel=1e-9)
        widths = [one.deviation for one in each.estimates]
        assert widths == pytest.approx(
            [plain.estimates[0].deviation, scale * plain.estimates[1].deviation], rel=1e-9
        )
