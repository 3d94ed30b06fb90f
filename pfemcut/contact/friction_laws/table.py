"""Coefficient of friction from tables in speed, pressure and temperature."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, Strict, model_validator

from pfemcut.contact.friction import Array, Interface
from pfemcut.contact.friction_laws.base import SpeedLaw, Strength
from pfemcut.input_table import InputTable

_NotNegative = Annotated[float, Field(ge=0)]


class Points(InputTable):
    """A piecewise linear function, constant beyond its ends, as ``{at = [...], value = [...]}``."""

    at: Annotated[tuple[_NotNegative, ...], Strict(False)] = Field(description="Increasing arguments")
    value: Annotated[tuple[_NotNegative, ...], Strict(False)] = Field(
        description="Values there (dimensionless)"
    )

    @model_validator(mode="after")
    def _is_a_function(self) -> Self:
        if len(self.at) != len(self.value) or not self.at:
            raise ValueError(
                f"given {len(self.at)} arguments and {len(self.value)} values, must be as many, at least one"
            )
        if any(after <= before for before, after in pairwise(self.at)):
            raise ValueError(f"given at = {list(self.at)}, must increase")
        return self

    def __call__(self, argument: Array) -> tuple[Array, Array]:
        """Value and slope at the ``argument`` (k,); at a point of the table the slope to its right."""
        at, value = np.asarray(self.at), np.asarray(self.value)
        slopes = np.concatenate([[0.0], np.diff(value) / np.diff(at), [0.0]])
        slope = slopes[np.searchsorted(at, argument, side="right")]
        return np.interp(argument, at, value), slope


_ONE = Points(at=(0.0,), value=(1.0,))


class TableLaw(SpeedLaw):
    r"""Coulomb friction with mu = mu(|v|) f(P_N) g(theta) from measured tables.

    1. Each table is linear between its points and constant beyond its ends.
    2. The coefficient follows the sliding speed over a distance, the memory.
    3. The factors of pressure and temperature are 1 unless given.
    4. The shear traction may be limited by m k and by a constant.
    """

    law: Literal["table"] = Field(description="Name of the law")
    coefficient: Points = Field(
        description="Coefficient mu by sliding speed (mm/s), as a table {at = [...], value = [...]}"
    )
    pressure_factor: Points = Field(default=_ONE, description="Factor f by pressure (MPa), as such a table")
    temperature_factor: Points = Field(
        default=_ONE, description="Factor g by temperature (K), as such a table"
    )

    def strength(self, interface: Interface) -> Strength:
        """mu P_N, limited."""
        pressure = interface.pressure
        mu, _ = self.coefficient(np.abs(interface.known_slip_speed))
        f, by_pressure = self.pressure_factor(pressure)
        g, _ = self.temperature_factor(interface.temperature)
        sliding = Strength(
            mu * f * g * pressure,
            mu * g * (f + by_pressure * pressure),
        )
        return self.limited(sliding, interface.flow_stress)
