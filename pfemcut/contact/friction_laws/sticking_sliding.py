"""Sticking and sliding: Coulomb friction with a limit of the shear traction."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import LimitedLaw, Strength


class StickingSliding(LimitedLaw):
    r"""Zorev's sticking and sliding zones, :math:`\tau = \min(\mu P_N, m k, \tau_{max}) \tanh(v / V_{ref})`.

    1. Where the pressure is low the chip slides, :math:`\tau = \mu P_N`.
    2. Near the edge the workpiece shears at its own :math:`k = \sigma_y / \sqrt 3` before it slides:
       :math:`\tau = m k`, with the flow stress at the surface's temperature, strain and rate.
    3. A constant limit :math:`\tau_{max}` may be given, together with m or in its place.

    Source: N. N. Zorev, Inter-relationship between shear processes occurring along tool face and shear plane in metal
    cutting, Int. Research in Production Engineering, ASME, 1963, 42-49.
    """

    law: Literal["sticking-sliding"] = Field(description="Name of the law")
    coefficient: float = Field(
        ge=0, le=2, description="Coulomb coefficient mu where it slides (dimensionless)"
    )
    shear_factor: float | None = Field(
        default=1.0,
        gt=0,
        le=1,
        description="Limit of the shear traction over the workpiece's shear yield stress, m",
    )

    def strength(self, interface: Interface) -> Strength:
        """min(mu P_N, m k, tau_max)."""
        pressure = interface.pressure
        sliding = Strength(
            self.coefficient * pressure, np.full_like(pressure, self.coefficient), np.zeros_like(pressure)
        )
        return self.limited(sliding, interface.flow_stress)
