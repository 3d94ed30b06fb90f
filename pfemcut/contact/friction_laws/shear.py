"""Friction by a constant part of the shear yield stress."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import LawModel, Strength, shear_yield_stress


class ShearFriction(LawModel):
    """Tresca's friction, tau = m k tanh(v / V_ref) wherever there is contact, whatever the pressure."""

    law: Literal["shear"] = Field(description="Name of the law")
    shear_factor: float = Field(
        gt=0, le=1, description="Shear traction over the workpiece's shear yield stress, m"
    )

    def strength(self, interface: Interface) -> Strength:
        """m k."""
        touching = interface.pressure > 0.0
        value = np.where(touching, self.shear_factor * shear_yield_stress(interface.flow_stress), 0.0)
        return Strength(value, np.zeros_like(value))
