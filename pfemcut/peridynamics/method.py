"""The lattice model as a method: the verbs that the driver calls (see :mod:`pfemcut.method`).

The driver's step is a batch of time steps.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import ContactView, Frame, Measures
from pfemcut.particles.state import Arrays
from pfemcut.peridynamics.cracks import Crack, cracks, damage, parts
from pfemcut.peridynamics.integrate import (
    advance,
    broken,
    elastic_energy,
    elongation,
    gauge_strain,
    initial_state,
    kinetic_energy,
    momentum_error,
    stress,
)
from pfemcut.peridynamics.problem import LaminaProblem
from pfemcut.peridynamics.state import State, from_arrays, to_arrays

Array = NDArray[np.float64]

SHOWN_CRACKS = 2
"""Cracks in the history, the first that began."""

SMALLEST_CRACK = 10
"""Bonds that a crack in the history has at least."""


class LatticeMethod:
    """A run of the lattice model: its problem, its state and the wall time of its last batch."""

    def __init__(self, problem: LaminaProblem, state: State) -> None:
        self._problem = problem
        self._state = state
        self._seconds = 0.0

    @classmethod
    def start(cls, problem: LaminaProblem) -> LatticeMethod:
        """A run at time zero."""
        return cls(problem, initial_state(problem))

    @classmethod
    def restore(cls, problem: LaminaProblem, arrays: Arrays) -> LatticeMethod:
        """The run whose :meth:`state` gave ``arrays``."""
        return cls(problem, from_arrays(arrays))

    @property
    def current(self) -> State:
        """The state after the last batch."""
        return self._state

    @property
    def finished(self) -> bool:
        """Whether the final time is reached."""
        return self._state.clock.time >= self._problem.time.end * (1.0 - 1e-12)

    def advance(self) -> None:
        """Advance one batch of time steps.

        Raises
        ------
        RunStopped
            If the run can't go on.
        """
        begun = time.perf_counter()
        self._state = advance(self._problem, self._state)
        self._seconds = time.perf_counter() - begun

    def measure(self) -> Measures:
        """Core history columns after the last batch; ``travel`` is the elongation, ``tool_work`` that of the grips."""
        state, problem = self._state, self._problem
        elastic = elastic_energy(problem, state)
        kinetic = kinetic_energy(problem, state.velocity)
        lost = float(state.energy.sum())
        supply = kinetic_energy(problem, problem.start_velocity) + state.totals.grip_work
        return Measures(
            step=state.clock.batches,
            time=state.clock.time,
            dt=state.clock.dt,
            travel=elongation(problem, state),
            cutting_force=math.nan,
            thrust_force=math.nan,
            contact_length=math.nan,
            max_temperature=math.nan,
            max_eqps=math.nan,
            tool_work=state.totals.grip_work,
            plastic_work=0.0,
            friction_work=0.0,
            elastic_energy=elastic,
            kinetic_energy=kinetic,
            energy_error=(supply - elastic - kinetic - lost) / supply,
            nodes=len(problem.sites),
        )

    def own_measures(self) -> Mapping[str, float]:
        """History columns of the lattice: load, strain, damage, cracks, energies."""
        state, problem, bonds = self._state, self._problem, self._problem.bonds
        totals, gone = state.totals, broken(problem, state)
        square = totals.elastic_square
        return {
            "time_steps": state.clock.steps,
            "load": totals.load,
            "stress": stress(problem, totals.load),
            "gauge_strain": gauge_strain(problem, state),
            "young_modulus": totals.elastic_work / square if square else math.nan,
            "peak_load": totals.peak_load,
            "peak_elongation": totals.peak_elongation,
            "broken_matrix_bonds": int((gone & bonds.once & ~bonds.fibre).sum()),
            "broken_fibre_bonds": int((gone & bonds.once & bonds.fibre).sum()),
            "parts": parts(bonds, np.isfinite(state.broken_at), problem.inner),
            "fracture_energy": float(state.energy[:, 0].sum()),
            "damping_energy": float(state.energy[:, 1].sum()),
            "momentum_error": momentum_error(problem, state),
            **self._crack_columns(),
        }

    def _crack_columns(self) -> dict[str, float]:
        """Start, angle and length of the first cracks; nan where there are fewer."""
        found = cracks(self._problem.bonds, self._problem.sites, self._state.broken_at, self._problem.spacing)
        seen = [crack for crack in found if crack.bonds >= SMALLEST_CRACK][:SHOWN_CRACKS]
        none = Crack((math.nan, math.nan), math.nan, math.nan, math.nan, 0)
        columns = {}
        for number, crack in enumerate([*seen, *[none] * (SHOWN_CRACKS - len(seen))], 1):
            columns[f"crack_{number}_start_x"] = crack.start[0]
            columns[f"crack_{number}_start_y"] = crack.start[1]
            columns[f"crack_{number}_angle"] = crack.angle
            columns[f"crack_{number}_length"] = crack.length
        return columns

    def timing(self) -> Mapping[str, float]:
        """Wall seconds of the last batch."""
        return {"lattice": self._seconds}

    def frame(self) -> Frame:
        """Sites at their present places, with damage, after the last batch."""
        state, problem = self._state, self._problem
        found = damage(problem.bonds, np.isfinite(state.broken_at))
        none = np.zeros(0)
        return Frame(
            step=state.clock.batches,
            time=state.clock.time,
            travel=elongation(problem, state),
            points=problem.sites + state.displacement,
            cells=np.empty((0, 3), dtype=np.int64),
            loops=(),
            point_fields={
                "displacement": state.displacement,
                "velocity": state.velocity,
                "damage": found.total,
                "fibre_damage": found.fibre,
                "matrix_damage": found.matrix,
                "particle_id": np.arange(len(problem.sites)),
            },
            cell_fields={},
            tool=(),
            contact=ContactView(np.zeros(0, dtype=np.int64), none, none, none),
        )

    def state(self) -> Arrays:
        """All arrays that :meth:`restore` needs."""
        return to_arrays(self._state)
