"""What the lattice model of a lamina is given: plate, lamina, lattice, failure, pull and controls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.problem import ExplicitTime, OneStage
from pfemcut.peridynamics.lamina import Lamina
from pfemcut.peridynamics.micromodulus import (
    CELL,
    BondStiffness,
    CriticalStretch,
    bond_stiffness,
    critical_stretch,
)
from pfemcut.peridynamics.plate import Plate, lattice_sites
from pfemcut.problem import Cut, MovingTool

if TYPE_CHECKING:
    from pfemcut.peridynamics.bonds import Bonds

Array = NDArray[np.float64]


INNER = 0.95
"""Part of the length between the grips in which parts are counted."""


class Criterion(Enum):
    """When matrix bonds break: by their own stretch, by the traction on a plane along the fibre, or never."""

    STRETCH = "stretch"
    MIXED_MODE = "mixed-mode"
    NONE = "none"


@dataclass(frozen=True)
class Failure:
    """How bonds fail.

    Attributes
    ----------
    criterion
        Of matrix bonds.
    growth
        Whether bonds at a crack's tip fail by the energy that the lattice releases, not by their own (mixed mode only).
    fibres_break
        Whether fibre bonds break too.
    """

    criterion: Criterion
    growth: bool
    fibres_break: bool


@dataclass(frozen=True)
class Pull:
    """The motion of the grips, apart along x.

    Attributes
    ----------
    speed
        Of the grips relative to each other (mm/s).
    sliding
        Whether the plate slides in the grips across the pull.
    protected
        Distance from the grips within which no bond fails (mm).
    """

    speed: float
    sliding: bool
    protected: float


@dataclass(frozen=True)
class LaminaProblem(OneStage):
    """A complete problem of a lamina in tension.

    Attributes
    ----------
    title
        One line for reports.
    lamina, plate, spacing
        Material, geometry, and lattice spacing R (mm).
    failure, pull, time
        How bonds fail, how the grips move, and time steps.
    damping
        Time constant of the dashpot beside each spring, over R / c.
    """

    title: str
    lamina: Lamina
    plate: Plate
    spacing: float
    failure: Failure
    pull: Pull
    time: ExplicitTime
    damping: float
    cut: tuple[Cut, ...] = ()
    tool: tuple[MovingTool, ...] = ()

    def cutting_at(self, time: float) -> bool:
        """Whether a step that ended at ``time`` (s) belongs to a cut; none does."""
        return False

    @cached_property
    def sites(self) -> Array:
        """Sites of the lattice (mm); shape (n, 2)."""
        return lattice_sites(self.plate, self.spacing)

    @cached_property
    def bonds(self) -> Bonds:
        """Bonds between nearest sites."""
        # Here and below: a check of another case needs neither scipy nor numba, which take seconds to load.
        from pfemcut.particles.neighbours import neighbours_within
        from pfemcut.peridynamics.bonds import bonds_of

        group = np.zeros(len(self.sites), dtype=np.int64)
        neighbours = neighbours_within(self.sites, 1.1 * self.spacing, group)
        return bonds_of(self.plate, self.sites, neighbours)

    @cached_property
    def stiffness(self) -> BondStiffness:
        """Of the bonds (N/mm)."""
        return bond_stiffness(self.lamina, self.plate.thickness)

    @cached_property
    def critical(self) -> CriticalStretch:
        """Stretches at which bonds break."""
        from pfemcut.peridynamics.crack_tip import tip_release

        release = tip_release(self.stiffness) if self.failure.growth else (1.0, 1.0)
        return critical_stretch(self.lamina, self.stiffness, self.plate.thickness, self.spacing, release)

    @property
    def limits(self) -> tuple[int, float, float, float, float, float]:
        """What the kernels take as limits of failure: see :mod:`pfemcut.peridynamics.kernels`."""
        from pfemcut.peridynamics.kernels import MIXED_MODE, STRETCH

        critical, criterion = self.critical, self.failure.criterion
        fibre = critical.fibre if self.failure.fibres_break else math.inf
        if criterion is Criterion.NONE:
            return (MIXED_MODE, 0.0, 0.0, 0.0, 0.0, fibre)
        return (
            STRETCH if criterion is Criterion.STRETCH else MIXED_MODE,
            critical.opening**-2,
            critical.shear**-2,
            critical.growth_opening**-2,
            critical.growth_shear**-2,
            fibre,
        )

    @property
    def site_mass(self) -> float:
        """Mass of a site (tonne), scaled: rho (sqrt(3) / 2) R² t."""
        density = self.time.mass_scaling * self.lamina.density
        return density * CELL * self.spacing**2 * self.plate.thickness

    @property
    def dt(self) -> float:
        """Time step (s): at most the Courant number times R / sqrt(Q11 / rho), and a whole number to the end."""
        speed = self.lamina.wave_speed / math.sqrt(self.time.mass_scaling)
        return self.time.end / math.ceil(self.time.end * speed / (self.time.courant * self.spacing))

    @property
    def dashpot(self) -> float:
        """Time constant of the dashpots (s)."""
        return self.damping * self.spacing / self.lamina.wave_speed

    @cached_property
    def grip(self) -> NDArray[np.int8]:
        """-1 for sites in the left grip, 1 in the right one, else 0; shape (n,)."""
        x, half = self.sites[:, 0], 0.5 * self.plate.length
        return ((x > half).astype(np.int8) - (x < -half).astype(np.int8)).astype(np.int8)

    @cached_property
    def inner(self) -> NDArray[np.bool_]:
        """Whether a site is not in or next to a grip, which holds parts together; shape (n,)."""
        return np.asarray(np.abs(self.sites[:, 0]) <= 0.5 * INNER * self.plate.length)

    @cached_property
    def weak(self) -> NDArray[np.uint8]:
        """1 for sites whose bonds may fail, else 0; shape (n,)."""
        reach = 0.5 * self.plate.length - self.pull.protected
        return (np.abs(self.sites[:, 0]) <= reach).astype(np.uint8)

    @cached_property
    def free(self) -> Array:
        """1 for components of motion that are free, else 0; shape (n, 2)."""
        free = np.ones_like(self.sites)
        free[self.grip != 0, 0] = 0.0
        if not self.pull.sliding:
            free[self.grip != 0, 1] = 0.0
        return free

    @cached_property
    def start_velocity(self) -> Array:
        """That of a uniform strain rate along the pull, so that no shock starts at the grips (mm/s); shape (n, 2)."""
        fraction = np.clip(self.sites[:, 0] / self.plate.length, -0.5, 0.5)
        return np.column_stack([self.pull.speed * fraction, np.zeros(len(fraction))])

    @property
    def grip_velocity(self) -> Array:
        """Of the left and the right grip (mm/s); shape (2, 2)."""
        half = 0.5 * self.pull.speed
        return np.array([[-half, 0.0], [half, 0.0]])
