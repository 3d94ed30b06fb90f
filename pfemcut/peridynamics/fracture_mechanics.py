"""What continuum mechanics says of cracks along the fibre, from a line crack and from a hole, to compare with."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pfemcut.peridynamics.lamina import POISSON_RATIO, Lamina
from pfemcut.peridynamics.plate import Plate

Array = NDArray[np.float64]


def opening_release_rate(lamina: Lamina, intensity: float) -> float:
    """Energy release rate G_I (N/mm) of a crack along the fibre at the stress intensity K_I (MPa sqrt(mm)).

    G = K² sqrt(S11 S22 / 2) sqrt(sqrt(S22 / S11) + (2 S12 + S66) / (2 S11)) with the compliance S in axes 1 along and
    2 across the crack (Sih, Paris and Irwin 1965, Int. J. Fract. Mech. 1, 189).
    """
    s = np.linalg.inv(lamina.stiffness)
    shape = math.sqrt(s[1, 1] / s[0, 0]) + (2.0 * s[0, 1] + s[2, 2]) / (2.0 * s[0, 0])
    return intensity**2 * math.sqrt(0.5 * s[0, 0] * s[1, 1]) * math.sqrt(shape)


def critical_load(lamina: Lamina, plate: Plate) -> float:
    """Load (N) at which a line crack in the middle grows; nan unless crack and fibre lie straight across the pull.

    K = sigma sqrt(pi a sec(pi a / W)) (Feddersen 1966), which is of isotropic strips; the difference is small where
    the crack is a quarter of the width.
    """
    across = math.pi / 2.0
    if not math.isclose(plate.fibre_angle, across) or len(plate.cracks) != 1:
        return math.nan
    (crack,) = plate.cracks
    if not math.isclose(crack.angle, across):
        return math.nan
    a = 0.5 * crack.length
    intensity = math.sqrt(lamina.opening_energy / opening_release_rate(lamina, 1.0))
    stress = intensity / math.sqrt(math.pi * a / math.cos(math.pi * a / plate.width))
    return stress * plate.width * plate.thickness


def hoop_stress(lamina: Lamina, pull_angle: float, position: Array) -> Array:
    """Hoop stress at the edge of a round hole in a wide plate, over that of the pull (Lekhnitskii 1968).

    Parameters
    ----------
    lamina
        Its constants.
    pull_angle
        Of the pull from the fibre (rad).
    position
        Angles of places at the edge from the fibre (rad).
    """
    e1, e2, g, nu = lamina.axial_modulus, lamina.transverse_modulus, lamina.shear_modulus, POISSON_RATIO
    k = math.sqrt(e1 / e2)
    n = math.sqrt(2.0 * (k - nu) + e1 / g)
    c, s = math.cos(pull_angle), math.sin(pull_angle)
    cp, sp = np.cos(position), np.sin(position)
    along_edge = 1.0 / (sp**4 / e1 + (1.0 / g - 2.0 * nu / e1) * sp**2 * cp**2 + cp**4 / e2)
    return np.asarray(
        along_edge
        / e1
        * (
            (-c * c + (k + n) * s * s) * k * cp**2
            + ((1.0 + n) * c * c - k * s * s) * sp**2
            - n * (1.0 + k + n) * s * c * sp * cp
        )
    )


def start_at_hole(lamina: Lamina, fibre_angle: float, radius: float) -> tuple[float, float]:
    """Place (mm, from the hole's middle, x along the pull, y > 0) at which a smooth hole's edge cracks along the fibre.

    Where (sigma_22 / sqrt(3))² / G_Ic + tau_12² / G_IIc of the tractions on planes along the fibre is largest, which is
    the lattice's criterion by its stresses sigma_22 = sqrt(3) k_m s_I / t and tau_12 = k_m s_II / t.
    """
    position = np.linspace(0.0, 2.0 * math.pi, 7201)
    hoop = hoop_stress(lamina, -fibre_angle, position)
    normal, shear = hoop * np.cos(position) ** 2, -hoop * np.sin(position) * np.cos(position)
    measure = np.maximum(normal, 0.0) ** 2 / 3.0 / lamina.opening_energy + shear**2 / lamina.shear_energy
    angle = position + fibre_angle
    measure[np.sin(angle) < 0.0] = 0.0
    at = float(angle[int(np.argmax(measure))])
    return radius * math.cos(at), radius * math.sin(at)
