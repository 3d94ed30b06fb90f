"""Coefficient of friction as powers of speed, pressure and temperature."""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from pfemcut.contact.friction import Interface
from pfemcut.contact.friction_laws.base import SpeedLaw, Strength


class PowerLaw(SpeedLaw):
    r"""Coulomb friction with mu = mu_0 (|v|/v_0)^a (P_N/P_0)^b (theta/theta_0)^c, kept within limits.

    1. Exponents of zero leave a dependence out; a alone is the form fitted to pin-on-bar tests.
    2. The coefficient follows the sliding speed over a distance, the memory.
    3. A sliding speed below the least one counts as that: a falling power would grow without end as the slip stops.
    4. :math:`\mu` is kept between its least and largest value, where its slopes vanish.
    5. The shear traction may be limited by m k and by a constant.

    Sources: that friction falls with the sliding speed, J. Rech, C. Claudin, E. D'Eramo, Identification of a friction
    model, Tribology International 42, 2009, 738-744; in pressure, speed and temperature, J. Brocail, M. Watremez,
    L. Dubar, Identification of a friction model for modelling of orthogonal cutting, Int. J. Mach. Tools Manuf. 50,
    2010, 807-814.
    """

    law: Literal["power"] = Field(description="Name of the law")
    coefficient: float = Field(
        gt=0, le=2, description="Coefficient mu_0 at the reference state (dimensionless)"
    )
    speed: float = Field(default=1000.0, gt=0, description="Reference sliding speed v_0 (mm/s)")
    pressure: float = Field(default=1000.0, gt=0, description="Reference pressure P_0 (MPa)")
    temperature: float = Field(default=293.15, gt=0, description="Reference temperature theta_0 (K)")
    least_speed: float = Field(default=10.0, gt=0, description="Least sliding speed that counts (mm/s)")
    speed_exponent: float = Field(default=0.0, ge=-1, le=1, description="Exponent a (dimensionless)")
    pressure_exponent: float = Field(
        default=0.0, gt=-1, le=1, description="Exponent b (dimensionless); the traction goes with P_N^(1+b)"
    )
    temperature_exponent: float = Field(default=0.0, ge=-10, le=10, description="Exponent c (dimensionless)")
    least: float = Field(default=0.0, ge=0, le=2, description="Least coefficient (dimensionless)")
    largest: float = Field(default=1.0, gt=0, le=2, description="Largest coefficient (dimensionless)")

    @model_validator(mode="after")
    def _has_room(self) -> Self:
        if self.least > self.largest:
            raise ValueError(f"least: given {self.least}, must not exceed largest = {self.largest:g}")
        return self

    def strength(self, interface: Interface) -> Strength:
        """mu P_N, limited."""
        speed = np.maximum(np.abs(interface.known_slip_speed), self.least_speed)
        # A power of zero may be infinite; the tiny value only keeps it finite, as mu has a largest value.
        pressure = np.maximum(interface.pressure, 1e-12 * self.pressure)
        power = (
            self.coefficient
            * (speed / self.speed) ** self.speed_exponent
            * (pressure / self.pressure) ** self.pressure_exponent
            * (interface.temperature / self.temperature) ** self.temperature_exponent
        )
        mu = np.clip(power, self.least, self.largest)
        free = (power > self.least) & (power < self.largest)
        normal = interface.pressure
        sliding = Strength(
            mu * normal,
            mu * np.where(free, 1.0 + self.pressure_exponent, 1.0),
        )
        return self.limited(sliding, interface.flow_stress)
