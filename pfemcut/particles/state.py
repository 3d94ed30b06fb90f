"""State of an explicit particle method: motion, material, clock and ledger, and its form in a checkpoint."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.stress import PointState

Array = NDArray[np.float64]
Arrays = Mapping[str, NDArray[np.generic]]

Memory = TypeVar("Memory")
"""What a formulation keeps from step to step, such as a reference configuration."""


@dataclass(frozen=True)
class Loads:
    """Forces on the particles (N, or N per mm of width); each of shape (n, d).

    Attributes
    ----------
    internal
        Of the stress.
    viscous
        Of artificial viscosity.
    control
        Of what suppresses zero-energy modes or clusters.
    between
        Of other bodies, where the formulation has contact between bodies.
    contact
        Of tool and walls.
    """

    internal: Array
    viscous: Array
    control: Array
    between: Array
    contact: Array

    @property
    def total(self) -> Array:
        """Their sum."""
        return self.internal + self.viscous + self.control + self.between + self.contact


@dataclass(frozen=True)
class Clock:
    """Batches, time steps and reference updates so far, time (s), last time step (s)."""

    batches: int
    steps: int
    updates: int
    time: float
    dt: float


@dataclass(frozen=True)
class Ledger:
    """Energies (mJ, or mJ per mm of width) since the start.

    Works are those of the forces on the particles, by the trapezoidal rule, with which the change of kinetic energy is
    their sum to round-off. ``plastic`` is found at the particles instead, from stress and plastic strain, and ``tool``
    is the tool's own work; so the balance of these with the stored energies is a test. ``to_tool`` is heat.
    """

    internal: float = 0.0
    viscous: float = 0.0
    control: float = 0.0
    between: float = 0.0
    contact: float = 0.0
    hold: float = 0.0
    tool: float = 0.0
    plastic: float = 0.0
    friction: float = 0.0
    to_tool: float = 0.0

    def plus(self, **amounts: float) -> Ledger:
        """The ledger with ``amounts`` added."""
        return dataclasses.replace(self, **{name: getattr(self, name) + x for name, x in amounts.items()})


@dataclass(frozen=True)
class State(Generic[Memory]):
    """Everything that a run goes on from.

    Attributes
    ----------
    positions, velocities
        mm and mm/s; shape (n, d).
    loads
        Forces at the end of the last step.
    material
        Stress deviator, plastic strain, temperature.
    volume_ratio
        J = rho_0 / rho; shape (n,).
    memory
        What the formulation keeps.
    clock, ledger
        Time and energies.
    impulse
        Of holds, walls and tool on the bodies since the start (N s, or N s per mm); shape (d,).
    tool_force
        On the tool at the end of the last step (N, or N per mm of width); shape (d,).
    tool_impulse
        On the tool since the last batch began; shape (d,).
    contact_energy
        In the penalty springs now.
    """

    positions: Array
    velocities: Array
    loads: Loads
    material: PointState
    volume_ratio: Array
    memory: Memory
    clock: Clock
    ledger: Ledger
    impulse: Array
    tool_force: Array
    tool_impulse: Array
    contact_energy: float


_GROUPS = ("loads", "material", "clock", "ledger")
_PLAIN = (
    "positions",
    "velocities",
    "volume_ratio",
    "impulse",
    "tool_force",
    "tool_impulse",
    "contact_energy",
)


def to_arrays(state: State[Any]) -> dict[str, NDArray[np.generic]]:
    """Flat named arrays of ``state`` without its memory."""
    arrays: dict[str, NDArray[np.generic]] = {name: np.asarray(getattr(state, name)) for name in _PLAIN}
    for group in _GROUPS:
        arrays |= flattened(group, getattr(state, group))
    return arrays


def flattened(name: str, data: Any) -> dict[str, NDArray[np.generic]]:
    """The fields of a dataclass as arrays, named after it."""
    return {f"{name}/{each.name}": np.asarray(getattr(data, each.name)) for each in dataclasses.fields(data)}


def unflattened(kind: type[Any], name: str, arrays: Arrays, *, scalar: bool) -> Any:
    """The dataclass of a ``kind`` that :func:`flattened` gave, of scalars or of arrays."""
    values = {each.name: arrays[f"{name}/{each.name}"] for each in dataclasses.fields(kind)}
    return kind(**{key: value.item() if scalar else value for key, value in values.items()})


def from_arrays(arrays: Arrays, memory: Memory) -> State[Memory]:
    """The state that :func:`to_arrays` flattened, with its ``memory``."""

    def array(name: str) -> Array:
        return np.asarray(arrays[name], dtype=np.float64)

    return State(
        array("positions"),
        array("velocities"),
        unflattened(Loads, "loads", arrays, scalar=False),
        unflattened(PointState, "material", arrays, scalar=False),
        array("volume_ratio"),
        memory,
        unflattened(Clock, "clock", arrays, scalar=True),
        unflattened(Ledger, "ledger", arrays, scalar=True),
        array("impulse"),
        array("tool_force"),
        array("tool_impulse"),
        float(arrays["contact_energy"]),
    )
