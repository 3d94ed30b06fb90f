"""Johnson and Cook's hardening with strain rate and temperature (paper, section 4.3.2)."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pfemcut.materials.hardening.base import LawModel, floored
from pfemcut.materials.material import Array, FlowStress


class JohnsonCook(LawModel):
    r"""Johnson-Cook hardening (paper, eq. 11).

    1. Strain term :math:`s = A + B \varepsilon^n`. Its slope :math:`n B \varepsilon^{n-1}` is infinite at
       :math:`\varepsilon = 0` for :math:`n < 1`, so below :math:`\varepsilon_0 = 10^{-8}` the power is replaced by
       its chord from the origin, :math:`\varepsilon_0^{n-1} \varepsilon`: continuous, exact at zero, still
       concave for :math:`n < 1`, and the slope is that of the value.
    2. Rate term :math:`r = 1 + C \ln(\dot\varepsilon / \dot\varepsilon_0)`, 1 below the reference rate.
    3. Homologous temperature :math:`\theta^* = (\theta - \theta_0) / (\theta_m - \theta_0)`, clipped to [0, 1];
       thermal term :math:`t = 1 - \theta^{*m}`.
    4. Flow stress :math:`\sigma_y = s\, r\, t`, kept above 0.1 % of :math:`A` (melted metal has none).
    """

    SMALLEST_STRAIN: ClassVar[float] = 1e-8

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

    @model_validator(mode="after")
    def _melts_above_reference(self) -> Self:
        if self.melting_temperature <= self.reference_temperature:
            raise ValueError(
                f"melting_temperature: given {self.melting_temperature}, must be greater than "
                f"reference_temperature = {self.reference_temperature} (K)"
            )
        return self

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s) and temperature (K); shape (n,)."""
        smallest = self.SMALLEST_STRAIN
        strain = np.maximum(eqps, smallest)
        on_chord = eqps < smallest
        chord = smallest ** (self.n - 1.0)
        power = np.where(on_chord, chord * eqps, strain**self.n)
        power_slope = np.where(on_chord, chord, self.n * strain ** (self.n - 1.0))

        relative_rate = np.maximum(rate / self.reference_rate, 1.0)
        rate_term = 1.0 + self.C * np.log(relative_rate)
        rate_slope = np.where(rate > self.reference_rate, self.C / (relative_rate * self.reference_rate), 0.0)

        span = self.melting_temperature - self.reference_temperature
        homologous = np.clip((temperature - self.reference_temperature) / span, 0.0, 1.0)
        thermal_term = 1.0 - homologous**self.m

        strain_term = self.A + self.B * power
        return floored(
            FlowStress(
                strain_term * rate_term * thermal_term,
                self.B * power_slope * rate_term * thermal_term,
                strain_term * rate_slope * thermal_term,
            ),
            self.FLOOR * self.A,
        )
