"""Stress at particles: Jaumann rate, linear equation of state and radial return (Islam et al. 2019, section 2.3).

Stress deviators have the components xx, yy, zz, xy, yz, xz; in the plane the last two vanish.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.materials.material import Material
from pfemcut.materials.return_mapping import Trial, implicit_multiplier

Array = NDArray[np.float64]

_ROOT_2_3 = np.sqrt(2.0 / 3.0)


@dataclass(frozen=True)
class PointState:
    """Material state of particles.

    Attributes
    ----------
    deviator
        Cauchy stress deviator (MPa); shape (n, 6).
    eqps, rate
        Equivalent plastic strain, and its rate in the last step (1/s); shape (n,).
    temperature
        K; shape (n,).
    """

    deviator: Array
    eqps: Array
    rate: Array
    temperature: Array

    def heated(self, increase: Array) -> PointState:
        """The state with the temperature increased (K; (n,))."""
        return replace(self, temperature=self.temperature + increase)

    def of(self, points: slice) -> PointState:
        """The state of some of the particles."""
        return PointState(
            self.deviator[points], self.eqps[points], self.rate[points], self.temperature[points]
        )


def initial_points(temperature: Array) -> PointState:
    """Particles without stress or plastic strain at a ``temperature`` (K; (n,))."""
    count = len(temperature)
    return PointState(np.zeros((count, 6)), np.zeros(count), np.zeros(count), temperature)


@dataclass(frozen=True)
class Update:
    """What a step does to the material state.

    Attributes
    ----------
    state
        The new state.
    plastic_work
        Of the step, by present volume (MPa); shape (n,).
    """

    state: PointState
    plastic_work: Array


def updated(
    material: Material, state: PointState, velocity_gradient: Array, dt: float, volume_ratio: Array
) -> Update:
    """The state after a step with the given velocity gradient (1/s; (n, d, d)), and J after it (n,).

    1. Trial deviator: S + dt (2 G dev D + W S - S W), the rate of Jaumann (eqs. 20 to 22).
    2. Radial return, backward Euler in strain and rate: the same law and the same solution at a point as the PFEM's.
       The factor f = sigma_y / sigma_trial is that of Wilkins, the strain increment (1 - f) sigma_trial / (3 G).
    3. Adiabatic heating by the part chi of the plastic work (eq. 28).
    """
    shear = material.shear_modulus
    trial_deviator, norm = _jaumann_trial(state.deviator, velocity_gradient, dt, shear)
    trial = Trial(np.ones_like(norm), trial_deviator[:, :4], norm, np.full_like(norm, shear))
    multiplier = implicit_multiplier(
        trial, material.hardening, state.eqps, state.temperature, dt, state.rate / _ROOT_2_3
    ).value
    deviator = trial_deviator * (1.0 - 2.0 * shear * multiplier / norm)[:, None]
    strain = _ROOT_2_3 * multiplier
    work = strain * (norm / _ROOT_2_3 - 3.0 * shear * strain)
    capacity = material.density / volume_ratio * material.capacity(state.temperature)
    heating = material.taylor_quinney * work / capacity
    return Update(
        PointState(deviator, state.eqps + strain, strain / dt, state.temperature + heating),
        work,
    )


def updated_bodies(
    materials: Sequence[Material],
    ranges: Sequence[slice],
    state: PointState,
    velocity_gradient: Array,
    dt: float,
    volume_ratio: Array,
) -> Update:
    """The same for several bodies, whose particles are ``ranges`` that follow each other."""
    parts = [
        updated(material, state.of(points), velocity_gradient[points], dt, volume_ratio[points])
        for material, points in zip(materials, ranges, strict=True)
    ]
    if len(parts) == 1:
        return parts[0]
    states = [part.state for part in parts]
    return Update(
        PointState(
            np.concatenate([each.deviator for each in states]),
            np.concatenate([each.eqps for each in states]),
            np.concatenate([each.rate for each in states]),
            np.concatenate([each.temperature for each in states]),
        ),
        np.concatenate([part.plastic_work for part in parts]),
    )


@njit(inline="always")
def _turned(start, spin, dt, turning):  # type: ignore[no-untyped-def]
    """``start`` + dt (W S - S W) with S = ``turning`` and W antisymmetric, of components xy, yz, xz."""
    wxy, wyz, wxz = spin
    sxx, syy, szz, sxy, syz, sxz = turning
    return (
        start[0] + dt * 2.0 * (wxy * sxy + wxz * sxz),
        start[1] + dt * 2.0 * (wyz * syz - wxy * sxy),
        start[2] - dt * 2.0 * (wxz * sxz + wyz * syz),
        start[3] + dt * (wxy * (syy - sxx) + wxz * syz + wyz * sxz),
        start[4] + dt * (-wxy * sxz + wyz * (szz - syy) - wxz * sxy),
        start[5] + dt * (wxy * syz + wxz * (szz - sxx) - wyz * sxy),
    )


@njit(parallel=True, cache=True)
def _jaumann_trial(deviator, velocity_gradient, dt, shear):  # type: ignore[no-untyped-def]
    """Trial deviators (n, 6) and their norms (n,)."""
    count, dimension = velocity_gradient.shape[:2]
    trial, norm = np.empty((count, 6)), np.empty(count)
    for i in prange(count):
        lg = velocity_gradient[i]
        lxx, lxy, lyx, lyy = lg[0, 0], lg[0, 1], lg[1, 0], lg[1, 1]
        lxz = lyz = lzx = lzy = lzz = 0.0
        if dimension == 3:
            lxz, lyz, lzx, lzy, lzz = lg[0, 2], lg[1, 2], lg[2, 0], lg[2, 1], lg[2, 2]
        third = (lxx + lyy + lzz) / 3.0
        wxy, wyz, wxz = 0.5 * (lxy - lyx), 0.5 * (lyz - lzy), 0.5 * (lxz - lzx)
        sxx, syy, szz = deviator[i, 0], deviator[i, 1], deviator[i, 2]
        sxy, syz, sxz = deviator[i, 3], deviator[i, 4], deviator[i, 5]
        spin = (wxy, wyz, wxz)
        # The turn of the middle of the step: with that of its start the norm would grow in every rotation.
        middle = _turned((sxx, syy, szz, sxy, syz, sxz), spin, 0.5 * dt, (sxx, syy, szz, sxy, syz, sxz))
        xx, yy, zz, xy, yz, xz = _turned((sxx, syy, szz, sxy, syz, sxz), spin, dt, middle)
        xx += 2.0 * dt * shear * (lxx - third)
        yy += 2.0 * dt * shear * (lyy - third)
        zz += 2.0 * dt * shear * (lzz - third)
        xy += dt * shear * (lxy + lyx)
        yz += dt * shear * (lyz + lzy)
        xz += dt * shear * (lxz + lzx)
        trial[i, 0], trial[i, 1], trial[i, 2] = xx, yy, zz
        trial[i, 3], trial[i, 4], trial[i, 5] = xy, yz, xz
        square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz)
        norm[i] = max(np.sqrt(square), 1e-10)
    return trial, norm


def von_mises(deviator: Array) -> Array:
    """sqrt(3/2 S:S) (MPa; (n,)) of deviators (n, 6)."""
    return np.sqrt(1.5 * square(deviator))


def square(deviator: Array) -> Array:
    """S:S (MPa²; (n,)) of deviators (n, 6)."""
    return np.asarray(np.sum(deviator[:, :3] ** 2, axis=1) + 2.0 * np.sum(deviator[:, 3:] ** 2, axis=1))


def cauchy_stress(deviator: Array, pressure: Array, dimension: int) -> Array:
    """sigma = S - p I as matrices (MPa; (n, d, d)) from deviators (n, 6) and pressure (n,), positive in compression."""
    xx, yy, zz, xy, yz, xz = deviator.T
    rows = [[xx - pressure, xy, xz], [xy, yy - pressure, yz], [xz, yz, zz - pressure]]
    return np.moveaxis(np.array([row[:dimension] for row in rows[:dimension]]), -1, 0)


def linear_pressure(bulk_modulus: Array, volume_ratio: Array) -> Array:
    """p = K (rho / rho_0 - 1) = K (1/J - 1) (MPa; (n,)): the linear equation of state (eq. 24)."""
    return bulk_modulus * (1.0 / volume_ratio - 1.0)


def elastic_energy(bulk_modulus: Array, shear_modulus: Array, deviator: Array, volume_ratio: Array) -> Array:
    """J S:S / (4 G) + K (J - 1 - ln J) by initial volume (MPa; (n,)).

    The second term is what the linear equation of state stores, minus its integral of p dJ. The first is that of small
    elastic strain; the rate of Jaumann has no exact one.
    """
    shape = volume_ratio * square(deviator) / (4.0 * shear_modulus)
    return shape + bulk_modulus * (volume_ratio - 1.0 - np.log(volume_ratio))
