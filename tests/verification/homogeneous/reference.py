r"""One-point integration of Voce's steel under a homogeneous plane-strain deformation, in rate form.

Nothing here comes from pfemcut. With the velocity gradient l = dF/dt F^-1, its deviator l' = l - tr(l)/3 1, the
isochoric elastic left Cauchy-Green tensor b (det b = 1), and n = dev b / |dev b|,

    db/dt   = l' b + b l'^T - 2 g (tr b / 3) n + m 1,   m such that det b stays 1,
    deqps/dt = sqrt(2/3) g,   dtheta/dt = chi sigma_y deqps/dt / (rho_0 c),
    Kirchhoff deviator s = mu dev b,   |s| = sqrt(2/3) sigma_y(eqps, theta) while g > 0,
    p = kappa (ln J / J - e (1 - ln J) / J²),   e = 3 alpha (theta - theta_0),   sigma = p 1 + s / J.

The consistency condition gives g; with b = 1 and theta = theta_0 at the start. In tension the stretch across follows
from dsigma_yy/dt = 0. Data: Rodriguez et al. 2017, Table 1, as printed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

YOUNG, POISSON = 206.9e3, 0.3
MU = YOUNG / (2.0 * (1.0 + POISSON))
KAPPA = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
ALPHA, DENSITY, CAPACITY, CHI, THETA_0 = 1e-5, 7.8e-9, 0.46e9, 0.9, 293.15
SIGMA_0, SIGMA_INF, HARDENING, DELTA, W_0, W_H = 450.0, 715.0, 129.24, 16.93, 1e-3, 1e-3
ROOT_2_3 = np.sqrt(2.0 / 3.0)


@dataclass(frozen=True)
class Point:
    """The state along the path: F (n, 2, 2), Cauchy stress (n, 3, 3), eqps and temperature (n,)."""

    gradient: Array
    cauchy: Array
    eqps: Array
    temperature: Array

    @property
    def nominal(self) -> Array:
        """First Piola-Kirchhoff stress in the plane, J sigma F^-T; (n, 2, 2)."""
        jacobian = np.linalg.det(self.gradient)[:, None, None]
        return jacobian * self.cauchy[:, :2, :2] @ np.swapaxes(np.linalg.inv(self.gradient), 1, 2)


def flow_stress(eqps: float, theta: float) -> tuple[float, float, float]:
    """Voce flow stress (MPa) and its derivatives by eqps and temperature."""
    warm, decay = theta - THETA_0, np.exp(-DELTA * eqps)
    initial, hard = 1.0 - W_0 * warm, 1.0 - W_H * warm
    value = SIGMA_INF * hard * (1.0 - decay) + SIGMA_0 * initial * decay + HARDENING * hard * eqps
    by_eqps = DELTA * decay * (SIGMA_INF * hard - SIGMA_0 * initial) + HARDENING * hard
    by_theta = -W_H * SIGMA_INF * (1.0 - decay) - W_0 * SIGMA_0 * decay - W_H * HARDENING * eqps
    return value, by_eqps, by_theta


def integrate(
    deformation: Callable[[float], tuple[Array, Array]], times: Array, *, adiabatic: bool, free_yy: bool
) -> Point:
    """Integrate the point from time zero to each of the increasing ``times``.

    Parameters
    ----------
    deformation
        F (2, 2) and dF/dt at a time; with ``free_yy`` their yy entries are ignored.
    adiabatic
        Whether plastic work heats.
    free_yy
        Whether F_yy is such that the Cauchy stress sigma_yy vanishes.
    """
    heating = CHI / (DENSITY * CAPACITY) if adiabatic else 0.0

    def gradients(t: float, stretch: float, rate: float) -> tuple[Array, Array]:
        f, df = (np.array(each, dtype=float) for each in deformation(t))
        if free_yy:
            f[1, 1], df[1, 1] = stretch, rate
        return f, df

    def rates(t: float, y: Array, plastic: bool, rate: float) -> tuple[Array, float]:
        """Derivative of the state, and of sigma_yy, if F_yy changes at ``rate``."""
        b = np.array([[y[0], y[3], 0.0], [y[3], y[1], 0.0], [0.0, 0.0, y[2]]])
        f, df = gradients(t, y[6], rate)
        velocity = np.zeros((3, 3))
        velocity[:2, :2] = df @ np.linalg.inv(f)
        dilation = np.trace(velocity)
        velocity = velocity - dilation / 3.0 * np.eye(3)
        mean = np.trace(b) / 3.0
        deviator = b - mean * np.eye(3)
        db = velocity @ b + b @ velocity.T
        d_eqps = d_theta = 0.0
        if plastic:
            n = deviator / np.linalg.norm(deviator)
            value, by_eqps, by_theta = flow_stress(y[4], y[5])
            hardening = by_eqps + by_theta * heating * value
            g = MU * np.sum(n * db) / (2.0 * MU * mean + 2.0 / 3.0 * hardening)
            db = db - 2.0 * g * mean * n
            inverse = np.linalg.inv(b)
            db = db + 2.0 * g * mean * np.trace(inverse @ n) / np.trace(inverse) * np.eye(3)
            d_eqps = ROOT_2_3 * g
            d_theta = heating * value * d_eqps
        j = np.linalg.det(f)
        log, e = np.log(j), 3.0 * ALPHA * (y[5] - THETA_0)
        dp_dj = (1.0 - log) / j**2 + e * (3.0 - 2.0 * log) / j**3
        dp = KAPPA * (dp_dj * j * dilation - 3.0 * ALPHA * d_theta * (1.0 - log) / j**2)
        ddev = db[1, 1] - np.trace(db) / 3.0
        d_sigma = dp + MU * (ddev - deviator[1, 1] * dilation) / j
        return np.array([db[0, 0], db[1, 1], db[2, 2], db[0, 1], d_eqps, d_theta, rate]), d_sigma

    def right(t: float, y: Array, plastic: bool) -> Array:
        if not free_yy:
            return rates(t, y, plastic, 0.0)[0]
        zero, one = rates(t, y, plastic, 0.0)[1], rates(t, y, plastic, 1.0)[1]
        return rates(t, y, plastic, zero / (zero - one))[0]

    def yields(t: float, y: Array, plastic: bool) -> float:
        b = np.array([y[0], y[1], y[2]])
        norm = MU * np.sqrt(np.sum((b - b.mean()) ** 2) + 2.0 * y[3] ** 2)
        return float(norm - ROOT_2_3 * flow_stress(y[4], y[5])[0])

    yields.terminal, yields.direction = True, 1.0  # type: ignore[attr-defined]
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "dense_output": True}
    state = np.array([1.0, 1.0, 1.0, 0.0, 0.0, THETA_0, 1.0])
    elastic = solve_ivp(right, (0.0, times[-1]), state, args=(False,), events=yields, **options)
    at_yield = float(elastic.t[-1])
    states = np.array([elastic.sol(t) for t in times if t <= at_yield]).reshape(-1, 7)
    if at_yield < times[-1]:
        plastic = solve_ivp(right, (at_yield, times[-1]), elastic.y[:, -1], args=(True,), **options)
        states = np.vstack([states, *(plastic.sol(t) for t in times if t > at_yield)])
    f = np.array([gradients(t, y[6], 0.0)[0] for t, y in zip(times, states, strict=True)])
    j = np.linalg.det(f)
    b = np.zeros((len(times), 3, 3))
    b[:, 0, 0], b[:, 1, 1], b[:, 2, 2] = states[:, :3].T
    b[:, 0, 1] = b[:, 1, 0] = states[:, 3]
    mean = np.trace(b, axis1=1, axis2=2) / 3.0
    e = 3.0 * ALPHA * (states[:, 5] - THETA_0)
    pressure = KAPPA * (np.log(j) / j - e * (1.0 - np.log(j)) / j**2)
    unit = np.eye(3)
    cauchy = pressure[:, None, None] * unit + MU / j[:, None, None] * (b - mean[:, None, None] * unit)
    return Point(f, cauchy, states[:, 4], states[:, 5])


def tension(times: Array, adiabatic: bool) -> Point:
    """Stretch F_xx = 1 + 0.5 t, free in y."""
    return integrate(
        lambda t: (np.diag([1.0 + 0.5 * t, 1.0]), np.diag([0.5, 0.0])),
        times,
        adiabatic=adiabatic,
        free_yy=True,
    )


def shear(times: Array, adiabatic: bool) -> Point:
    """Simple shear F_xy = t."""
    one = np.array([[0.0, 1.0], [0.0, 0.0]])
    return integrate(lambda t: (np.eye(2) + t * one, one), times, adiabatic=adiabatic, free_yy=False)
