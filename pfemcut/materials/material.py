"""A material: constants, temperature tables and a hardening law, as frozen validated data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FlowStress:
    """Flow stress (MPa) and its derivatives at a set of points; each of shape (n,)."""

    value: Array
    by_eqps: Array
    by_rate: Array
    by_temperature: Array


class HardeningLaw(Protocol):
    """Flow stress as a function of plastic strain, its rate and temperature."""

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s) and temperature (K); all of shape (n,)."""


@dataclass(frozen=True)
class Property:
    """A material property as a piecewise linear function of temperature, constant beyond its ends.

    Attributes
    ----------
    temperatures
        Increasing temperatures (K); a single one makes the property constant.
    values
        Values of the property there.
    """

    temperatures: tuple[float, ...]
    values: tuple[float, ...]

    def __call__(self, temperature: Array) -> Array:
        """The property at each ``temperature`` (K); same shape."""
        return np.interp(temperature, self.temperatures, self.values)


@dataclass(frozen=True)
class Material:
    """A thermo-elastoplastic metal.

    Attributes
    ----------
    name, source
        Name and citations, for reports.
    young_modulus
        MPa.
    poisson_ratio
        Dimensionless.
    density
        Referential density (tonne/mm³).
    expansion
        Linear thermal expansion, secant from the reference temperature (1/K).
    capacity
        Specific heat (mm²/(s² K)).
    conductivity
        N/(s K).
    reference_temperature
        Stress-free temperature theta_0 (K).
    taylor_quinney
        Fraction chi of the plastic power that heats.
    hardening
        The hardening law.
    sources
        Where each value comes from: pairs of a key of the material file and words.
    checked
        Against what the values were checked, and which of them were not.
    notes
        What a user must know: misprints, choices that are not in the sources.
    """

    name: str
    source: str
    young_modulus: float
    poisson_ratio: float
    density: float
    expansion: Property
    capacity: Property
    conductivity: Property
    reference_temperature: float
    taylor_quinney: float
    hardening: HardeningLaw
    sources: tuple[tuple[str, str], ...] = ()
    checked: str = ""
    notes: tuple[str, ...] = ()

    @property
    def shear_modulus(self) -> float:
        """Shear modulus mu (MPa)."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    def thermal_strain(self, temperature: Array) -> Array:
        """e = 3 alpha (theta - theta_0) at the ``temperature`` (K); same shape."""
        return 3.0 * self.expansion(temperature) * (temperature - self.reference_temperature)

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus kappa (MPa)."""
        return self.young_modulus / (3.0 * (1.0 - 2.0 * self.poisson_ratio))
