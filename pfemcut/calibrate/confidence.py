"""How well a fit knows its parameters: intervals, correlations, and which can't be told apart.

With the Jacobian J of the weighted residuals at the fit, and P = (JᵀJ)⁻¹Jᵀ, the covariance of the parameters is
P (I + N) Pᵀ: I stands for the measured figures, which have unit variance after weighting, N for the noise of the
computed ones over the window (its standard deviation is an upper bound of that of the mean). If the misfit is larger
than both explain (chi-squared test at 5 %), the covariance is scaled by the misfit per degree of freedom, and intervals
take Student's t instead of the normal distribution (Seber and Wild 1989, Nonlinear Regression, chapters 2 and 5).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm, t

from pfemcut.calibrate.fit import Fit
from pfemcut.calibrate.parameters import Parameter

Array = NDArray[np.float64]

LEVEL = 0.95
IMPLAUSIBLE = 0.05
"""A misfit that is less likely than this is not explained by the uncertainties."""
LARGEST_CORRELATION = 0.95
LARGEST_CONDITION = 30.0
"""Of the Jacobian with columns of unit length; above, columns are strongly collinear (Belsley, Kuh, Welsch 1980)."""
AT_BOUND = 0.01
"""Part of the range that a parameter is away from its bound, at most, to be called at the bound."""
_SINGULAR = 1e-10


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter.

    Attributes
    ----------
    parameter
        The parameter.
    value
        Its fitted value.
    deviation
        Standard deviation; inf if the measurements don't determine it.
    low, high
        Ends of the 95 % interval, not cut at the bounds.
    """

    parameter: Parameter
    value: float
    deviation: float
    low: float
    high: float


@dataclass(frozen=True)
class Confidence:
    """What is known of a fit.

    Attributes
    ----------
    estimates
        Of the parameters.
    correlation
        Of their errors; shape (parameters, parameters), nan where they are not determined.
    condition
        Of the Jacobian with columns of unit length.
    misfit
        Sum of squares of the differences over the uncertainties of both measured and computed figures.
    freedom
        Degrees of freedom: figures less parameters.
    plausibility
        Probability of a larger misfit if the uncertainties are right; nan without degrees of freedom.
    basis
        What the intervals rest on, in words.
    warnings
        What a user of the parameters must know.
    """

    estimates: tuple[Estimate, ...]
    correlation: Array
    condition: float
    misfit: float
    freedom: int
    plausibility: float
    basis: str
    warnings: tuple[str, ...]


