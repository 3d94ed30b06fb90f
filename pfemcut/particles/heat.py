"""Heat conduction between particles and into the tool, explicit, once a batch of time steps.

The pair form of Brookshaw (1985, Proc. Astron. Soc. Aust. 6, 207) with the harmonic mean of the conductivities, which
keeps the flux continuous where materials meet (Cleary and Monaghan 1999, J. Comput. Phys. 148, 227), over the present
positions:

    C_i dT_i/dt = 2 V_i sum_j V_j k_ij (T_j - T_i) g_ij / a_ij,   k_ij = 2 k_i k_j / (k_i + k_j),   g = |dW/dr| / r.

Opposite on both particles of a pair, so heat is conserved to round-off; surfaces are adiabatic. The sums lack
neighbours near surfaces: without a_ij a body conducts there half as well as inside. It is the mean of both particles'
moments K_i = sum_j V_j g (x_j - x_i) ⊗ (x_j - x_i) along the pair, one inside.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from pfemcut.materials.enthalpy import specific_enthalpy
from pfemcut.particles.cells import NeighbourList
from pfemcut.particles.contact import tool_contact_view
from pfemcut.particles.integrate import heat_capacity
from pfemcut.particles.kernel import SUPPORT, normalisation, shape_slope
from pfemcut.particles.problem import Formulation, ParticleProblem
from pfemcut.particles.state import Memory, State

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Flow:
    """Power into particles (mW, or mW/mm) and the sum of the conductances that each sees; shape (n,) each."""

    power: Array
    conductance: Array


class Conduction:
    """Heat conduction in a problem.

    In total-Lagrangian SPH bodies conduct within themselves alone; in Eulerian SPH, whose bodies touch through the
    sums, from one to the other too.
    """

    def __init__(self, problem: ParticleProblem) -> None:
        self._problem = problem
        self._neighbours = NeighbourList(SUPPORT * problem.smoothing.smoothing_length)
        together = problem.formulation is Formulation.EULERIAN
        self._group = np.zeros_like(problem.body_number) if together else problem.body_number

    def conducted(self, state: State[Memory], duration: float) -> State[Memory]:
        """``state`` after heat has flowed for ``duration`` (s), in as many steps as stability asks for.

        A step is at most the capacity over the sum of conductances of any particle: then no temperature can leave the
        range of its neighbours' (Gershgorin's bound of the stability limit is twice that).
        """
        left = duration
        while left > 0.0:
            flow = self._flow(state)
            tool, ambient = self._into_tool(state)
            capacity = heat_capacity(self._problem, state.material.temperature)
            conductance = flow.conductance + tool
            limit = float(np.min(capacity / np.maximum(conductance, 1e-300)))
            steps = max(math.ceil(left / limit), 1)
            dt = left / steps
            taken = tool * (state.material.temperature - ambient)
            state = replace(
                state,
                material=state.material.heated(dt * (flow.power - taken) / capacity),
                ledger=state.ledger.plus(to_tool=dt * float(taken.sum())),
            )
            left = left - dt if steps > 1 else 0.0
        return state

    def _flow(self, state: State[Memory]) -> Flow:
        problem = self._problem
        self._neighbours.follow(state.positions)
        return pair_flow(
            self._neighbours,
            self._group,
            state.positions,
            problem.volume * state.volume_ratio,
            conductivity(problem, state.material.temperature),
            state.material.temperature,
            problem.smoothing.smoothing_length,
        )

    def _into_tool(self, state: State[Memory]) -> tuple[Array, float]:
        """Conductance between each particle and the tool (mW/K, or mW/(mm K)); shape (n,). The tool's temperature."""
        problem = self._problem
        conductance = np.zeros(len(state.positions))
        ambient = 0.0
        for tool in problem.tool:
            ambient = tool.temperature
            view = tool_contact_view(problem, state.positions, state.clock.time)
            conductance[view.particles] = problem.smoothing.spacing * problem.contact.conductance(
                view.pressure
            )
        return conductance, ambient


