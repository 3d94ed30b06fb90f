"""The end of a long chip is cut off (``[cutting] chip_length``), so that the particles of a long cut get no more.

It is severed along element edges across the chip: what stays keeps every bit, and mass, energy (stored, with inertia
also kinetic) and heat of what goes are booked in the ledger. The new end is a free surface from then on; the stress
that it carried is released in the next step.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshing.bodies import joined, separated
from meshing.mesh import Mesh
from meshing.severing import Crossing, Severed, crossing, loop_after, sever
from pfemcut.pfem import energies
from pfemcut.pfem.state import Fields, State, Where, declarations, joined_fields, separated_fields
from pfemcut.problem import Cut, MovingTool, Problem

Array = NDArray[np.float64]

PIECE = 0.25
"""A piece is cut off when the chip is longer than its length by this part of it."""
THICKEST = 4.0
"""Widest path across the chip, in depths of cut."""


def cut_off_chip(problem: Problem, state: State) -> State:
    """``state`` without what of the chip is beyond its length, once that is a quarter of the length."""
    for cut, tool in zip(problem.cut, problem.tool, strict=False):
        if math.isfinite(cut.chip_length):
            return _cut_off(problem, state, cut, tool)
    return state


def _cut_off(problem: Problem, state: State, cut: Cut, tool: MovingTool) -> State:
    first_parts = [alone.first_part for alone in problem.alone]
    workpiece, *others = separated(state.mesh, first_parts)
    for path in chip_end(problem, workpiece, cut, tool, state.clock.time):
        severed = sever(workpiece, path)
        fields, *other_fields = separated_fields(state.fields, state.mesh)
        mesh = joined([severed.mesh, *others], first_parts)
        held = joined_fields([restricted(fields, severed), *other_fields])
        return replace(
            state, mesh=mesh, fields=held, ledger=state.ledger.plus(**_amounts(problem, state, mesh, held))
        )
    return state


def chip_end(problem: Problem, mesh: Mesh, cut: Cut, tool: MovingTool, time: float) -> tuple[Crossing, ...]:
    """Where the end of the chip is to be cut off, if it is long enough.

    The length is that of the boundary from the tool's tip, along the side of the chip that slid over the rake face.
    """
    boundary = mesh.boundary
    at = mesh.points[boundary.particles]
    tip = tool.at(time).rake_tangent_point
    order = loop_after(boundary, int(np.argmin(np.hypot(*(at - tip).T))))
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(at[order], axis=0).T))])
    first = int(np.searchsorted(way, cut.chip_length))
    # Not beyond what holds the workpiece.
    held = np.isin(boundary.parts[order], _supported_parts(problem))
    last = int(np.argmax(held)) if held.any() else len(order)
    ends = np.arange(first + 1, last)
    if not len(ends):
        return ()
    beyond = way[ends] - way[first]
    path = crossing(mesh, int(order[first]), order[ends], beyond, THICKEST * cut.depth)
    if path is None:
        return ()
    # Round the piece: twice its length, and its end face.
    round_piece = float(beyond[order[ends] == path.end][0])
    return (path,) if round_piece > 2.0 * PIECE * cut.chip_length + path.length else ()


def restricted(fields: Fields, severed: Severed) -> Fields:
    """The ``fields`` of the particles and cells that stay."""
    rows = {Where.PARTICLE: severed.particles, Where.ELEMENT: severed.cells}
    return Fields(**{each.name: getattr(fields, each.name)[rows[each.where]] for each in declarations()})


def _supported_parts(problem: Problem) -> list[int]:
    names = {motion.part for motion in problem.motions}
    return [number for number, name in enumerate(problem.body.parts) if name in names]


def _amounts(problem: Problem, state: State, mesh: Mesh, fields: Fields) -> dict[str, float]:
    """Mass, energy (elastic, of springs, with inertia also kinetic) and heat that went."""
    time, last_step = state.clock.time, state.clock.last_dt
    kinetic = 0.0
    if problem.time.inertia:
        kinetic = energies.kinetic_energy(problem, state.mesh, state.fields, last_step)
        kinetic -= energies.kinetic_energy(problem, mesh, fields, last_step)
    return {
        "cut_off_mass": energies.mass(problem, state.mesh, state.fields)
        - energies.mass(problem, mesh, fields),
        "cut_off_energy": energies.elastic_energy(problem, state.mesh, state.fields)
        + energies.contact_energy(problem, state.mesh, time)
        - energies.elastic_energy(problem, mesh, fields)
        - energies.contact_energy(problem, mesh, time)
        + kinetic,
        "cut_off_heat": energies.heat_content(problem, state.mesh, state.fields)
        - energies.heat_content(problem, mesh, fields),
    }
