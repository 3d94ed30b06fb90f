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
    known_slip_speed
        Magnitude of the relative velocity up to the start of the step, see :func:`remembered_speed` (mm/s). A
        coefficient of friction that depends on speed takes it from here: a falling one would give several slip speeds
        to one load, and Newton's method fails.
    temperature, flow_stress
        Of the workpiece's surface (K, MPa), last known.
    """

    pressure: Array
    slip_speed: Array
    known_slip_speed: Array
    temperature: Array
    flow_stress: Array


@dataclass(frozen=True)
class Shear:
    """Shear traction (MPa, of the sign of the slip speed, which it opposes) and its derivatives; shape (k,).

    ``by_pressure`` is dimensionless, ``by_speed`` in MPa s/mm and never negative. What is last known does not change
    in a step, so that Newton's method needs no derivatives by it.
    """

    value: Array
    by_pressure: Array
    by_speed: Array


class FrictionLaw(Protocol):
    """Shear traction as a function of the interface's state."""

    @property
    def frictionless(self) -> bool:
        """Whether there is no shear traction at all, so that the contact's tangent is symmetric."""

    @property
    def sliding_memory(self) -> float:
        """Sliding distance over which the shear traction follows the sliding speed (mm), on a rigid tool."""

    def shear(self, interface: Interface, reference_speed: float) -> Shear:
        """Shear traction, regularised over the ``reference_speed`` V_ref (mm/s).

        It is odd in the slip speed and of its sign, so that friction never gives power.
        """


def remembered_speed(before: Array, speed: Array, step: float, memory: float) -> Array:
    """Sliding speed that friction knows after a step at ``speed`` (mm/s): s + (1 - exp(-v dt / d)) (v - s); (k,).

    A coefficient that falls with the speed makes quasi-static sliding unstable, whatever the step, unless it follows
    the speed over a distance d that is not too short: A. L. Ruina, Slip instability and state variable friction laws,
    J. Geophys. Res. 88, 1983, 10359-10370. See the documentation's page on friction.

    Parameters
    ----------
    before
        What it knew before the step, s (mm/s); shape (k,).
    speed
        Sliding speed of the step, v, not negative (mm/s); shape (k,).
    step
        Its length dt (s).
    memory
        Distance d (mm); zero: the last step's speed.
    """
    if memory == 0.0:
        return speed
    return before - np.expm1(-speed * step / memory) * (speed - before)
