"""What outputs show of a state of the PFEM: the frame of one instant."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pfemcut.materials.return_mapping import tensor_norm
from pfemcut.method import Block, Frame
from pfemcut.pfem.bodies import moduli
from pfemcut.pfem.contact_view import contact_view
from pfemcut.pfem.kinematics import element_mean
from pfemcut.pfem.state import State
from pfemcut.problem import Problem
from pfemcut.tools.heat_block import HeatBlock

Array = NDArray[np.float64]

_ROOT_2_3 = np.sqrt(2.0 / 3.0)
_ROOT_3_2 = np.sqrt(1.5)


def frame_of(problem: Problem, state: State, heat_blocks: tuple[HeatBlock, ...], travel: float) -> Frame:
    """The frame of ``state``: its first body, tools, and other bodies apart; ``travel`` of the tool (mm)."""
    mesh = state.mesh
    point_fields, cell_fields = _point_fields(state), _cell_fields(problem, state)
    particles, cells = mesh.particle_ranges[0], mesh.cell_ranges[0]
    blocks = tuple(_bodies(problem, state, point_fields, cell_fields))
    tools = {tool.body for tool in problem.tool}
    conducting = tuple(
        Block(
            block.mesh.points + tool.displacement(state.clock.time),
            block.mesh.cells,
            {"temperature": state.tool_temperature},
        )
        for tool, block in zip(problem.tool, heat_blocks, strict=False)
    )
    return Frame(
        step=state.clock.step,
        time=state.clock.time,
        travel=travel,
        points=mesh.points[particles],
        cells=mesh.cells[cells],
        loops=tuple(loop for loop in mesh.boundary.loops if loop[0] < particles.stop),
        point_fields={name: values[particles] for name, values in point_fields.items()},
        cell_fields={name: values[cells] for name, values in cell_fields.items()},
        tool=tuple(tool.at(state.clock.time) for tool in problem.tool),
        tool_blocks=conducting + tuple(block for block in blocks if block.name in tools),
        contact=contact_view(problem, state),
        others=tuple(block for block in blocks if block.name not in tools),
    )


def _point_fields(state: State) -> dict[str, NDArray[np.generic]]:
    fields = state.fields
    return {
        "displacement": fields.displacement,
        "velocity": fields.last_displacement / state.clock.last_dt,
        "pressure": fields.pressure,
        "temperature": fields.temperature,
        "particle_id": state.mesh.ids,
    }


def _cell_fields(problem: Problem, state: State) -> dict[str, Array]:
    mesh, fields = state.mesh, state.fields
    deviator = fields.b_elastic.copy()
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    deviator *= (moduli(problem, mesh)[:, 0] / fields.volume_ratio)[:, None]
    stress = deviator.copy()
    stress[:, :3] += element_mean(fields.pressure, mesh.cells)[:, None]
    return {
        "equivalent_plastic_strain": fields.eqps,
        "equivalent_plastic_strain_rate": _ROOT_2_3 * fields.multiplier_rate,
        "von_mises": _ROOT_3_2 * tensor_norm(deviator),
        "cauchy_stress": stress,
        "plastic_power": fields.plastic_power,
    }


def _bodies(
    problem: Problem,
    state: State,
    point_fields: dict[str, NDArray[np.generic]],
    cell_fields: dict[str, Array],
) -> Iterator[Block]:
    """The bodies but the first; a tool's displacement is that from where it would be without load."""
    mesh = state.mesh
    motion = {tool.body: tool.displacement(state.clock.time) for tool in problem.tool}
    every = zip(problem.bodies, mesh.particle_ranges, mesh.cell_ranges, strict=True)
    for body, particles, cells in list(every)[1:]:
        on_points = {name: values[particles] for name, values in point_fields.items()}
        on_points["displacement"] = state.fields.displacement[particles] - motion.get(body.name, np.zeros(2))
        yield Block(
            mesh.points[particles],
            mesh.cells[cells] - particles.start,
            on_points,
            {name: values[cells] for name, values in cell_fields.items()},
            body.name,
        )
