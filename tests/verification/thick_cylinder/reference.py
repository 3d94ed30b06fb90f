r"""Thick-walled cylinder of perfectly plastic metal under internal pressure, small strain, plane strain.

Hill, The Mathematical Theory of Plasticity (1950), ch. V: with the plastic zone up to the radius c,

    p = k (2 ln(c/a) + 1 - c²/b²),   u(b) = 2 k c² (1 - nu²) / (E b),   k = sigma_y / sqrt(3).

Exact for incompressible elasticity (or a Tresca metal, k = sigma_y / 2). :func:`radial_solution` integrates the von
Mises metal at any Poisson ratio along the radius, as an independent reference for the rest. At finite strain a
rigid-plastic cylinder carries p = 2 k ln(b' / a') at its current radii.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]

A, B = 100.0, 200.0
YIELD_STRESS = 240.0
K = YIELD_STRESS / np.sqrt(3.0)
YOUNG_MODULUS, POISSON_RATIO = 210e3, 0.3
LIMIT_PRESSURE = 2.0 * K * np.log(B / A)


def pressure(c: Array) -> Array:
    """Internal pressure (MPa) with the plastic zone up to the radius ``c`` (mm)."""
    return K * (2.0 * np.log(c / A) + 1.0 - c**2 / B**2)


def outer_displacement(c: Array, young_modulus: float = YOUNG_MODULUS) -> Array:
    """Displacement of the outer surface (mm) with the plastic zone up to the radius ``c`` (mm)."""
    return 2.0 * K * c**2 * (1.0 - POISSON_RATIO**2) / (young_modulus * B)


def outer_displacement_at(pressures: Array, young_modulus: float = YOUNG_MODULUS) -> Array:
    """Displacement of the outer surface (mm) for pressures between first yield and the limit."""
    c = np.linspace(A, B, 100_001)
    return np.interp(pressures, pressure(c), outer_displacement(c, young_modulus))


def radial_solution(bore_displacement: Array, elements: int = 400) -> tuple[Array, Array]:
    """Pressure (MPa) and outer displacement (mm) of the small-strain von Mises metal, E = 210 GPa, nu = 0.3.

    Linear elements along the radius, one Gauss point, backward Euler at each of the increasing bore displacements
    (mm), Newton with the consistent tangent of the radial return.
    """
    shear = YOUNG_MODULUS / (2.0 * (1.0 + POISSON_RATIO))
    bulk = YOUNG_MODULUS / (3.0 * (1.0 - 2.0 * POISSON_RATIO))
    r = np.linspace(A, B, elements + 1)
    middle, length = 0.5 * (r[1:] + r[:-1]), np.diff(r)
    one, deviatoric = np.ones(3), np.eye(3) - 1.0 / 3.0
    strain_of = np.zeros((elements, 3, 2))  # (rr, tt, zz) by the two ends
    strain_of[:, 0, 0], strain_of[:, 0, 1] = -1.0 / length, 1.0 / length
    strain_of[:, 1, :] = 0.5 / middle[:, None]
    weight = middle * length
    radius = np.sqrt(2.0 / 3.0) * YIELD_STRESS
    plastic = np.zeros((elements, 3))
    u = np.zeros(elements + 1)
    pressures, outer = [], []
    for bore in bore_displacement:
        u[0] = bore
        for _ in range(60):
            strain = np.einsum("eij,ej->ei", strain_of, np.column_stack([u[:-1], u[1:]]))
            trial = 2.0 * shear * (strain - plastic) @ deviatoric
            norm = np.linalg.norm(trial, axis=1)
            factor = np.minimum(1.0, radius / np.maximum(norm, 1e-30))
            stress = bulk * strain.sum(axis=1)[:, None] + factor[:, None] * trial
            n = trial / np.maximum(norm, 1e-30)[:, None]
            tangent = bulk * np.outer(one, one) + 2.0 * shear * factor[:, None, None] * deviatoric
            tangent = tangent - np.where(factor < 1.0, 2.0 * shear * factor, 0.0)[:, None, None] * (
                n[:, :, None] * n[:, None, :]
            )
            local = np.einsum("e,eij,ei->ej", weight, strain_of, stress)
            force = np.zeros(elements + 1)
            force[:-1] += local[:, 0]
            force[1:] += local[:, 1]
            if np.abs(force[1:]).max() < 1e-9 * max(abs(force[0]), 1.0):
                break
            stiffness = np.einsum("e,eia,eij,ejb->eab", weight, strain_of, tangent, strain_of)
            band = np.zeros((3, elements + 1))
            band[1, :-1] += stiffness[:, 0, 0]
            band[1, 1:] += stiffness[:, 1, 1]
            band[0, 1:] = stiffness[:, 0, 1]
            band[2, :-1] = stiffness[:, 1, 0]
            band[1, 0], band[0, 1] = 1.0, 0.0
            right = -force
            right[0] = 0.0
            u = u + solve_banded((1, 1), band, right)
        else:
            raise RuntimeError("the radial solution did not converge")
        plastic = strain @ deviatoric - factor[:, None] * trial / (2.0 * shear)
        pressures.append(force[0] / A)
        outer.append(u[-1])
    return np.array(pressures), np.array(outer)
