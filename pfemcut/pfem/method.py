"""The PFEM as a method: the verbs that the driver calls (see :mod:`pfemcut.method`)."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from meshing.bodies import joined, renumbered, separated
from meshing.initial import outline_mesh
from meshing.mesh import Mesh
from meshing.sizes import SizeField
from pfemcut.method import Frame, Measures
from pfemcut.pfem import energies
from pfemcut.pfem.contact_view import contact_view
from pfemcut.pfem.frames import frame_of
from pfemcut.pfem.stages import entered, matching_reactions
from pfemcut.pfem.state import (
    Clock,
    Fields,
    Ledger,
    State,
    from_arrays,
    initial_fields,
    joined_fields,
    to_arrays,
)
from pfemcut.pfem.step import PHASES, Kernels, advance
from pfemcut.pfem.step_record import StepRecord
from pfemcut.problem import Body, Probe, Problem
from pfemcut.ranks import Ranks
from pfemcut.timing import Stopwatch
from pfemcut.tools.heat_block import HeatBlock, block_mesh

Array = NDArray[np.float64]

_NO_STEP = StepRecord(np.zeros(2), 0.0, 0.0, 0, 0, 0, 0, 0, 0.0, 0.0, np.zeros((0, 3)))


class PfemMethod:
    """A PFEM run: its problem, its state and the record of its last step."""

    def __init__(self, problem: Problem, state: State, heat_blocks: tuple[HeatBlock, ...] = ()):
        self._problem = problem
        self._kernels = Kernels(MPI.COMM_WORLD, heat_blocks)
        self._state = state
        self._record = _NO_STEP
        self._watch = Stopwatch(PHASES)

    @classmethod
    def start(cls, problem: Problem) -> PfemMethod:
        """A run at time zero, with a new mesh."""
        # Every rank must hold the same bits, so one meshes for all.
        mesh = Ranks().on_first(lambda: _initial_mesh(problem))
        first = problem.time.first_step_fraction * problem.time.step
        clock = Clock(step=0, time=0.0, last_dt=first, next_dt=first)
        blocks = _heat_blocks(problem)
        fields = joined_fields(
            [
                _initial_fields(problem, body, part, first)
                for body, part in zip(
                    problem.bodies,
                    separated(mesh, [alone.first_part for alone in problem.alone]),
                    strict=True,
                )
            ]
        )
        return cls(
            problem,
            State(
                mesh=mesh,
                fields=fields,
                clock=clock,
                ledger=Ledger(),
                initial_mass=energies.mass(problem, mesh, fields),
                initial_kinetic_energy=energies.kinetic_energy(problem, mesh, fields, first),
                last_tool_force=np.zeros(2),
                last_reactions=np.zeros((len(problem.motions), 3)),
                probes=_nearest_particles(mesh, problem.probes),
                tool_temperature=np.concatenate(
                    [np.zeros(0)]
                    + [
                        np.full(len(block.mesh.points), tool.temperature)
                        for tool, block in zip(problem.tool, blocks, strict=False)
                    ]
                ),
            ),
            blocks,
        )

    @classmethod
    def restore(cls, problem: Problem, arrays: Mapping[str, NDArray[np.generic]]) -> PfemMethod:
        """The run whose :meth:`state` gave ``arrays``."""
        return cls(problem, from_arrays(arrays), _heat_blocks(problem))

    @property
    def finished(self) -> bool:
        """Whether the final time is reached."""
        return self._state.clock.time >= self._problem.end * (1.0 - 1e-12)

    @property
    def current(self) -> State:
        """Mesh, fields, clock and ledger after the last step."""
        return self._state

    @property
    def record(self) -> StepRecord:
        """Record of the last step."""
        return self._record

    def advance(self) -> None:
        """Advance one step (see :func:`pfemcut.pfem.step.advance` for its errors)."""
        self._watch = Stopwatch(PHASES)
        stage = self._problem.beginning(self._state.clock.time)
        state = self._state if stage is self._stage else entered(self._stage, stage, self._state)
        self._state, self._record = advance(stage, self._kernels, state, self._watch)

    def measure(self) -> Measures:
        """Core history columns after the last step."""
        problem, state = self._problem, self._state
        mesh, fields, clock, ledger = state.mesh, state.fields, state.clock, state.ledger
        elastic = energies.elastic_energy(problem, mesh, fields)
        kinetic = energies.kinetic_energy(problem, mesh, fields, clock.last_dt)
        contact = contact_view(self._stage, state)
        return Measures(
            step=clock.step,
            time=clock.time,
            dt=clock.last_dt,
            travel=self._travel,
            cutting_force=float(self._record.tool_force[0]),
            thrust_force=float(self._record.tool_force[1]),
            contact_length=float(contact.arc_length.max(initial=0.0)),
            max_temperature=float(fields.temperature[mesh.particle_ranges[0]].max()),
            max_eqps=float(fields.eqps[mesh.cell_ranges[0]].max()),
            tool_work=ledger.tool_work,
            plastic_work=ledger.plastic,
            friction_work=ledger.friction,
            elastic_energy=elastic,
            kinetic_energy=kinetic,
            energy_error=self._energy_error(elastic, kinetic),
            nodes=len(mesh.points),
        )

    def own_measures(self) -> Mapping[str, float]:
        """History columns of the PFEM: ledgers, drifts and counts."""
        problem, state, record = self._problem, self._state, self._record
        ledger = state.ledger
        content = energies.heat_content(problem, state.mesh, state.fields)
        # What came, and what is there or has left: also a body that has cooled down has received its heat.
        through = (ledger.heat_supplied, -ledger.heat_to_tool)
        supplied = ledger.heat_generated + sum(max(heat, 0.0) for heat in through)
        left = content + ledger.cut_off_heat + sum(max(-heat, 0.0) for heat in through)
        cut_area = sum(cut.depth for cut in problem.cut) * self._travel
        return {
            "elements": len(state.mesh.cells),
            "inserted": record.inserted,
            "removed": record.removed,
            "changed_elements": record.changed,
            "outside_gauss_points": record.outside,
            "newton_iterations": record.newton_iterations,
            "step_cuts": ledger.step_cuts,
            "extrapolated_steps": ledger.extrapolated_steps,
            "plastic_power": record.plastic_power,
            "flow_change": record.flow_change,
            "thermoelastic_work": ledger.thermoelastic,
            "contact_energy": ledger.contact,
            "remeshing_energy": ledger.remeshing,
            "self_contact_length": record.self_contact_length,
            "self_contact_force": record.self_contact_force,
            "boundary_work": ledger.boundary_work,
            "stabilisation_work": ledger.stabilisation,
            "heat_content": content,
            "heat_generated": ledger.heat_generated,
            "heat_supplied": ledger.heat_supplied,
            "heat_remeshing": ledger.heat_remeshing,
            "heat_to_tool": ledger.heat_to_tool,
            "heat_error": (supplied - left) / supplied if supplied else 0.0,
            "area_drift": ledger.area_drift / cut_area if cut_area else 0.0,
            "mass_drift": (energies.mass(problem, state.mesh, state.fields) + ledger.cut_off_mass)
            / state.initial_mass
            - 1.0,
            **self._cut_off(),
            **self._tool_heat(),
            **energies.tool_heat_content(problem, state.mesh, state.fields),
            **self._reactions(),
            **self._probed(),
        }

    def timing(self) -> Mapping[str, float]:
        """Wall seconds of the last step by phase; ``momentum`` is what its own phases leave."""
        seconds = dict(self._watch.seconds)
        seconds["momentum"] -= seconds["system"] + seconds["assembly"] + seconds["linear_solve"]
        return seconds

    def frame(self) -> Frame:
        """Fields after the last step."""
        return frame_of(self._stage, self._state, self._kernels.heat_blocks, self._travel)

    def state(self) -> Mapping[str, NDArray[np.generic]]:
        """All arrays that :meth:`restore` needs."""
        return to_arrays(self._state)

    @property
    def _stage(self) -> Problem:
        """The stage of the last step."""
        return self._problem.ending(self._state.clock.time)

    @property
    def _travel(self) -> float:
        speed = max((float(np.hypot(*tool.velocity)) for tool in self._problem.tool), default=0.0)
        # A tool that has withdrawn has not travelled farther.
        return speed * min(self._state.clock.time, self._problem.time.end)

    def _energy_error(self, elastic: float, kinetic: float) -> float:
        """(W - sinks) / W, with the work of the tool and of prescribed motions."""
        ledger = self._state.ledger
        work = ledger.tool_work + ledger.boundary_work
        sinks = ledger.plastic + ledger.friction + elastic + ledger.thermoelastic
        sinks += ledger.contact + ledger.remeshing + ledger.cut_off_energy
        if self._problem.time.inertia:
            sinks += kinetic - self._state.initial_kinetic_energy
        return (work - sinks) / work if work else 0.0

    def _tool_heat(self) -> dict[str, float]:
        """Temperature and heat of a tool that conducts, with the error of its ledger; empty without one."""
        problem, state = self._problem, self._state
        columns = {}
        for tool, block in zip(problem.tool, self._kernels.heat_blocks, strict=False):
            temperature = state.tool_temperature
            content = block.content(temperature, tool.temperature)
            received = state.ledger.heat_to_tool
            received += (1.0 - problem.contact.heat_partition) * state.ledger.friction
            held = content + state.ledger.heat_to_holder
            columns = {
                "tool_max_temperature": float(temperature.max()),
                "tool_hottest_along_rake": float(block.arc_length[np.argmax(temperature[block.surface])]),
                "tool_heat_content": content,
                "tool_heat_lost": state.ledger.heat_to_holder,
                "tool_heat_error": (received - held) / received if received else 0.0,
            }
        return columns

    def _cut_off(self) -> dict[str, float]:
        """What went with the pieces of the chip that were cut off; empty if its length has no limit."""
        ledger = self._state.ledger
        if not any(math.isfinite(cut.chip_length) for cut in self._problem.cut):
            return {}
        return {
            "cut_off_mass": ledger.cut_off_mass,
            "cut_off_energy": ledger.cut_off_energy,
            "cut_off_heat": ledger.cut_off_heat,
        }

    def _reactions(self) -> dict[str, float]:
        """Forces of the supports on the body (N/mm), and moments (N) where a motion has a gradient."""
        columns = {}
        reactions = matching_reactions(self._stage, self._problem, self._state.last_reactions)
        for motion, (force, *moments) in zip(self._problem.motions, reactions, strict=True):
            component = f"{motion.part}_{motion.axis.name.lower()}"
            columns[f"reaction_{component}"] = float(force)
            if motion.gradient:
                columns.update(
                    {f"moment_{component}{j}": float(m) for j, m in zip("xy", moments, strict=True)}
                )
        return columns

    def _probed(self) -> dict[str, float]:
        """Displacement (mm) and temperature (K) of the probes' particles."""
        mesh, fields = self._state.mesh, self._state.fields
        columns = {}
        for probe, identity in zip(self._problem.probes, self._state.probes, strict=True):
            at = int(np.flatnonzero(mesh.ids == identity)[0])
            columns[f"{probe.name}_ux"], columns[f"{probe.name}_uy"] = map(float, fields.displacement[at])
            columns[f"{probe.name}_temperature"] = float(fields.temperature[at])
        return columns


