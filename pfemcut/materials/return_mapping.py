"""Finite-strain J2 plasticity at Gauss points: trial state, radial return, extrapolation (paper, Boxes 2 and 3).

A Gauss point carries the isochoric elastic left Cauchy-Green tensor b (components xx, yy, zz, xy; det b = 1), the
equivalent plastic strain and the plastic multiplier rate. All arrays have one row a Gauss point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pfemcut.materials.material import HardeningLaw

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_ROOT_2_3 = np.sqrt(2.0 / 3.0)
_CLAMP = 0.9  # the extrapolated return takes at most this part of the trial stress
_DECADES = 1e-2  # next try relative to the upper bound, while the lower one is zero
_TINY = 1e-10  # MPa, as in the weak form


class ReturnMappingFailed(Exception):
    """The plastic multiplier was not found to its tolerance."""


@dataclass(frozen=True)
class Trial:
    """Elastic trial state for a relative deformation gradient.

    Attributes
    ----------
    jacobian
        j = det f; shape (m,).
    deviator
        Trial Kirchhoff stress deviator (MPa), components xx, yy, zz, xy; shape (m, 4).
    norm
        Its Frobenius norm; shape (m,).
    mu_bar
        mu tr(b_trial) / 3 (MPa); shape (m,).
    """

    jacobian: Array
    deviator: Array
    norm: Array
    mu_bar: Array

    def of(self, points: slice) -> Trial:
        """The trial state of some of the points."""
        return Trial(self.jacobian[points], self.deviator[points], self.norm[points], self.mu_bar[points])


@dataclass(frozen=True)
class Multiplier:
    """Plastic multiplier as the momentum solve sees it, linear in the trial norm and mu_bar.

    Attributes
    ----------
    value
        Delta lambda; shape (m,).
    by_norm, by_mu_bar
        Derivatives by the trial norm and by mu_bar (1/MPa); shape (m,).
    """

    value: Array
    by_norm: Array
    by_mu_bar: Array

    @staticmethod
    def joined(parts: Sequence[Multiplier]) -> Multiplier:
        """Multipliers of several sets of points, one after the other."""
        return Multiplier(
            np.concatenate([each.value for each in parts]),
            np.concatenate([each.by_norm for each in parts]),
            np.concatenate([each.by_mu_bar for each in parts]),
        )


def elastic_trial(b_elastic: Array, gradient: Array, shear_modulus: Array | float) -> Trial:
    """Trial state b_trial = j^(-2/3) f b f^T of ``b_elastic`` (m, 4) for f = ``gradient`` (m, 2, 2)."""
    modulus = np.broadcast_to(np.asarray(shear_modulus, dtype=np.float64), len(gradient)).copy()
    return Trial(*_elastic_trial(b_elastic, gradient, modulus))


@njit(cache=True)
def _elastic_trial(b_elastic, gradient, shear_modulus):  # type: ignore[no-untyped-def]
    count = len(gradient)
    jacobian, norm, mu_bar = np.empty(count), np.empty(count), np.empty(count)
    deviator = np.empty((count, 4))
    for i in range(count):
        fxx, fxy, fyx, fyy = gradient[i, 0, 0], gradient[i, 0, 1], gradient[i, 1, 0], gradient[i, 1, 1]
        bxx, byy, bzz, bxy = b_elastic[i, 0], b_elastic[i, 1], b_elastic[i, 2], b_elastic[i, 3]
        jacobian[i] = fxx * fyy - fxy * fyx
        scale = shear_modulus[i] * max(jacobian[i], 1e-6) ** (-2.0 / 3.0)
        gxx, gxy = fxx * bxx + fxy * bxy, fxx * bxy + fxy * byy
        gyx, gyy = fyx * bxx + fyy * bxy, fyx * bxy + fyy * byy
        xx = scale * (gxx * fxx + gxy * fxy)
        yy = scale * (gyx * fyx + gyy * fyy)
        xy = scale * (gxx * fyx + gxy * fyy)
        zz = scale * bzz
        mean = (xx + yy + zz) / 3.0
        xx, yy, zz = xx - mean, yy - mean, zz - mean
        mu_bar[i] = mean
        deviator[i, 0], deviator[i, 1], deviator[i, 2], deviator[i, 3] = xx, yy, zz, xy
        norm[i] = max(np.sqrt(xx * xx + yy * yy + zz * zz + 2.0 * xy * xy), _TINY)
    return jacobian, deviator, norm, mu_bar


def tensor_norm(tensor: Array) -> Array:
    """Frobenius norm of symmetric tensors with components xx, yy, zz, xy; shape (m, 4) to (m,)."""
    return np.sqrt(np.sum(tensor[:, :3] ** 2, axis=1) + 2.0 * tensor[:, 3] ** 2)


def implicit_multiplier(
    trial: Trial, law: HardeningLaw, eqps: Array, temperature: Array, step: float, rate_guess: Array
) -> Multiplier:
    """Backward-Euler plastic multiplier and its derivatives.

    Solves |s_trial| - 2 mu_bar dl = sqrt(2/3) sigma_y(eqps + sqrt(2/3) dl, sqrt(2/3) dl / dt, theta) where the
    trial state is beyond yield, by Newton's method kept inside a shrinking bracket: the left side falls and the
    right side, apart from thermal softening at fixed temperature, does not.

    Parameters
    ----------
    trial
        Trial state of m points.
    law
        Hardening law.
    eqps, temperature
        Equivalent plastic strain at the start of the step, and temperature (K); shape (m,).
    step
        Time step (s).
    rate_guess
        Multiplier rate to start from where it is positive (1/s), as that of the last step; shape (m,).

    Raises
    ------
    ReturnMappingFailed
        If the iteration does not converge.
    """
    zero = np.zeros_like(eqps)
    value, by_norm, by_mu_bar = zero.copy(), zero.copy(), zero.copy()
    yield_stress = law.flow_stress(eqps, zero, temperature).value
    plastic = np.flatnonzero(trial.norm > _ROOT_2_3 * yield_stress)
    if len(plastic):
        norm, mu_bar = trial.norm[plastic], trial.mu_bar[plastic]
        e, theta = eqps[plastic], temperature[plastic]
        low, high = np.zeros_like(norm), norm / (2.0 * mu_bar)
        # The rate term is steep at its threshold and flat beyond: from there Newton's method would take many steps.
        guess = rate_guess[plastic] * step
        at_threshold = (norm - _ROOT_2_3 * yield_stress[plastic]) / (2.0 * mu_bar)
        multiplier = np.where((guess > 0.0) & (guess < high), guess, at_threshold)
        slope = 2.0 * mu_bar
        left = np.arange(len(plastic))  # the points that have not converged
        for _ in range(60):
            dl, strain = multiplier[left], _ROOT_2_3 * multiplier[left]
            flow = law.flow_stress(e[left] + strain, strain / step, theta[left])
            excess = norm[left] - 2.0 * mu_bar[left] * dl - _ROOT_2_3 * flow.value
            slope[left] = 2.0 * mu_bar[left] + (flow.by_eqps + flow.by_rate / step) * 2.0 / 3.0
            low[left] = np.where(excess > 0.0, dl, low[left])
            high[left] = np.where(excess > 0.0, high[left], dl)
            newton = dl + excess / slope[left]
            # The iterate itself is right where it has converged; the bracket's other end would begin a cycle.
            inside = ((newton > low[left]) & (newton < high[left])) | (newton == dl)
            # Roots lie decades apart, from barely flowing points to the shear zone.
            between = np.where(low[left] > 0.0, np.sqrt(low[left] * high[left]), _DECADES * high[left])
            multiplier[left] = np.where(inside, newton, between)
            error = np.abs(excess) / norm[left]
            left = left[~(error < 1e-12)]
            if not len(left):
                break
        else:
            raise ReturnMappingFailed(f"return mapping: {np.max(error):.2g} of the stress is left")
        value[plastic] = multiplier
        by_norm[plastic] = 1.0 / slope
        by_mu_bar[plastic] = -2.0 * multiplier / slope
    return Multiplier(value, by_norm, by_mu_bar)


def extrapolated_multiplier(trial: Trial, multiplier_rate: Array, step: float) -> Multiplier:
    """IMPL-EX multiplier: the last rate times the step (paper, eq. 13), clamped with its derivatives.

    Where 2 mu_bar dl would exceed 0.9 |s_trial| it is held there, so that the radial factor stays at 0.1 or more.
    """
    value = multiplier_rate * step
    limit = _CLAMP * trial.norm / (2.0 * trial.mu_bar)
    clamped = value > limit
    return Multiplier(
        np.where(clamped, limit, value),
        np.where(clamped, limit / trial.norm, 0.0),
        np.where(clamped, -limit / trial.mu_bar, 0.0),
    )


def returned_deviator(trial: Trial, multiplier: Array) -> Array:
    """Kirchhoff stress deviator s = s_trial (1 - 2 mu_bar dl / |s_trial|); shape (m, 4)."""
    return trial.deviator * (1.0 - 2.0 * trial.mu_bar * multiplier / trial.norm)[:, None]


def elastic_strain(deviator: Array, shear_modulus: Array | float) -> Array:
    """Elastic tensor b with deviator ``deviator`` / mu and det b = 1; shape (m, 4).

    The flow rule keeps tr b instead; its determinant drifts. With the mean m of b the determinant is
    m³ - m |d|²/2 + det d, d = dev b, which Newton's method solves for 1.
    """
    d = deviator / shear_modulus
    half_square = 0.5 * tensor_norm(d) ** 2
    determinant = d[:, 2] * (d[:, 0] * d[:, 1] - d[:, 3] ** 2)
    mean = 1.0 + half_square / 3.0
    for _ in range(50):
        change = (mean**3 - mean * half_square + determinant - 1.0) / (3.0 * mean**2 - half_square)
        mean = mean - change
        if np.max(np.abs(change), initial=0.0) < 1e-15:
            break
    b = d.copy()
    b[:, :3] += mean[:, None]
    return b


def deviatoric_energy(b_elastic: Array, shear_modulus: Array | float) -> Array:
    """W = mu/2 (tr b - 3) per referential volume (MPa); shape (m,)."""
    return 0.5 * shear_modulus * (b_elastic[:, :3].sum(axis=1) - 3.0)
