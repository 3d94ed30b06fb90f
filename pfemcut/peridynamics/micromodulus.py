"""Stiffness and strength of bonds: on the lattice by equal energies, and the continuum's micromodulus.

The paper's equations are not in its text; these are derived here. A homogeneous strain gives a bond in direction n the
stretch s = n·eps·n. The lattice's energy, sum of 1/2 k R² s² over the three bonds a site owns, over the site's area
(sqrt(3)/2) R², is that of a lamina with Q12 = Q66 = Q22 / 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.peridynamics.lamina import Lamina

Array = NDArray[np.float64]

CELL = float(np.sqrt(3.0) / 2.0)
"""Area of the lattice that a site has, over the square of the spacing."""


@dataclass(frozen=True)
class BondStiffness:
    """Force over stretch and spacing (N/mm) of bonds along the fibre and at 60 degrees to it."""

    fibre: float
    matrix: float


def bond_stiffness(lamina: Lamina, thickness: float) -> BondStiffness:
    """k_f = (sqrt(3)/2) t (Q11 - Q22 / 9) and k_m = 4 t Q22 / (3 sqrt(3)).

    They solve Q11 t = (2/sqrt(3)) (k_f + k_m / 8) and Q22 t = (2/sqrt(3)) (9/8) k_m.

    Parameters
    ----------
    lamina
        Its constants (MPa).
    thickness
        t (mm).
    """
    return BondStiffness(
        fibre=CELL * thickness * (lamina.q11 - lamina.q22 / 9.0),
        matrix=4.0 * thickness * lamina.q22 / (3.0 * np.sqrt(3.0)),
    )


@dataclass(frozen=True)
class CriticalStretch:
    """Stretches at which bonds break.

    Attributes
    ----------
    opening, shear
        Of a pair of matrix bonds where there is no crack yet.
    growth_opening, growth_shear
        Likewise at a crack's tip.
    fibre
        Of a fibre bond.
    """

    opening: float
    shear: float
    growth_opening: float
    growth_shear: float
    fibre: float


def critical_stretch(
    lamina: Lamina, stiffness: BondStiffness, thickness: float, spacing: float, release: tuple[float, float]
) -> CriticalStretch:
    """Stretches at which the energy of the bonds that a crack cuts is that of its faces.

    A crack along the fibre cuts two matrix bonds a spacing R. In opening both have the stretch s, in shear s and -s, so
    their energy is k_m R² s² = G t R either way: s = sqrt(G t / (k_m R)). A crack straight across the fibres cuts in
    each row, (sqrt(3)/2) R high, one fibre bond and on average one matrix bond:
    s_f = sqrt(sqrt(3) G_f t / ((k_f + k_m) R)), the fourth part of whose matrix energy is stored in stretch along the
    fibre; this is the paper's form and overstates the matrix's part, which is small.

    Parameters
    ----------
    lamina, stiffness, thickness, spacing
        Constants (MPa, N/mm), t and R (mm).
    release
        Energy that the lattice releases when a pair at a crack's tip breaks, over the energy of the pair, in opening
        and in shear (:func:`pfemcut.peridynamics.crack_tip.tip_release`): at a tip Griffith's balance is with that.
    """

    def along(energy: float) -> float:
        return float(np.sqrt(energy * thickness / (stiffness.matrix * spacing)))

    opening, shear = along(lamina.opening_energy), along(lamina.shear_energy)

    both = (stiffness.fibre + stiffness.matrix) * spacing
    return CriticalStretch(
        opening=opening,
        shear=shear,
        growth_opening=opening / float(np.sqrt(release[0])),
        growth_shear=shear / float(np.sqrt(release[1])),
        fibre=float(np.sqrt(np.sqrt(3.0) * lamina.fibre_energy * thickness / both)),
    )


def continuum_micromodulus(
    stiffness: tuple[float, float, float], thickness: float, horizon: float, angle: Array
) -> Array:
    """c(theta) = A0 + A2 P2(cos theta) + A4 P4(cos theta) of the paper's appendix (MPa/mm⁴ times mm).

    With energy density 1/2 ∫ 1/2 c s² |xi| dV over a disc of the horizon. The Legendre polynomials are even, so c has
    the lamina's symmetry. Three constants fit Q11, Q12 and Q22 with Q66 = Q12. For carbon and epoxy c is negative
    about 60 degrees from the fibre, so it can't be put on the lattice's bonds.

    Parameters
    ----------
    stiffness
        Q11, Q12 and Q22 (MPa).
    thickness, horizon
        t and delta (mm).
    angle
        theta to the fibre (rad).

    Returns
    -------
    c (N/mm⁶), of the shape of ``angle``; 9 E / (pi t delta³) for an isotropic sheet, whose Poisson's ratio is 1/3.
    """
    q11, q12, q22 = stiffness
    scale = thickness * horizon**3 / 6.0
    cosine = np.cos(angle)
    second = 0.5 * (3.0 * cosine**2 - 1.0)
    fourth = 0.125 * (35.0 * cosine**4 - 30.0 * cosine**2 + 3.0)
    zeroth = (3.0 * q11 + 42.0 * q12 + 23.0 * q22) / (30.0 * np.pi * scale)
    return np.asarray(
        zeroth
        + 4.0 * (3.0 * q11 + 24.0 * q12 - 11.0 * q22) / (21.0 * np.pi * scale) * second
        + 64.0 * (q11 - 6.0 * q12 + q22) / (35.0 * np.pi * scale) * fourth
    )
