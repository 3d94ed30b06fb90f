"""Viscous friction of Norton and Hoff (paper, Table 5)."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Interface, Shear
from pfemcut.contact.friction_laws.base import LawModel, shear_yield_stress


class NortonHoff(LawModel):
    r"""Viscous friction, tau = a k |v|^(q-1) v, wherever there is contact, whatever the pressure.

    1. :math:`k = \sigma_y / \sqrt 3` of the workpiece's surface is the consistency; a has the unit (s/mm)^q.
    2. Regularised for q < 1: :math:`|v|` becomes :math:`(v^2 + V_{ref}^2)^{1/2}`; q = 1 needs none.

    The paper gives a "Norton Hoff coefficient" of 6e-5 (Table 5) without a unit, an exponent or its use.
    """

    law: Literal["norton-hoff"] = Field(description="Name of the law")
    coefficient: float = Field(ge=0, description="Coefficient a ((s/mm)^q)")
    exponent: float = Field(default=1.0, gt=0, le=1, description="Exponent q of the speed (dimensionless)")

    def shear(self, interface: Interface, reference_speed: float) -> Shear:
        """a k |v|^(q - 1) v, regularised over ``reference_speed`` (mm/s)."""
        speed, q = interface.slip_speed, self.exponent
        square = speed**2 + reference_speed**2
        touching = interface.pressure > 0.0
        viscosity = np.where(touching, self.coefficient * shear_yield_stress(interface.flow_stress), 0.0)
        viscosity *= square ** (0.5 * (q - 1.0))
        return Shear(
            viscosity * speed,
            np.zeros_like(speed),
            viscosity * (1.0 + (q - 1.0) * speed**2 / square),
        )
