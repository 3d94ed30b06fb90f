"""Uniform plane-strain compression of the solver's elastic material under a penalty, solved at one point.

Box 2 of the paper at constant temperature: Kirchhoff deviator mu dev(b_bar), Cauchy pressure kappa ln J / J. Lateral
stress zero; the top moves with the tool but for the penetration t/eps, t the pressure on the deformed surface.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def cauchy(across: float, along: float, young: float, poisson: float) -> tuple[float, float]:
    """Cauchy stress (MPa) across and along for the stretches in the plane."""
    mu, kappa = young / (2.0 * (1.0 + poisson)), young / (3.0 * (1.0 - 2.0 * poisson))
    j = across * along
    squares = np.array([across**2, along**2, 1.0]) * j ** (-2.0 / 3.0)
    stress = mu / j * (squares - squares.mean()) + kappa * np.log(j) / j
    return float(stress[0]), float(stress[1])


def contact_pressure(
    travel: float, steps: int, height: float, penalty: float, young: float, poisson: float
) -> tuple[float, float]:
    """Force over the undeformed width, and the pressure that the tool reports (MPa).

    The solver's penalty acts on the lengths at the start of a step, so that what it reports is a force over those.
    """
    before = 1.0
    force = reported = 0.0
    for step in range(1, steps + 1):
        top = height - travel * step / steps

        def state(along: float) -> tuple[float, float]:
            across = brentq(lambda a: cauchy(a, along, young, poisson)[0], 0.9, 1.2, xtol=1e-15)
            return across, -cauchy(across, along, young, poisson)[1] * across

        def imbalance(along: float, top: float = top, before: float = before) -> float:
            # The penetration shortens the block by less than the tool's travel.
            return state(along)[1] - penalty * (height * along - top) * before

        along = brentq(imbalance, top / height, 1.0, xtol=1e-15)
        across, force = state(along)
        reported = force / before
        before = across
    return force, reported
