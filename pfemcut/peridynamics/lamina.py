"""A unidirectional lamina: its constants, its stiffness in fibre axes, and laminate theory for any fibre angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POISSON_RATIO = 1.0 / 3.0
"""nu_12 of every lamina whose bonds are springs: Q12 = Q22 / 3, as for central forces in the plane (Cauchy)."""


@dataclass(frozen=True)
class Lamina:
    """Constants of a lamina; direction 1 is along the fibre, 2 across it in the plane.

    Attributes
    ----------
    name
        For reports.
    axial_modulus, transverse_modulus
        E1 and E2 (MPa).
    density
        tonne/mm³.
    opening_energy, shear_energy
        Energy release rates G_Ic and G_IIc of cracks along the fibre (N/mm).
    fibre_energy
        Energy release rate of a crack across the fibres (N/mm).
    """

    name: str
    axial_modulus: float
    transverse_modulus: float
    density: float
    opening_energy: float
    shear_energy: float
    fibre_energy: float

    @property
    def minor_poisson_ratio(self) -> float:
        """nu_21 = nu_12 E2 / E1."""
        return POISSON_RATIO * self.transverse_modulus / self.axial_modulus

    @property
    def q11(self) -> float:
        """Q11 = E1 / (1 - nu_12 nu_21) (MPa)."""
        return self.axial_modulus / (1.0 - POISSON_RATIO * self.minor_poisson_ratio)

    @property
    def q22(self) -> float:
        """Q22 = E2 / (1 - nu_12 nu_21) (MPa)."""
        return self.transverse_modulus / (1.0 - POISSON_RATIO * self.minor_poisson_ratio)

    @property
    def q12(self) -> float:
        """Q12 = nu_12 Q22 (MPa)."""
        return POISSON_RATIO * self.q22

    @property
    def shear_modulus(self) -> float:
        """G12 = Q66 = Q12 (MPa), the second part of the restriction on springs."""
        return self.q12

    @property
    def stiffness(self) -> Array:
        """Plane-stress stiffness Q in fibre axes, for strains (11, 22, gamma_12) (MPa); shape (3, 3)."""
        return np.array(
            [[self.q11, self.q12, 0.0], [self.q12, self.q22, 0.0], [0.0, 0.0, self.shear_modulus]]
        )

    @property
    def wave_speed(self) -> float:
        """Of longitudinal waves along the fibre, sqrt(Q11 / rho) (mm/s)."""
        return float(np.sqrt(self.q11 / self.density))


def strain_rotation(angle: float) -> Array:
    """Matrix from engineering strains (xx, yy, gamma_xy) to those in axes turned by ``angle`` (rad); shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array(
        [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]]
    )


def turned_stiffness(lamina: Lamina, angle: float) -> Array:
    """Stiffness in axes to which the fibre has the angle ``angle`` (rad), (MPa); shape (3, 3)."""
    turn = strain_rotation(angle)
    return np.asarray(turn.T @ lamina.stiffness @ turn)


def young_modulus(lamina: Lamina, angle: float) -> float:
    """Young's modulus (MPa) of a pull at ``angle`` (rad) to the fibre, by laminate theory."""
    return float(1.0 / np.linalg.inv(turned_stiffness(lamina, angle))[0, 0])
