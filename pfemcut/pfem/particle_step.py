"""The particle step of a time step, body by body (paper, Box 1), and the first iterate on the new mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshing.bodies import joined, separated
from meshing.mesh import Mesh
from meshing.remesh import RemeshMap
from meshing.triangulation import BoundaryCrossing, TriangulationFailed
from pfemcut.method import CutEnded, RunStopped
from pfemcut.pfem.body_contact import surfaces_around
from pfemcut.pfem.conservation import restore_heat
from pfemcut.pfem.particles import remesh_particles
from pfemcut.pfem.prediction import predict
from pfemcut.pfem.state import Fields, State, joined_fields, separated_fields, separated_states
from pfemcut.pfem.transfer import carry_volume, transfer_fields
from pfemcut.problem import Problem
from pfemcut.timing import Stopwatch

Array = NDArray[np.float64]


def particle_step(
    problem: Problem, state: State, watch: Stopwatch
) -> tuple[Mesh, Fields, tuple[RemeshMap, ...]]:
    """Edit, triangulate and transfer each body that is remeshed; new mesh and fields, and a map for each of these.

    Raises
    ------
    CutEnded
        If in a cut a body touches itself.
    RunStopped
        If a body can't be triangulated.
    """
    parts = problem.alone
    meshes: list[Mesh] = []
    carried: list[Fields] = []
    maps: list[RemeshMap] = []
    next_id = state.mesh.next_id
    first_parts = [alone.first_part for alone in parts]
    separate = zip(
        parts,
        separated(state.mesh, first_parts),
        separated_fields(state.fields, state.mesh),
        strict=True,
    )
    for number, (part, old, held) in enumerate(separate):
        alone = part.problem
        if not (problem.particles.remesh and alone.body.remesh):
            unchanged = np.ones(len(old.cells), dtype=bool)
            meshes.append(old)
            carried.append(carry_volume(alone, old, held, unchanged))
            continue
        old = replace(old, next_id=next_id)
        with watch.phase("particles"):
            try:
                around = surfaces_around(problem, state.mesh, state.clock.time, number)
                new, remesh_map = remesh_particles(alone, old, held, around, state.clock, state.probes)
            except (BoundaryCrossing, TriangulationFailed) as failure:
                what = f"{alone.body.name} after step {state.clock.step}"
                if isinstance(failure, BoundaryCrossing) and problem.cut:
                    raise CutEnded(f"{what} touches itself: {failure}") from failure
                raise RunStopped(f"{what} can't be triangulated: {failure}") from failure
        with watch.phase("transfer"):
            fields = transfer_fields(held, old, new, remesh_map, problem.particles.transfer)
            fields = carry_volume(alone, new, fields, remesh_map.unchanged)
            carried.append(restore_heat(alone, old, held, new, fields, remesh_map))
        next_id = new.next_id
        meshes.append(new)
        maps.append(remesh_map)
    return joined(meshes, first_parts), joined_fields(carried), tuple(maps)


def first_iterate(
    problem: Problem, state: State, mesh: Mesh, fields: Fields, step: float, *, steady: bool
) -> Array:
    """First iterate of the step, body by body; shape (n, 3)."""
    first_parts = [alone.first_part for alone in problem.alone]
    tools = {tool.body for tool in problem.tool}
    guesses = [
        # A tool just goes on.
        predict(alone.problem, last, new, held, step, steady=steady and alone.problem.body.name not in tools)
        for alone, last, new, held in zip(
            problem.alone,
            separated_states(state, first_parts),
            separated(mesh, first_parts),
            separated_fields(fields, mesh),
            strict=True,
        )
    ]
    return guesses[0] if len(guesses) == 1 else np.concatenate(guesses)
