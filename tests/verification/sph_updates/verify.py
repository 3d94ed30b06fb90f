"""The cutting force when the reference of total-Lagrangian SPH is renewed, by what the control's springs do then."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import cKDTree

from pfemcut.case.load import validated
from pfemcut.case.translate import problem_of
from pfemcut.particles.integrate import advance, initial_state
from pfemcut.particles.problem import ParticleProblem
from pfemcut.sph import tlsph
from pfemcut.sph.damping import Springs
from tests.particle_problems import CUT

from ..common import Array, save_picture, write_results

FOLDER = Path(__file__).parent
SAMPLE, LOOK, AROUND = 5, 50, 10
"""Time steps of a sample of the force, between two looks at the reference, and samples before and after an update."""


def cut(spacing: float, **particles: Any) -> ParticleProblem:
    """AISI 4340, depth 0.1 mm, rake 6 degrees, friction 0.2, 50 m/s, 0.1 mm long."""
    table = copy.deepcopy(dict(CUT))
    table["method"] = "tlsph"
    table["workpiece"].update(length=0.5, height=0.25)
    table["cutting"].update(travel=0.1)
    table["particles"].update(spacing=spacing, conduction=False, **particles)
    problem = problem_of(*validated(table, Path()), Path())
    assert isinstance(problem, ParticleProblem)
    return problem


@contextmanager
def springs(elastic: bool, forgotten: bool) -> Iterator[None]:
    """Springs that never yield, or that a new reference forgets, instead of pfemcut's."""

    def strong(slip: Array, limit: Array) -> Springs:
        return Springs(slip, np.full_like(limit, np.inf))

    def lost(strain: Array, old: Any, new: Any) -> Array:
        return np.zeros(len(new.indices))

    kept = tlsph.carried
    with (
        patch.object(tlsph, "Springs", strong if elastic else Springs),
        patch.object(tlsph, "carried", lost if forgotten else kept),
    ):
        yield


def forces(problem: ParticleProblem) -> tuple[Array, Array]:
    """Rows of time and mean cutting force of five steps, with the updates so far; and the end positions."""
    model = tlsph.TotalLagrangian(problem)
    state = initial_state(model)
    rows, impulse, since, updates = [], 0.0, 0.0, 0
    while state.clock.time < problem.time.end * (1.0 - 1e-9):
        state = advance(model, state)
        impulse += state.tool_force[0] * state.clock.dt
        if state.clock.steps % SAMPLE == 0:
            rows.append((state.clock.time, impulse / (state.clock.time - since), updates))
            impulse, since = 0.0, state.clock.time
        if state.clock.steps % LOOK == 0:
            memory, new = model.renewed(state.memory, state.positions, state.volume_ratio)
            state, updates = replace(state, memory=memory), updates + int(new)
    return np.array(rows), state.positions


def figures(name: str, spacing: float, rows: Array, positions: Array) -> dict[str, Any]:
    """Force over the second half, and its steps at updates after the third."""
    force, updates = rows[:, 1], rows[:, 2]
    half = force[len(force) // 2 :]
    steps = []
    for number in range(4, int(updates[-1]) + 1):
        first = int(np.flatnonzero(updates >= number)[0])
        if first + AROUND <= len(force):
            steps.append(force[first : first + AROUND].mean() - force[first - AROUND : first].mean())
    nearest = cKDTree(positions).query(positions, 2)[0][:, 1] / spacing
    return {
        "springs": name,
        "spacing_mm": spacing,
        "updates": int(updates[-1]),
        "cutting_force_N/mm": float(half.mean()),
        "scatter_%": 100.0 * float(half.std() / half.mean()),
        "mean_step_at_updates_%": 100.0 * float(np.mean(steps) / half.mean()),
        "rms_step_at_updates_%": 100.0 * float(np.sqrt(np.mean(np.square(steps))) / half.mean()),
        "nearest_percentile_1": float(np.quantile(nearest, 0.01)),
    }


def main() -> None:
    rows: list[dict[str, Any]] = []
    figure, axis = plt.subplots(figsize=(5.4, 3.5), layout="constrained")
    variants: list[tuple[str, bool, bool, dict[str, Any]]] = [
        ("elastic, forgotten", True, True, {}),
        ("elastic, kept", True, False, {}),
        ("yielding, forgotten", False, True, {}),
        ("yielding, kept", False, False, {}),
        ("none", False, False, {"zero_energy": 0.0}),
        ("yielding, kept, renewed at 0.25 h", False, False, {"reference_update": 0.25}),
        ("yielding, kept, renewed at 0.15 h", False, False, {"reference_update": 0.15}),
        ("yielding, kept, renewed at 0.8 h", False, False, {"reference_update": 0.8}),
    ]
    for name, elastic, forgotten, options in variants:
        with springs(elastic, forgotten):
            found, positions = forces(cut(0.01, **options))
        rows.append(figures(name, 0.01, found, positions))
        print(rows[-1], flush=True)
        if name in ("elastic, forgotten", "yielding, kept"):
            (line,) = axis.plot(1e6 * found[:, 0], found[:, 1], lw=0.9, label=name)
            new = np.flatnonzero(np.diff(found[:, 2])) + 1
            axis.plot(1e6 * found[new, 0], found[new, 1], "v", color=line.get_color(), ms=4)
    write_results(
        FOLDER, rows, {"spacing_0.01": {row["springs"]: row for row in rows if row["spacing_mm"] == 0.01}}
    )
    axis.set(
        xlabel="time (µs)",
        ylabel="cutting force (N/mm)",
        title="marks: the reference is renewed",
        ylim=(120, None),
    )
    axis.title.set_size(9)
    axis.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
