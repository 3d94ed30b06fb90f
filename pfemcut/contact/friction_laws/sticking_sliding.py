"""Sticking and sliding: Coulomb friction with a limit of the shear traction."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import LimitedLaw, Strength


class StickingSliding(LimitedLaw):
    r"""Zorev's sticking and sliding zones, tau = min(mu P_N, m k, tau_max) tanh(v / V_ref).

    1. Where the pressure is low the chip slides, :math:`\tau = \mu P_N`.
    2. Near the edge the workpiece shears at its own :math:`k = \sigma_y / \sqrt 3` before it slides:
       :math:`\tau = m k`, with the flow stress at the surface's temperature, strain and rate.
    3. A constant limit :math:`\tau_{max}` may be given, in the place of m or together with it.

    Source: N. N. Zorev, Inter-relationship between shear processes occurring along tool face and shear plane in metal
    cutting, Int. Research in Production Engineering, ASME, 1963, 42-49.
    """

    law: Literal["sticking-sliding"] = Field(description="Name of the law")
    coefficient: float = Field(
        ge=0, le=2, description="Coulomb coefficient mu where it slides (dimensionless)"
    )

    @model_validator(mode="after")
    def _has_a_limit(self) -> Self:
        if self.shear_factor is None and self.shear_limit is None:
            raise ValueError("needs shear_factor, shear_limit or both")
        return self

    def strength(self, interface: Interface) -> Strength:
        """min(mu P_N, m k, tau_max)."""
        pressure = interface.pressure
        sliding = Strength(self.coefficient * pressure, np.full_like(pressure, self.coefficient))
        return self.limited(sliding, interface.flow_stress)