def _heat_blocks(problem: Problem) -> tuple[HeatBlock, ...]:
    """Blocks of the tools that conduct heat, in the order of the tools."""
    conducting = [(tool.shape, conductor) for tool in problem.tool for conductor in tool.conductor]
    # Every rank must hold the same bits, so one meshes for all.
    meshes = Ranks().on_first(lambda: [block_mesh(*each) for each in conducting])
    return tuple(HeatBlock(*each, mesh) for each, mesh in zip(conducting, meshes, strict=True))


def _initial_mesh(problem: Problem) -> Mesh:
    """All bodies' meshes, with the part numbers of the problem."""
    meshes: list[Mesh] = []
    for body in problem.bodies:
        first_id = meshes[-1].next_id if meshes else 0
        meshes.append(renumbered(_body_mesh(body, problem.particles.sizes), first_id))
    return joined(meshes, [alone.first_part for alone in problem.alone])


def _body_mesh(body: Body, sizes: SizeField) -> Mesh:
    for mesh in body.given:
        return mesh
    return outline_mesh(
        np.asarray(body.outline, dtype=np.float64),
        (*body.sizes, sizes)[0],
        np.arange(len(body.parts)),
        body.arcs,
    )


def _initial_fields(problem: Problem, body: Body, mesh: Mesh, first_step: float) -> Fields:
    strain = float(body.material.thermal_strain(np.asarray(body.temperature)))
    vx, vy = body.velocity
    speed = sum(
        float(np.hypot(vx - tool.velocity[0], vy - tool.velocity[1])) for tool in problem.rigid_tools[:1]
    )
    return initial_fields(mesh, body.temperature, strain, (vx * first_step, vy * first_step), speed)


def _nearest_particles(mesh: Mesh, probes: tuple[Probe, ...]) -> NDArray[np.int64]:
    """Identities of the particles nearest to the points of ``probes``, each in its body."""
    nearest = []
    for probe in probes:
        within = mesh.particle_ranges[probe.body]
        away = np.hypot(*(mesh.points[within] - np.asarray(probe.point)).T)
        nearest.append(within.start + int(np.argmin(away)))
    return mesh.ids[np.asarray(nearest, dtype=np.int64)]
