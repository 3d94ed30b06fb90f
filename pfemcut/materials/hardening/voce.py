"""Voce's saturating hardening with thermal softening (paper, section 4.3.1)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.materials.hardening.base import LawModel, floored
from pfemcut.materials.material import Array, FlowStress


class Voce(LawModel):
    r"""Voce hardening, rate independent (paper, eq. 10, in the two-coefficient form of Simo and Miehe 1992).

    With :math:`\Delta\theta = \theta - \theta_0`:

    1. Soften the constants: :math:`\hat\sigma_0 = \sigma_0 (1 - w_0 \Delta\theta)`,
       :math:`\hat K_\infty = K_\infty (1 - w_h \Delta\theta)`, :math:`\hat H = H (1 - w_h \Delta\theta)`.
    2. Flow stress: :math:`\sigma_y = \hat K_\infty - (\hat K_\infty - \hat\sigma_0) e^{-\delta \varepsilon}
       + \hat H \varepsilon`. For :math:`w_0 = w_h` this is eq. 10.
    3. Derivative: :math:`\sigma_y' = \delta (\hat K_\infty - \hat\sigma_0) e^{-\delta \varepsilon} + \hat H`.
    4. Where softening takes the flow stress below 0.1 % of :math:`\sigma_0`, keep it there.
    """

    law: Literal["voce"] = Field(description="Name of the law")
    yield_stress: float = Field(gt=0, description="Initial yield stress sigma_0 (MPa)")
    saturation_stress: float = Field(gt=0, description="Saturation stress K_inf (MPa)")
    linear_hardening: float = Field(ge=0, description="Linear hardening modulus H (MPa)")
    exponent: float = Field(ge=0, description="Saturation exponent delta (dimensionless)")
    flow_stress_softening: float = Field(
        default=0.0, ge=0, lt=0.1, description="Softening w_0 of the initial yield stress (1/K)"
    )
    hardening_softening: float = Field(
        default=0.0, ge=0, lt=0.1, description="Softening w_h of the hardening (1/K)"
    )
    reference_temperature: float = Field(
        gt=0, description="Temperature theta_0 of the constants (K); the material's unless given"
    )

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s, unused) and temperature (K); shape (n,)."""
        warming = temperature - self.reference_temperature
        initial = self.yield_stress * (1.0 - self.flow_stress_softening * warming)
        softened = 1.0 - self.hardening_softening * warming
        saturation = self.saturation_stress * softened
        linear = self.linear_hardening * softened

        left = np.exp(-self.exponent * eqps)
        decay = (saturation - initial) * left
        value = saturation - decay + linear * eqps
        slope = self.exponent * decay + linear
        initial_by_temperature = -self.flow_stress_softening * self.yield_stress
        hardened = self.saturation_stress * (1.0 - left) + self.linear_hardening * eqps
        by_temperature = initial_by_temperature * left - self.hardening_softening * hardened
        return floored(
            FlowStress(value, slope, np.zeros_like(value), by_temperature), self.FLOOR * self.yield_stress
        )
