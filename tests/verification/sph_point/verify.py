"""Simple shear of Voce's steel with particles, against the one-point integration that also verifies the PFEM."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.particles.heat import heat_content
from pfemcut.particles.integrate import advance, initial_state
from pfemcut.particles.state import State
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from tests.particle_problems import block, moving

from ..common import Array, orders, save_picture, write_results
from ..homogeneous import reference

FOLDER = Path(__file__).parent
MODELS: dict[str, Any] = {"tlsph": TotalLagrangian, "esph": Eulerian}
STEPS = (50, 100, 200, 400)


def sheared(method: str, steps: int, renew: float = 0.0, corrected: bool = True) -> tuple[Array, State[Any]]:
    """Rows of shear, shear stress, plastic strain and temperature (means), and the end state.

    All particles move with u = t y e_x up to a shear of one, in ``steps`` steps; heating is adiabatic. ``renew`` is the
    relative displacement over h at which the reference is renewed, looked at every tenth step.
    """
    plain = block(
        (1.0, 1.0), method=method, material="voce_steel", end=1.0, reference_update=renew, corrected=corrected
    )
    limit = plain.smoothing.smoothing_length / plain.sound_speed
    rate = 1.0 / (steps * 0.2 * limit)
    held = block(
        (1.0, 1.0),
        method=method,
        material="voce_steel",
        end=1.0 / rate,
        hold=[{"box": [[0.0, 0.0], [1.0, 1.0]]}],
        reference_update=renew,
        corrected=corrected,
        courant=0.2 * (1.0 + rate / plain.sound_speed),
    )
    problem = moving(held, lambda x: np.column_stack([rate * x[:, 1], 0.0 * x[:, 1]]))
    model = MODELS[method](problem)
    state: Any = initial_state(model)
    rows = []
    while state.clock.time < problem.time.end * (1.0 - 1e-12):
        state = advance(model, state)
        if state.clock.steps % 10 == 0:
            memory, _ = model.renewed(state.memory, state.positions, state.volume_ratio)
            state = State(**{**vars(state), "memory": memory})
        material = state.material
        rows.append(
            [
                rate * state.clock.time,
                material.deviator[:, 3].mean(),
                material.eqps.mean(),
                material.temperature.mean(),
            ]
        )
    chi = problem.bodies[0].material.taylor_quinney
    assert abs(heat_content(problem, material.temperature) / (chi * state.ledger.plastic) - 1.0) < 1e-6
    return np.array(rows), state


def errors(method: str, steps: int, **options: Any) -> dict[str, Any]:
    """Differences from the one-point integration at the end, and the spread over the particles."""
    rows, state = sheared(method, steps, **options)
    exact = reference.shear(rows[-1:, 0], adiabatic=True)
    stress = exact.cauchy[-1, 0, 1]
    return {
        "method": method + "".join(f", {name} {value}" for name, value in options.items()),
        "steps": state.clock.steps,
        "stress": rows[-1, 1],
        "stress_reference": stress,
        "stress_error_%": 100.0 * (rows[-1, 1] / stress - 1.0),
        "eqps_error_%": 100.0 * (rows[-1, 2] / exact.eqps[-1] - 1.0),
        "warming_error_%": 100.0
        * ((rows[-1, 3] - reference.THETA_0) / (exact.temperature[-1] - reference.THETA_0) - 1.0),
        "spread_MPa": float(np.ptp(state.material.deviator[:, 3])),
        "volume": float(np.abs(state.volume_ratio - 1.0).max()),
    }


def main() -> None:
    rows: list[dict[str, Any]] = []
    for method in MODELS:
        part = [errors(method, steps) for steps in STEPS]
        found = orders([1.0 / row["steps"] for row in part], [row["warming_error_%"] for row in part])
        for row, order in zip(part, found, strict=True):
            rows.append({**row, "order_of_warming": order})
            print(rows[-1], flush=True)
    rows.append(errors("tlsph", 400, renew=0.5))
    rows.append(errors("tlsph", 400, corrected=False))
    finest = {row["method"]: row for row in rows if row["steps"] > 300}
    write_results(FOLDER, rows, {"with_400_steps": finest})
    figure, axes = plt.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
    times = np.linspace(0.002, 1.0, 300)
    exact = reference.shear(times, adiabatic=True)
    axes[0].plot(times, exact.cauchy[:, 0, 1], "k-", lw=0.8, label="one-point integration")
    axes[1].plot(times, exact.temperature, "k-", lw=0.8)
    for method, mark in zip(MODELS, "o+", strict=True):
        found, _ = sheared(method, 100)
        axes[0].plot(found[::5, 0], found[::5, 1], mark, ms=4, label=f"{method}, 100 steps")
        axes[1].plot(found[::5, 0], found[::5, 3], mark, ms=4)
    axes[0].set(xlabel="shear", ylabel="shear stress (MPa)")
    axes[1].set(xlabel="shear", ylabel="temperature (K)")
    axes[0].legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
