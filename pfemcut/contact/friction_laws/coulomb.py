"""Coulomb friction (paper, eq. 26)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import LawModel, Strength


class Coulomb(LawModel):
    """Coulomb friction, tau = mu P_N tanh(v / V_ref) (paper, eq. 26)."""

    law: Literal["coulomb"] = Field(default="coulomb", description="Name of the law")
    coefficient: float = Field(ge=0, le=2, description="Coulomb coefficient mu (dimensionless)")

    @property
    def frictionless(self) -> bool:
        """Whether the coefficient is zero."""
        return self.coefficient == 0.0

    def strength(self, interface: Interface) -> Strength:
        """mu P_N."""
        pressure = interface.pressure
        return Strength(self.coefficient * pressure, np.full_like(pressure, self.coefficient))
