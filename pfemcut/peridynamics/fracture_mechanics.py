"""Linear elastic fracture mechanics of a line crack along the fibre, which the lattice is compared with."""

from __future__ import annotations

import math

import numpy as np

from pfemcut.peridynamics.lamina import Lamina
from pfemcut.peridynamics.plate import Plate


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
