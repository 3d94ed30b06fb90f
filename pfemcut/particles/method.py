"""Explicit particles as a method: the verbs that the driver calls (see :mod:`pfemcut.method`).

The driver's step is a batch of time steps: its costs (rows of tables, looks at signals) would outweigh a time step.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame, Measures
from pfemcut.particles.contact import tool_contact_view
from pfemcut.particles.formulation import ForceModel
from pfemcut.particles.frames import frame_of
from pfemcut.particles.heat import Conduction, heat_content
from pfemcut.particles.integrate import (
    advance,
    energy_at_start,
    initial_state,
    kinetic_energy,
    momentum,
)
from pfemcut.particles.problem import ParticleProblem
from pfemcut.particles.state import Arrays, Memory, State, from_arrays, to_arrays
from pfemcut.particles.stress import elastic_energy
from pfemcut.results.derived.contact_length import contact_length

Array = NDArray[np.float64]


class ParticleMethod(Generic[Memory]):
    """A run with explicit particles: its formulation, its state and the wall time of its last batch."""

    def __init__(self, model: ForceModel[Memory], state: State[Memory]) -> None:
        self._model = model
        self._state = state
        self._tool_force = np.zeros(model.problem.dimension)
        self._seconds = 0.0
        self._conduction = tuple(Conduction(each) for each in (model.problem,) if each.conduction)

    @classmethod
    def start(cls, model: ForceModel[Memory]) -> ParticleMethod[Memory]:
        """A run at time zero."""
        return cls(model, initial_state(model))

    @classmethod
    def restore(cls, model: ForceModel[Memory], arrays: Arrays) -> ParticleMethod[Memory]:
        """The run whose :meth:`state` gave ``arrays``."""
        return cls(model, from_arrays(arrays, model.restored(arrays)))

    @property
    def current(self) -> State[Memory]:
        """The state after the last batch."""
        return self._state

    @property
    def finished(self) -> bool:
        """Whether the final time is reached."""
        return self._state.clock.time >= self._problem.time.end * (1.0 - 1e-12)

    def advance(self) -> None:
        """Advance one batch of time steps, let heat flow, then renew the reference if it's time.

        Raises
        ------
        RunStopped
            If the run can't go on.
        """
        begun, since = time.perf_counter(), self._state.clock.time
        state = replace(self._state, tool_impulse=np.zeros(self._problem.dimension))
        end = self._problem.time.end * (1.0 - 1e-12)
        for _ in range(self._problem.time.batch):
            if state.clock.time < end:
                state = advance(self._model, state)
        for conduction in self._conduction:
            state = conduction.conducted(state, state.clock.time - since)
        memory, new = self._model.renewed(state.memory, state.positions, state.volume_ratio)
        clock = replace(state.clock, batches=state.clock.batches + 1, updates=state.clock.updates + int(new))
        self._state = replace(state, memory=memory, clock=clock)
        self._tool_force = state.tool_impulse / (clock.time - since)
        self._seconds = time.perf_counter() - begun

    def measure(self) -> Measures:
        """Core history columns after the last batch; forces on the tool are means over it."""
        state, problem = self._state, self._problem
        elastic = self._elastic_energy()
        kinetic = kinetic_energy(problem, state.velocities)
        view = tool_contact_view(problem, state.positions, state.clock.time)
        first = problem.ranges[0]
        return Measures(
            step=state.clock.batches,
            time=state.clock.time,
            dt=state.clock.dt,
            travel=self._travel,
            cutting_force=float(self._tool_force[0]),
            thrust_force=float(self._tool_force[1]),
            contact_length=contact_length(view, 0.5 * problem.smoothing.spacing),
            max_temperature=float(state.material.temperature[first].max()),
            max_eqps=float(state.material.eqps[first].max()),
            tool_work=state.ledger.tool,
            plastic_work=state.ledger.plastic,
            friction_work=state.ledger.friction,
            elastic_energy=elastic,
            kinetic_energy=kinetic,
            energy_error=self._energy_error(elastic, kinetic),
            nodes=len(state.positions),
        )

    def own_measures(self) -> Mapping[str, float]:
        """History columns of explicit particles: steps, ledgers of energy and momentum, gauges."""
        state, problem = self._state, self._problem
        ledger = state.ledger
        start = kinetic_energy(problem, problem.velocities)
        # Zero to round-off by the scheme; the ledger of measures is the one that tests.
        change = kinetic_energy(problem, state.velocities) - start
        works = ledger.internal + ledger.viscous + ledger.control + ledger.between
        works += ledger.contact + ledger.hold
        return {
            "time_steps": state.clock.steps,
            "reference_updates": state.clock.updates,
            "internal_work": ledger.internal,
            "viscous_work": ledger.viscous,
            "zero_energy_work": ledger.control,
            "pinball_work": ledger.between,
            "contact_work": ledger.contact,
            "hold_work": ledger.hold,
            "contact_energy": state.contact_energy,
            "kinetic_error": change - works,
            "momentum_error": self._momentum_error(),
            "heat_content": heat_content(problem, state.material.temperature),
            "heat_to_tool": ledger.to_tool,
            **self._gauged(),
        }

    def timing(self) -> Mapping[str, float]:
        """Wall seconds of the last batch."""
        return {"particles": self._seconds}

    def frame(self) -> Frame:
        """Fields after the last batch."""
        return frame_of(self._model, self._state, self._travel)

    def state(self) -> Arrays:
        """All arrays that :meth:`restore` needs."""
        return {**to_arrays(self._state), **self._model.arrays(self._state.memory)}

    @property
    def _problem(self) -> ParticleProblem:
        return self._model.problem

    @property
    def _travel(self) -> float:
        speed = max((float(np.hypot(*tool.velocity)) for tool in self._problem.tool), default=0.0)
        return speed * self._state.clock.time

    def _elastic_energy(self) -> float:
        problem, state = self._problem, self._state
        density = elastic_energy(
            problem.bulk_modulus,
            problem.shear_modulus,
            state.material.deviator,
            state.volume_ratio,
        )
        return float(problem.volume @ density)

    def _energy_error(self, elastic: float, kinetic: float) -> float:
        """(supply - sinks) / supply: energy at the start and work, against what is stored and dissipated."""
        ledger = self._state.ledger
        supply = energy_at_start(self._problem) + ledger.tool + ledger.hold
        sinks = kinetic + elastic + ledger.plastic + ledger.friction + self._state.contact_energy
        sinks -= ledger.viscous + ledger.control + ledger.between
        return (supply - sinks) / supply if supply else 0.0

    def _momentum_error(self) -> float:
        """Momentum less that of the start and the impulse of holds and contacts, over mass times the largest speed."""
        problem, state = self._problem, self._state
        start = momentum(problem, problem.velocities)
        missing = momentum(problem, state.velocities) - start - state.impulse
        fastest = np.sqrt(np.max(np.einsum("na,na->n", state.velocities, state.velocities)))
        scale = float(problem.mass.sum() * fastest)
        return float(np.linalg.norm(missing)) / scale if scale else 0.0

    def _gauged(self) -> dict[str, float]:
        """Length along an axis and largest diameter across it, from surface to surface (one spacing is added)."""
        columns = {}
        for gauge in self._problem.gauges:
            points = self._state.positions[self._problem.ranges[gauge.body]]
            spacing = self._problem.smoothing.spacing
            across = np.delete(points, gauge.axis, axis=1)
            middle = np.delete(self._problem.bodies[gauge.body].points, gauge.axis, axis=1).mean(axis=0)
            radius = np.linalg.norm(across - middle, axis=1)
            columns = {
                "final_length": float(np.ptp(points[:, gauge.axis])) + spacing,
                "mushroom_diameter": 2.0 * float(radius.max()) + spacing,
            }
        return columns