def confidence_of(
    fit: Fit,
    parameters: Sequence[Parameter],
    measured: Array,
    uncertainties: Array,
    difference: float,
    *,
    assumed: bool,
) -> Confidence:
    """Intervals and correlations of a fit.

    Parameters
    ----------
    fit, parameters, measured, uncertainties
        See :func:`pfemcut.calibrate.fit.fitted`.
    difference
        Step of its differences, as a part of the bounds' range.
    assumed
        Whether some uncertainties are guesses: then they are only weights, and the misfit alone sets the scale.
    """
    jacobian, count = fit.jacobian, len(parameters)
    noise = np.nan_to_num(fit.computed.deviations) / uncertainties
    residuals = (fit.computed.values - measured) / uncertainties
    misfit = float(np.sum(residuals**2 / (1.0 + noise**2)))
    freedom = len(measured) - count
    plausibility = float(chi2.sf(misfit, freedom)) if freedom else math.nan
    scale, quantile = 1.0, float(norm.ppf(0.5 + LEVEL / 2.0))
    basis = "the given uncertainties and the scatter over the window (normal distribution)"
    poor = freedom > 0 and plausibility < IMPLAUSIBLE
    if freedom and (poor or assumed):
        scale, quantile = misfit / freedom, float(t.ppf(0.5 + LEVEL / 2.0, freedom))
        basis = f"the misfit (Student's t, {_degrees(freedom)})"

    # Columns of unit length, so that neither units nor bounds of the parameters decide what is determined.
    lengths, units = _unit_columns(jacobian)
    singular = np.linalg.svd(units, compute_uv=False)
    condition = float(singular[0] / singular[-1]) if singular[-1] > 0.0 else math.inf
    if singular[-1] > _SINGULAR * max(float(singular[0]), 1.0):
        inverse = np.linalg.pinv(units)
        covariance = scale * (inverse * (1.0 + noise**2)) @ inverse.T
        widths = np.sqrt(np.diag(covariance))
        correlation = covariance / np.outer(widths, widths)
        deviations = widths / lengths
    else:
        deviations, correlation = np.full(count, math.inf), np.full((count, count), math.nan)
    estimates = tuple(
        Estimate(each, value, width, value - quantile * width, value + quantile * width)
        for each, value, width in zip(
            parameters,
            fit.point,
            (float(d) * (p.high - p.low) for d, p in zip(deviations, parameters, strict=True)),
            strict=True,
        )
    )
    warnings = [
        *([] if fit.converged else [f"the search {fit.ending}"]),
        *_blurred(parameters, correlation, condition, jacobian),
        *_loose(estimates, jacobian, noise, difference),
    ]
    if poor:
        warnings.append(
            f"the computed figures differ from the measured ones by more than the uncertainties explain "
            f"(misfit {misfit:.3g} with {_degrees(freedom)}, probability {plausibility:.2g}): "
            "the model lacks something, or uncertainties are too small"
        )
    if not freedom:
        warnings.append("as many parameters as figures: whether the model fits can't be told")
        if assumed:
            warnings.append("intervals rest on assumed uncertainties")
    return Confidence(
        estimates, correlation, condition, misfit, freedom, plausibility, basis, tuple(warnings)
    )


def _blurred(
    parameters: Sequence[Parameter], correlation: Array, condition: float, jacobian: Array
) -> list[str]:
    """Warnings of parameters that can't be told apart."""
    found = []
    count = len(parameters)
    _, units = _unit_columns(jacobian)
    for one in range(count):
        for other in range(one + 1, count):
            # Where the covariance is singular, the columns themselves tell.
            value = correlation[one, other]
            value = -float(units[:, one] @ units[:, other]) if math.isnan(value) else float(value)
            if abs(value) > LARGEST_CORRELATION:
                found.append(
                    f"{parameters[one].key} and {parameters[other].key} can't be told apart by these figures "
                    f"(correlation {value:+.3f}): fix one, or measure what tells them apart"
                )
    if not found and condition > LARGEST_CONDITION:
        found.append(
            f"combinations of the parameters can't be told apart by these figures (condition {condition:.3g})"
        )
    return found


def _loose(estimates: Sequence[Estimate], jacobian: Array, noise: Array, difference: float) -> list[str]:
    """Warnings of parameters at their bounds, hardly constrained, or lost in the noise."""
    found = []
    for index, each in enumerate(estimates):
        parameter, width = each.parameter, each.parameter.high - each.parameter.low
        position = parameter.scaled(each.value)
        if min(position, 1.0 - position) < AT_BOUND:
            bound = parameter.low if position < 0.5 else parameter.high
            found.append(
                f"{parameter.key} ended at its bound {bound:g}: its interval means little; widen the bounds if "
                "they are no physical limits"
            )
        if not each.high - each.low < width:
            found.append(
                f"the figures hardly determine {parameter.key}: its interval is wider than its bounds"
            )
        change = np.abs(jacobian[:, index]) * difference
        if np.all(change < math.sqrt(2.0) * noise):
            found.append(
                f"a difference step of {difference:g} of the range of {parameter.key} moves no figure by more than its "
                "scatter: its derivatives are noise; a larger --difference helps"
            )
    return found


def _degrees(freedom: int) -> str:
    return f"{freedom} degree{'s' if freedom > 1 else ''} of freedom"


def _unit_columns(jacobian: Array) -> tuple[Array, Array]:
    """Lengths of the columns (1 for that of a parameter without effect), and the columns over them."""
    lengths = np.linalg.norm(jacobian, axis=0)
    lengths = np.where(lengths > 0.0, lengths, 1.0)
    return lengths, np.asarray(jacobian / lengths)
