"""What friction laws share: frozen validated constants, regularisation of the slip, and limits of the shear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from pfemcut.contact.friction import Array, Interface, Shear
from pfemcut.input_table import InputTable

_ROOT_3 = np.sqrt(3.0)


@dataclass(frozen=True)
class Strength:
    """Largest shear traction (MPa), not negative, with its derivative by pressure; (k,)."""

    value: Array
    by_pressure: Array


class LawModel(InputTable):
    """Base of the friction laws; a subclass in a module of this package is found and offered by name.

    A subclass declares ``law: Literal["its-name"]``, its constants with units, and ``strength``. The shear traction
    is then strength tanh(v / V_ref), eq. 26 of the paper with the strength instead of mu P_N.
    """

    @property
    def frictionless(self) -> bool:
        """Whether the constants leave no friction at all."""
        return False

    @property
    def sliding_memory(self) -> float:
        """Zero: the shear traction does not depend on the sliding speed but for its regularisation."""
        return 0.0

    def strength(self, interface: Interface) -> Strength:
        """Shear traction of a contact that slides fast against V_ref."""
        raise NotImplementedError(f"{type(self).__name__} has no strength")

    def shear(self, interface: Interface, reference_speed: float) -> Shear:
        """Shear traction, regularised over ``reference_speed`` (mm/s); see :class:`FrictionLaw`."""
        strength = self.strength(interface)
        ratio = np.tanh(interface.slip_speed / reference_speed)
        return Shear(
            value=strength.value * ratio,
            by_pressure=strength.by_pressure * ratio,
            by_speed=strength.value * (1.0 - ratio**2) / reference_speed,
        )


def shear_yield_stress(flow_stress: Array) -> Array:
    """k = sigma_y / sqrt(3) of von Mises (MPa) for the flow stress (MPa); same shape."""
    return flow_stress / _ROOT_3


class LimitedLaw(LawModel):
    """Base of laws mu P_N whose shear traction may be limited by what the workpiece can bear (Zorev 1963)."""

    shear_factor: float | None = Field(
        default=None,
        gt=0,
        le=1,
        description="Limit of the shear traction over the workpiece's shear yield stress; none unless given",
    )
    shear_limit: float | None = Field(
        default=None, gt=0, description="Limit of the shear traction (MPa); none unless given"
    )

    def limited(self, sliding: Strength, flow_stress: Array) -> Strength:
        """The smaller of ``sliding`` and the limits; the derivative vanishes where a limit acts."""
        limit = np.full_like(flow_stress, np.inf)
        if self.shear_factor is not None:
            limit = self.shear_factor * shear_yield_stress(flow_stress)
        if self.shear_limit is not None:
            limit = np.minimum(limit, self.shear_limit)
        slides = sliding.value < limit
        return Strength(
            np.where(slides, sliding.value, limit),
            np.where(slides, sliding.by_pressure, 0.0),
        )


class SpeedLaw(LimitedLaw):
    """Base of laws mu P_N whose coefficient depends on the sliding speed."""

    memory: float = Field(
        default=0.005,
        ge=0,
        description="Sliding distance over which the coefficient follows the speed (mm); 0: it takes the last step's",
    )

    @property
    def sliding_memory(self) -> float:
        """The given distance."""
        return self.memory
