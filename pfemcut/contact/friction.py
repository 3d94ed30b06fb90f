"""What friction laws take and give: the state of the interface, and the shear traction with its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Interface:
    """State of the interface at a set of contact points; each of shape (k,).

    Attributes
    ----------
    pressure
        Normal traction, positive in compression (MPa).
    slip_speed
        Signed tangential speed relative to the other body (mm/s).
    temperature
        Of the workpiece's surface (K), last known.
    flow_stress
        Of the workpiece's surface (MPa), last known.
    """

    pressure: Array
    slip_speed: Array
    temperature: Array
    flow_stress: Array


@dataclass(frozen=True)
class Shear:
    """Shear traction (MPa, of the sign of the slip speed, which it opposes) and its derivatives; shape (k,).

    ``by_pressure`` is dimensionless, ``by_speed`` in MPa s/mm. Temperature and flow stress are those of the start of
    the step, so that Newton's method needs no derivatives by them.
    """

    value: Array
    by_pressure: Array
    by_speed: Array


class FrictionLaw(Protocol):
    """Shear traction as a function of the interface's state."""

    def shear(self, interface: Interface, reference_speed: float) -> Shear:
        """Shear traction, regularised over the ``reference_speed`` V_ref (mm/s).

        It is odd in the slip speed and of its sign, so that friction never gives power.
        """
