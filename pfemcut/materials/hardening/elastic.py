"""No plasticity: a material that never yields."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from pfemcut.materials.hardening.base import LawModel
from pfemcut.materials.material import Array, FlowStress


class Elastic(LawModel):
    """An elastic material: a flow stress beyond any trial stress."""

    NEVER: ClassVar[float] = 1e12

    law: Literal["elastic"] = Field(description="Name of the law")

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """The unreachable flow stress, shape (n,) as ``eqps``."""
        zero = np.zeros_like(eqps)
        return FlowStress(np.full_like(eqps, self.NEVER), zero, zero, zero)
