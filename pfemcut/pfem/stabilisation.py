"""Shear stiffness that scales the polynomial pressure projection.

The projection takes a volume of alpha_s / mu_s times the part of the pressure that the element mean leaves out. With
the elastic modulus (paper, eq. 40) it is too weak where plastic flow has softened the element, and the pressure
oscillates there. The secant modulus of an element that flows is known from the state at the start of the step; being
frozen over the step it leaves the tangent of the weak form exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pfemcut.materials.return_mapping import tensor_norm
from pfemcut.problem import StabilisationModulus

Array = NDArray[np.float64]

_LEAST = 0.1  # less smooths the pressure a little more, and costs a fifth more Newton iterations in a cut


def modulus_ratio(rule: StabilisationModulus, b_elastic: Array, eqps: Array, multiplier_rate: Array) -> Array:
    """mu_s / mu of each element; shape (m,).

    ELASTIC: 1. SECANT: sigma / (sigma + 3 mu eqps), at least 0.1, where the last step was plastic, else 1: the slope
    of von Mises stress sigma over total strain in uniaxial tension, relative to the elastic slope.

    Parameters
    ----------
    rule
        See above.
    b_elastic, eqps, multiplier_rate
        State at the start of the step, see :class:`pfemcut.pfem.state.Fields`; (m, 4), (m,) and (m,).
    """
    if rule is StabilisationModulus.ELASTIC:
        return np.ones_like(eqps)
    deviator = b_elastic.copy()
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    elastic = tensor_norm(deviator) / np.sqrt(6.0)  # sigma / (3 mu)
    flowing = np.where(multiplier_rate > 0.0, eqps, 0.0)
    total = elastic + flowing
    return np.maximum(np.where(flowing > 0.0, elastic / np.where(total > 0.0, total, 1.0), 1.0), _LEAST)
