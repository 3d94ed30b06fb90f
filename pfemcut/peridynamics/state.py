"""State of a lattice on its way, and its form in a checkpoint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.state import Arrays, Clock, flattened, unflattened

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Totals:
    """What has been since the start.

    Attributes
    ----------
    grip_work
        Work of the grips (mJ).
    load
        Of the last batch, the mean of the pull at both grips (N).
    peak_load, peak_elongation
        Largest load of a batch (N) and the elongation at its end (mm).
    elastic_work, elastic_square
        Sums of stress times strain and strain squared over the batches before the first bond broke (MPa and -).
    """

    grip_work: float = 0.0
    load: float = 0.0
    peak_load: float = 0.0
    peak_elongation: float = 0.0
    elastic_work: float = 0.0
    elastic_square: float = 0.0


@dataclass(frozen=True)
class State:
    """Everything that a run goes on from.

    Attributes
    ----------
    displacement, velocity, force
        mm, mm/s and N; shape (n, 2).
    broken_at
        Time at which entries of bonds broke (s), infinite if they did not; shape (k,).
    energy
        What each site's bonds took with them when they broke, and what its dashpots took (mJ); shape (n, 2).
    clock, totals
        Time and sums.
    impulse
        Of the grips on the plate (N s); shape (2,).
    """

    displacement: Array
    velocity: Array
    force: Array
    broken_at: Array
    energy: Array
    clock: Clock
    totals: Totals
    impulse: Array


_PLAIN = ("displacement", "velocity", "force", "broken_at", "energy", "impulse")


def to_arrays(state: State) -> dict[str, NDArray[np.generic]]:
    """Flat named arrays of ``state``."""
    arrays: dict[str, NDArray[np.generic]] = {name: np.asarray(getattr(state, name)) for name in _PLAIN}
    return {**arrays, **flattened("clock", state.clock), **flattened("totals", state.totals)}


def from_arrays(arrays: Arrays) -> State:
    """The state that :func:`to_arrays` flattened."""
    plain = {name: np.array(arrays[name], dtype=np.float64) for name in _PLAIN}
    return State(
        **plain,
        clock=unflattened(Clock, "clock", arrays, scalar=True),
        totals=unflattened(Totals, "totals", arrays, scalar=True),
    )
