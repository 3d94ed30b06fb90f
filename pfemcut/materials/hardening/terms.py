"""Terms that hardening laws of Johnson and Cook's kind share, each with its derivative."""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np

from pfemcut.materials.material import Array

SMALLEST_STRAIN = 1e-8
"""Below it the power of the strain follows its chord from the origin."""


class _Melting(Protocol):
    melting_temperature: float
    reference_temperature: float


MeltingLaw = TypeVar("MeltingLaw", bound=_Melting)


def melts_above_reference(law: MeltingLaw) -> MeltingLaw:
    """``law``, whose melting temperature must lie above its reference temperature (K).

    Raises
    ------
    ValueError
        If it does not.
    """
    if law.melting_temperature <= law.reference_temperature:
        raise ValueError(
            f"melting_temperature: given {law.melting_temperature}, must be greater than "
            f"reference_temperature = {law.reference_temperature} (K)"
        )
    return law


def strain_power(eqps: Array, exponent: float) -> tuple[Array, Array]:
    r"""Power :math:`\varepsilon^n` and its slope; shape (n,).

    The slope :math:`n \varepsilon^{n-1}` is infinite at :math:`\varepsilon = 0` for :math:`n < 1`, so below
    :math:`\varepsilon_0 = 10^{-8}` the power is replaced by its chord from the origin,
    :math:`\varepsilon_0^{n-1} \varepsilon`: continuous, exact at zero, still concave for :math:`n < 1`, and the
    slope is that of the value.
    """
    strain = np.maximum(eqps, SMALLEST_STRAIN)
    on_chord = eqps < SMALLEST_STRAIN
    chord = SMALLEST_STRAIN ** (exponent - 1.0)
    power = np.where(on_chord, chord * eqps, strain**exponent)
    slope = np.where(on_chord, chord, exponent * strain ** (exponent - 1.0))
    return power, slope


def rate_term(rate: Array, constant: float, reference_rate: float) -> tuple[Array, Array]:
    r"""Term :math:`1 + C \ln(\dot\varepsilon / \dot\varepsilon_0)`, 1 below the reference rate; and its slope (s)."""
    relative = np.maximum(rate / reference_rate, 1.0)
    term = 1.0 + constant * np.log(relative)
    slope = np.where(rate > reference_rate, constant / (relative * reference_rate), 0.0)
    return term, slope


def thermal_term(
    temperature: Array, reference_temperature: float, melting_temperature: float, exponent: float
) -> tuple[Array, Array]:
    r"""Term :math:`1 - \theta^{*m}` with :math:`\theta^*` clipped to [0, 1], and its slope (1/K); shape (n,).

    The slope is taken as zero at and beyond the ends.
    """
    span = melting_temperature - reference_temperature
    homologous = np.clip((temperature - reference_temperature) / span, 0.0, 1.0)
    power = homologous**exponent
    between = (homologous > 0.0) & (homologous < 1.0)
    slope = np.where(between, -exponent * power / (np.where(between, homologous, 1.0) * span), 0.0)
    return 1.0 - power, slope
