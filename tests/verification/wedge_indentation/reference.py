"""Slip-line field of a frictionless rigid wedge in a rigid, perfectly plastic half plane.

Hill, Lee and Tupper, Proc. R. Soc. A 188 (1947) 273; Hill, Mathematical Theory of Plasticity, 1950, section VIII.2;
Johnson, Contact Mechanics, 1985, section 6.2(d). For the semi-angle psi of the wedge, the fan's angle theta follows
from

    cos(2 psi - theta) = cos(theta) / (1 + sin(theta)),

the pressure on the face is uniform, p = 2 k (1 + theta), and the face is in contact over the length
l = c / (cos(psi) - sin(psi - theta)) at the depth c below the undisturbed surface. psi = 90 degrees is Prandtl's punch.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def fan_angle(semi_angle: float) -> float:
    """Angle theta (rad) of the fan for the semi-angle psi (rad)."""
    return float(
        brentq(
            lambda t: np.cos(2.0 * semi_angle - t) * (1.0 + np.sin(t)) - np.cos(t), 0.0, np.pi / 2.0 - 1e-9
        )
    )


def pressure(semi_angle: float, k: float) -> float:
    """Pressure on the face (MPa) for the shear yield stress ``k`` (MPa)."""
    return 2.0 * k * (1.0 + fan_angle(semi_angle))


def contact_length(semi_angle: float, depth: float) -> float:
    """Length of one face in contact (mm) at ``depth`` (mm)."""
    return depth / (np.cos(semi_angle) - np.sin(semi_angle - fan_angle(semi_angle)))


def force(semi_angle: float, depth: float, k: float) -> float:
    """Force on the whole wedge (N/mm)."""
    return 2.0 * pressure(semi_angle, k) * contact_length(semi_angle, depth) * np.sin(semi_angle)
