"""Two half spaces that touch from time zero, with effusivities b = sqrt(k rho c).

Friction: a constant heat flux q that arises between them, at a perfect interface, warms both surfaces alike,
2 q sqrt(t / pi) / (b1 + b2): each takes the share b / (b1 + b2) (Carslaw and Jaeger, Conduction of Heat in Solids,
1959, section 2.9, of each half with its share).

Conduction: two temperatures apart by D and a conductance h. With H = h (1 / b1 + 1 / b2) the flux is
h D exp(H^2 t) erfc(H sqrt(t)), and the surface of the first changes by
D b2 / (b1 + b2) (1 - exp(H^2 t) erfc(H sqrt(t))) (the half space with radiation into a medium, same book,
section 2.7, in the difference of the temperatures).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfcx

Array = NDArray[np.float64]


def effusivity(conductivity: float, density: float, capacity: float) -> float:
    """b = sqrt(k rho c), N/(mm K sqrt(s))."""
    return float(np.sqrt(conductivity * density * capacity))


def friction_warming(flux: float, time: Array, one: float, two: float) -> Array:
    """Warming (K) of both surfaces by the ``flux`` (mW/mm²) after ``time`` (s); effusivities ``one`` and ``two``."""
    return 2.0 * flux * np.sqrt(time / np.pi) / (one + two)


def conduction_warming(difference: float, conductance: float, time: Array, one: float, two: float) -> Array:
    """Warming (K) of the surface of body one by body two, which is hotter by ``difference``."""
    share = conductance * (1.0 / one + 1.0 / two)
    return difference * two / (one + two) * (1.0 - erfcx(share * np.sqrt(time)))


def confined_modulus(young: float, poisson: float) -> float:
    """Stiffness (MPa) of a layer that can't widen."""
    return young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
