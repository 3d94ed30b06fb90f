"""Usui's smooth passage from sliding to sticking, and its later form with two more constants."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import LawModel, Strength, shear_yield_stress


class Usui(LawModel):
    r"""Smooth sticking and sliding, tau = m k [1 - exp(-(mu P_N / m k)^n)]^(1/n).

    1. m = n = 1 is the law of Usui and Shirakashi, :math:`\tau = k (1 - \exp(-\mu P_N / k))`.
    2. A low pressure gives :math:`\mu P_N`, a high one :math:`m k`; the larger n, the sharper the passage.

    Sources: E. Usui, T. Shirakashi, Mechanics of machining - from descriptive to predictive theory, ASME PED 7, 1982,
    13-35; with m and n: M. H. Dirikolu, T. H. C. Childs, K. Maekawa, Finite element simulation of chip flow in metal
    machining, Int. J. Mech. Sci. 43, 2001, 2699-2713.
    """

    law: Literal["usui"] = Field(description="Name of the law")
    coefficient: float = Field(
        gt=0, le=2, description="Coulomb coefficient mu at low pressure (dimensionless)"
    )
    shear_factor: float = Field(
        default=1.0,
        gt=0,
        le=1,
        description="Limit of the shear traction over the workpiece's shear yield stress, m",
    )
    exponent: float = Field(
        default=1.0, ge=1, le=20, description="Sharpness n of the passage (dimensionless)"
    )

    def strength(self, interface: Interface) -> Strength:
        """m k (1 - exp(-x^n))^(1/n) with x = mu P_N / (m k)."""
        n = self.exponent
        limit = self.shear_factor * shear_yield_stress(interface.flow_stress)
        x = self.coefficient * np.maximum(interface.pressure, 0.0) / limit
        power = x**n
        sticking = -np.expm1(-power)
        # d/dx (1 - exp(-x^n))^(1/n) = (x^n / (1 - exp(-x^n)))^((n - 1) / n) exp(-x^n), which is 1 at x = 0.
        quotient = np.where(power > 0.0, power / np.where(power > 0.0, sticking, 1.0), 1.0)
        slope = quotient ** ((n - 1.0) / n) * np.exp(-power)
        return Strength(limit * sticking ** (1.0 / n), self.coefficient * slope)
