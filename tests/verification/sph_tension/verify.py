"""Particles under tension: Eulerian SPH without artificial pressure clusters, total-Lagrangian SPH does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import cKDTree

from pfemcut.particles.integrate import advance, initial_state
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from tests.particle_problems import ELASTIC, block, moving

from ..common import Array, save_picture, write_results

FOLDER = Path(__file__).parent
SPACING, SIZE, HELD = 0.1, 1.5, 0.3
STEPS, EVERY = 300, 20
VARIANTS = [
    ("esph", 0.0, True),
    ("esph", 0.0, False),
    ("esph", 0.3, True),
    ("esph", 0.3, False),
    ("tlsph", 0.0, True),
    ("tlsph", 0.0, False),
]


def stretched(method: str, gamma: float, corrected: bool, ratio: float) -> tuple[Array, list[float]]:
    """Positions at the end, and the distance of the nearest pair over the spacing every 20 steps.

    An elastic block, held all round, of ``ratio`` times the volume that it has without stress, and disturbed by
    velocities of 0.1 m/s.
    """
    hold = [
        {"box": [[0.0, 0.0], [HELD, SIZE]]},
        {"box": [[SIZE - HELD, 0.0], [SIZE, SIZE]]},
        {"box": [[0.0, 0.0], [SIZE, HELD]]},
        {"box": [[0.0, SIZE - HELD], [SIZE, SIZE]]},
    ]
    problem = block(
        (SIZE, SIZE),
        method=method,
        material={**ELASTIC, "poisson_ratio": 0.3},
        spacing=SPACING,
        hold=hold,
        end=1.0,
        artificial_pressure=gamma,
        corrected=corrected,
        zero_energy=0.0,
        reference_update=0.0,
    )
    random = np.random.default_rng(0)
    problem = moving(problem, lambda x: np.where(problem.held, 0.0, 100.0 * random.normal(size=x.shape)))
    model: Any = (TotalLagrangian if method == "tlsph" else Eulerian)(problem)
    state: Any = initial_state(model)
    name = "reference_ratio" if method == "tlsph" else "volume_ratio"
    state = replace(state, memory=replace(state.memory, **{name: np.full(len(problem.points), ratio)}))
    nearest = []
    for step in range(STEPS):
        state = advance(model, state)
        if (step + 1) % EVERY == 0:
            found = cKDTree(state.positions).query(state.positions, 2)[0][:, 1].min()
            nearest.append(float(found) / SPACING)
    return state.positions, nearest


def main() -> None:
    rows: list[dict[str, Any]] = []
    positions: dict[str, Array] = {}
    for ratio in (1.15, 0.95):
        for method, gamma, corrected in VARIANTS:
            name = f"{method}, gamma {gamma:g}, {'corrected' if corrected else 'not corrected'}"
            points, nearest = stretched(method, gamma, corrected, ratio)
            positions[f"{name}, {ratio}"] = points
            rows.append(
                {
                    "variant": name,
                    "volume_ratio": ratio,
                    "nearest_end": nearest[-1],
                    "nearest_least": min(nearest),
                }
            )
            print(rows[-1])
    tension = {row["variant"]: row for row in rows if row["volume_ratio"] == 1.15}
    write_results(FOLDER, rows, {"in_tension": tension})
    shown = ("esph, gamma 0, corrected", "esph, gamma 0.3, corrected", "tlsph, gamma 0, corrected")
    figure, axes = plt.subplots(1, 3, figsize=(8.4, 3.1), layout="constrained")
    for axis, name in zip(axes, shown, strict=True):
        axis.plot(*positions[f"{name}, 1.15"].T, "k.", ms=4)
        axis.set(aspect="equal", title=name, xticks=[], yticks=[])
        axis.title.set_size(8)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
