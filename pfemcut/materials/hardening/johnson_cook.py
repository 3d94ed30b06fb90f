"""Johnson and Cook's hardening with strain rate and temperature (paper, section 4.3.2)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from pfemcut.materials.hardening.base import LawModel, floored
from pfemcut.materials.hardening.terms import melts_above_reference, rate_term, strain_power, thermal_term
from pfemcut.materials.material import Array, FlowStress


class JohnsonCook(LawModel):
    r"""Johnson-Cook hardening (paper, eq. 11).

    1. Strain term :math:`s = A + B \varepsilon^n`, the power replaced by a chord below :math:`\varepsilon = 10^{-8}`.
    2. Rate term :math:`r = 1 + C \ln(\dot\varepsilon / \dot\varepsilon_0)`, 1 below the reference rate.
    3. Homologous temperature :math:`\theta^* = (\theta - \theta_0) / (\theta_m - \theta_0)`, clipped to [0, 1];
       thermal term :math:`t = 1 - \theta^{*m}`.
    4. Flow stress :math:`\sigma_y = s\, r\, t`, kept above 0.1 % of :math:`A` (melted metal has none).

    The terms are in :mod:`pfemcut.materials.hardening.terms`.
    """

    law: Literal["johnson-cook"] = Field(description="Name of the law")
    A: float = Field(gt=0, description="Initial yield stress (MPa)")
    B: float = Field(ge=0, description="Hardening constant (MPa)")
    n: float = Field(gt=0, description="Hardening exponent (dimensionless)")
    C: float = Field(ge=0, description="Rate constant (dimensionless)")
    m: float = Field(gt=0, description="Thermal softening exponent (dimensionless)")
    melting_temperature: float = Field(gt=0, description="Melting temperature (K)")
    reference_rate: float = Field(default=1.0, gt=0, description="Reference strain rate (1/s)")
    reference_temperature: float = Field(
        gt=0, description="Temperature theta_0 below which nothing softens (K); the material's unless given"
    )

    _melts = model_validator(mode="after")(melts_above_reference)

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s) and temperature (K); shape (n,)."""
        power, power_slope = strain_power(eqps, self.n)
        rate_factor, rate_slope = rate_term(rate, self.C, self.reference_rate)
        thermal_factor, thermal_slope = thermal_term(
            temperature, self.reference_temperature, self.melting_temperature, self.m
        )
        strain_factor = self.A + self.B * power
        return floored(
            FlowStress(
                strain_factor * rate_factor * thermal_factor,
                self.B * power_slope * rate_factor * thermal_factor,
                strain_factor * rate_slope * thermal_factor,
                strain_factor * rate_factor * thermal_slope,
            ),
            self.FLOOR * self.A,
        )