def conductivity(problem: ParticleProblem, temperature: Array) -> Array:
    """Of each particle (N/(s K)) at the ``temperature`` (K; (n,)); shape (n,)."""
    found = np.empty_like(temperature)
    for body, particles in zip(problem.bodies, problem.ranges, strict=True):
        found[particles] = body.material.conductivity(temperature[particles])
    return found


def heat_content(problem: ParticleProblem, temperature: Array) -> float:
    """Heat above the initial temperature (mJ, or mJ per mm of width), with true mass."""
    heat = 0.0
    for body, particles in zip(problem.bodies, problem.ranges, strict=True):
        enthalpy = specific_enthalpy(body.material.capacity, temperature[particles], body.temperature)
        heat += body.material.density * body.volume * float(enthalpy.sum())
    return heat


def pair_flow(
    neighbours: NeighbourList,
    group: IntArray,
    positions: Array,
    volume: Array,
    conductivity: Array,
    temperature: Array,
    smoothing_length: float,
) -> Flow:
    """Heat that flows between particles.

    Parameters
    ----------
    neighbours
        Of the particles at ``positions`` (n, d).
    group
        Particles of different groups don't conduct; shape (n,).
    volume, conductivity, temperature
        mm^d, N/(s K) and K; shape (n,).
    smoothing_length
        h (mm).
    """
    scale = normalisation(smoothing_length, positions.shape[1]) / smoothing_length
    rows = (neighbours.offsets, neighbours.indices, group, positions, volume)
    power, conductance = _pair_flow(
        *rows,
        _moments(*rows, smoothing_length, scale),
        conductivity,
        temperature,
        smoothing_length,
        scale,
    )
    return Flow(power, conductance)


@njit(parallel=True, cache=True)
def _moments(offsets, indices, group, positions, volume, smoothing, scale):  # type: ignore[no-untyped-def]
    """K_i = sum_j V_j g (x_j - x_i) ⊗ (x_j - x_i); shape (n, d, d)."""
    count, dimension = positions.shape
    moments = np.zeros((count, dimension, dimension))
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square = 0.0
            for a in range(dimension):
                square += (positions[j, a] - positions[i, a]) ** 2
            if square < reach and group[i] == group[j]:
                distance = np.sqrt(square)
                weight = -scale * volume[j] * shape_slope(distance / smoothing) / distance
                for a in range(dimension):
                    for b in range(dimension):
                        apart = positions[j, a] - positions[i, a]
                        moments[i, a, b] += weight * apart * (positions[j, b] - positions[i, b])
    return moments


@njit(parallel=True, cache=True)
def _pair_flow(  # type: ignore[no-untyped-def]
    offsets,
    indices,
    group,
    positions,
    volume,
    moments,
    conductivity,
    temperature,
    smoothing,
    scale,
):
    count, dimension = positions.shape
    power, conductance = np.zeros(count), np.zeros(count)
    reach = (2.0 * smoothing) ** 2
    for i in prange(count):
        for k in range(offsets[i], offsets[i + 1]):
            j = indices[k]
            square, moment = 0.0, 0.0
            for a in range(dimension):
                for b in range(dimension):
                    apart = (positions[j, a] - positions[i, a]) * (positions[j, b] - positions[i, b])
                    moment += 0.5 * (moments[i, a, b] + moments[j, a, b]) * apart
                square += (positions[j, a] - positions[i, a]) ** 2
            if square < reach and group[i] == group[j]:
                distance = np.sqrt(square)
                slope = shape_slope(distance / smoothing)
                if slope < 0.0:
                    mean = 2.0 * conductivity[i] * conductivity[j] / (conductivity[i] + conductivity[j])
                    # Both moments hold this very pair, so the quotient is bounded.
                    pair = -2.0 * scale * volume[i] * volume[j] * mean * slope * distance / moment
                    power[i] += pair * (temperature[j] - temperature[i])
                    conductance[i] += pair
    return power, conductance
