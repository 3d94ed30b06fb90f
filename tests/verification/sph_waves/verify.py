"""The period of the longest wave in a free bar against 2 L sqrt(rho / E)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.particles.integrate import advance, initial_state
from pfemcut.particles.problem import ParticleProblem
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from tests.particle_problems import ELASTIC, block, moving

from ..common import Array, orders, save_picture, write_results
from .integrators import compared

FOLDER = Path(__file__).parent
LENGTH = 4.0
PERIOD = 2.0 * LENGTH / np.sqrt(200e3 / 7.8e-9)
COUNTS = (10, 20, 40, 80)
VARIANTS: dict[str, dict[str, Any]] = {
    "tlsph": {"method": "tlsph", "zero_energy": 0.0},
    "tlsph, control of zero-energy modes": {"method": "tlsph", "zero_energy": 0.1},
    "tlsph, not corrected": {"method": "tlsph", "zero_energy": 0.0, "corrected": False},
    "esph": {"method": "esph", "artificial_pressure": 0.0},
}


@dataclass(frozen=True)
class Wave:
    """Amplitude of the mode's velocity over the start's, at times (s)."""

    times: Array
    amplitude: Array

    @property
    def period(self) -> float:
        """Twice the time between the first two zeros."""
        t, a = self.times, self.amplitude
        before = np.flatnonzero(a[:-1] * a[1:] < 0.0)[:2]
        zeros = t[before] + (t[before + 1] - t[before]) * a[before] / (a[before] - a[before + 1])
        return 2.0 * float(zeros[1] - zeros[0])


def bar(count: int, **particles: Any) -> ParticleProblem:
    """``count`` particles along its length and four across, held across; nu = 0, no viscosity; in its longest mode."""
    spacing = LENGTH / count
    hold = [{"box": [[0.0, 0.0], [LENGTH, 4.0 * spacing]], "axes": "y"}]
    plain = block(
        (LENGTH, 4.0 * spacing),
        spacing=spacing,
        end=1.0,
        material=ELASTIC,
        hold=hold,
        alpha=0.0,
        beta=0.0,
        reference_update=0.0,
        **particles,
    )
    mode = np.cos(np.pi * plain.points[:, 0] / LENGTH)
    return moving(plain, lambda x: np.column_stack([1e3 * mode, 0.0 * mode]))


def wave(count: int, periods: float = 1.1, **particles: Any) -> Wave:
    """The bar's vibration over some periods."""
    problem = bar(count, **particles)
    mode = problem.velocities[:, 0] / 1e3
    model: Any = (TotalLagrangian if particles["method"] == "tlsph" else Eulerian)(problem)
    state: Any = initial_state(model)
    times, amplitude = [0.0], [1.0]
    while state.clock.time < periods * PERIOD:
        state = advance(model, state)
        times.append(state.clock.time)
        amplitude.append(float(mode @ state.velocities[:, 0] / (1e3 * mode @ mode)))
    return Wave(np.array(times), np.array(amplitude))


def main() -> None:
    rows: list[dict[str, Any]] = []
    for name, variant in VARIANTS.items():
        waves = [wave(count, **variant) for count in COUNTS]
        errors = [each.period / PERIOD - 1.0 for each in waves]
        order = orders([1.0 / count for count in COUNTS], errors)
        for count, each, error, found in zip(COUNTS, waves, errors, order, strict=True):
            rows.append(
                {
                    "variant": name,
                    "particles_along": count,
                    "period_s": each.period,
                    "error_%": 100.0 * error,
                    "order": found,
                    "second_peak": float(each.amplitude[len(each.amplitude) // 2 :].max()),
                }
            )
            print(rows[-1])
    finest = {row["variant"]: row for row in rows if row["particles_along"] == 40}
    schemes = compared(lambda **controls: bar(20, method="tlsph", zero_energy=0.0, **controls), PERIOD)
    write_results(
        FOLDER, rows, {"exact_period_s": PERIOD, "with_40": finest, "energy_after_20_periods": schemes}
    )
    figure, axis = plt.subplots(figsize=(4.6, 3.4), layout="constrained")
    for name in VARIANTS:
        part = [row for row in rows if row["variant"] == name]
        axis.loglog(COUNTS, [abs(row["error_%"]) for row in part], "o-", label=name)
    axis.loglog(COUNTS, [100.0 / n**2 for n in COUNTS], "k:", label="second order")
    axis.set(xlabel="particles along the bar", ylabel="error of the period (%)")
    axis.set_xticks(COUNTS, [str(count) for count in COUNTS])
    axis.minorticks_off()
    axis.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
