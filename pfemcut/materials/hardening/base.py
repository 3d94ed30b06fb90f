"""What every hardening law shares: frozen validated constants and a positive floor of the flow stress."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from pfemcut.input_table import InputTable
from pfemcut.materials.material import Array, FlowStress


class LawModel(InputTable):
    """Base of the hardening laws; a subclass in a module of this package is found and offered by name.

    A subclass declares ``law: Literal["its-name"]``, its constants with units, and ``flow_stress``.
    """

    FLOOR: ClassVar[float] = 1e-3
    """Smallest flow stress, as a fraction of the initial yield stress."""

    def flow_stress(self, eqps: Array, rate: Array, temperature: Array) -> FlowStress:
        """Flow stress for equivalent plastic strain (-), its rate (1/s) and temperature (K); all of shape (n,)."""
        raise NotImplementedError(f"{type(self).__name__} has no flow_stress")


def floored(stress: FlowStress, floor: float) -> FlowStress:
    """``stress`` kept at ``floor`` (MPa) or above; the derivatives vanish where the floor acts.

    Softened metal would otherwise reach a zero or negative flow stress, for which no return mapping exists.
    """
    above = stress.value > floor
    return FlowStress(
        np.where(above, stress.value, floor),
        np.where(above, stress.by_eqps, 0.0),
        np.where(above, stress.by_rate, 0.0),
        np.where(above, stress.by_temperature, 0.0),
    )
