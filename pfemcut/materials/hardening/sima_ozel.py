"""Sima and Ozel's hardening with a hyperbolic tangent that softens with strain: serrated chips of titanium."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from pfemcut.materials.hardening.base import LawModel, floored
from pfemcut.materials.hardening.terms import melts_above_reference, rate_term, strain_power, thermal_term
from pfemcut.materials.material import Array, FlowStress


class SimaOzel(LawModel):
    r"""Johnson-Cook hardening with strain softening (Sima and Ozel 2010, their model 3).

    Sima, M., Ozel, T. 2010, Int. J. Mach. Tools Manuf. 50, 943-960, after Calamaz, Coupard, Girot 2008, ibid. 48,
    275-288. With absolute temperatures :math:`\theta`, and :math:`\tau = \theta / \theta_m` at most 1:

    1. Strain term :math:`s = A + B \varepsilon^n e^{-\varepsilon^a}`.
    2. Rate term :math:`r` and thermal term :math:`t` of Johnson and Cook.
    3. Softening :math:`f = D + (1 - D) \tanh^{S}\left((\varepsilon + P)^{-R}\right)` with
       :math:`D = 1 - \tau^d`, :math:`P = \tau^b`: 1 at no strain, and at large strains :math:`D`, the less the
       hotter.
    4. Flow stress :math:`\sigma_y = s\, r\, t\, f`, kept above 0.1 % of :math:`A`.
    """

    SMALLEST_SHIFT: ClassVar[float] = 1e-6
    """Smallest strain + P; the hyperbolic tangent is 1 to round-off long before."""

    law: Literal["sima-ozel"] = Field(description="Name of the law")
    A: float = Field(gt=0, description="Initial yield stress (MPa)")
    B: float = Field(ge=0, description="Hardening constant (MPa)")
    n: float = Field(gt=0, description="Hardening exponent (dimensionless)")
    C: float = Field(ge=0, description="Rate constant (dimensionless)")
    m: float = Field(gt=0, description="Thermal softening exponent (dimensionless)")
    a: float = Field(gt=0, description="Exponent of the strain in the decay of the hardening (dimensionless)")
    b: float = Field(gt=0, description="Exponent of temperature in P (dimensionless)")
    d: float = Field(gt=0, description="Exponent of temperature in D (dimensionless)")
    R: float = Field(gt=0, description="Exponent r of the shifted strain (dimensionless)")
    S: float = Field(gt=0, description="Exponent s of the hyperbolic tangent (dimensionless)")
    melting_temperature: float = Field(gt=0, description="Melting temperature (K)")
    reference_rate: float = Field(default=1.0, gt=0, description="Reference strain rate (1/s)")
    reference_temperature: float = Field(
        gt=0, description="Temperature theta_0 below which nothing softens (K); the material's unless given"
    )

    _melts = model_validator(mode="after")(melts_above_reference)

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s) and temperature (K); shape (n,)."""
        strain, strain_slope = self._strain_term(eqps)
        rating, rate_slope = rate_term(rate, self.C, self.reference_rate)
        thermal, thermal_slope = thermal_term(
            temperature, self.reference_temperature, self.melting_temperature, self.m
        )
        softening, by_strain, by_temperature = self._softening(eqps, temperature)
        return floored(
            FlowStress(
                strain * rating * thermal * softening,
                rating * thermal * (strain_slope * softening + strain * by_strain),
                strain * rate_slope * thermal * softening,
                strain * rating * (thermal_slope * softening + thermal * by_temperature),
            ),
            self.FLOOR * self.A,
        )

    def _strain_term(self, eqps: Array) -> tuple[Array, Array]:
        """s and its slope (MPa)."""
        power, power_slope = strain_power(eqps, self.n)
        exponent, exponent_slope = strain_power(eqps, self.a)
        decay = np.exp(-exponent)
        return self.A + self.B * power * decay, self.B * decay * (power_slope - power * exponent_slope)

    def _softening(self, eqps: Array, temperature: Array) -> tuple[Array, Array, Array]:
        """f, its derivative by strain, and by temperature (1/K)."""
        relative = np.clip(temperature / self.melting_temperature, 0.0, 1.0)
        # Derivatives of the powers of a temperature that is held at the melting one vanish.
        slope = np.where(temperature < self.melting_temperature, 1.0 / self.melting_temperature, 0.0)
        hot, hot_slope = relative**self.d, self.d * relative ** (self.d - 1.0) * slope
        shift, shift_slope = relative**self.b, self.b * relative ** (self.b - 1.0) * slope
        shifted = np.maximum(eqps + shift, self.SMALLEST_SHIFT)
        argument = shifted**-self.R
        tangent = np.tanh(argument)
        # 1 - tanh², which would lose its digits as a difference.
        small = np.exp(-2.0 * argument)
        one_minus_square = 4.0 * small / (1.0 + small) ** 2
        power = tangent**self.S
        by_shifted = -self.S * power / tangent * one_minus_square * self.R * argument / shifted
        return (
            1.0 - hot + hot * power,
            hot * by_shifted,
            -hot_slope * (1.0 - power) + hot * by_shifted * shift_slope,
        )
