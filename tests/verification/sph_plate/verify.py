"""The period of a plate that is clamped at one end: thin-plate theory, plane elasticity, and particles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.particles.integrate import advance, initial_state
from pfemcut.sph.esph import Eulerian
from pfemcut.sph.tlsph import TotalLagrangian
from tests.particle_problems import ELASTIC, block, moving

from ..common import orders, save_picture, write_results
from .linear import CLAMP, frequency
from .reference import CLAMPED_FREE, ritz, thin_plate

FOLDER = Path(__file__).parent
YOUNG, POISSON, DENSITY = 200e3, 0.3975, 7.8e-9
LENGTH, THICKNESS = 10.0, 1.0
PLATE = (LENGTH, THICKNESS, YOUNG, POISSON, DENSITY)
EXACT, EXACT_FREE = ritz(*PLATE), ritz(*PLATE, clamped=False)
COUNTS = (4, 6, 8, 12, 16, 24)
STEPPED = (4, 6, 8, 12)


def linear_error(across: int, **controls: Any) -> float:
    """Period of small vibrations over that of plane elasticity, less one."""
    exact = EXACT if controls.get("clamped", True) else EXACT_FREE
    return exact / frequency(*PLATE, across=across, near=exact, **controls) - 1.0


def stepped_period(across: int, method: str = "tlsph", speed: float = 1e-4, **particles: Any) -> float:
    """Period (s) of a run in time that starts with the mode's velocity.

    ``speed`` is that of the free end over the speed of sound sqrt(K / rho).
    """
    spacing = THICKNESS / across
    clamp = CLAMP * spacing
    plain = block(
        (LENGTH + clamp, THICKNESS),
        method=method,
        spacing=spacing,
        end=1.0,
        material={**ELASTIC, "young_modulus": YOUNG, "poisson_ratio": POISSON},
        hold=[{"box": [[0.0, 0.0], [clamp, THICKNESS]]}],
        alpha=0.0,
        beta=0.0,
        **{"reference_update": 0.0, **particles},
    )
    sound = np.sqrt(YOUNG / (3.0 * (1.0 - 2.0 * POISSON)) / DENSITY)
    kx = CLAMPED_FREE * np.maximum(plain.points[:, 0] - clamp, 0.0) / LENGTH

    def shape(x: Any) -> Any:
        k = CLAMPED_FREE
        ratio = (np.cos(k) + np.cosh(k)) / (np.sin(k) + np.sinh(k))
        return np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x))

    mode = shape(kx) / shape(CLAMPED_FREE)
    problem = moving(plain, lambda x: np.column_stack([0.0 * mode, speed * sound * mode]))
    model: Any = (TotalLagrangian if method == "tlsph" else Eulerian)(problem)
    state: Any = initial_state(model)
    last, zeros = 1.0, []
    while len(zeros) < 2:
        before = state.clock.time
        state = advance(model, state)
        value = float(mode @ state.velocities[:, 1])
        if last * value < 0.0:
            zeros.append(before + state.clock.dt * last / (last - value))
        last = value
    return 2.0 * (zeros[1] - zeros[0])


def main() -> None:
    exact = 2.0 * np.pi / EXACT
    thin = 2.0 * np.pi / thin_plate(*PLATE)
    rows: list[dict[str, Any]] = []
    kinds: list[tuple[str, float, dict[str, Any]]] = [
        ("small vibrations", 1.5, {}),
        ("small vibrations", 1.2, {}),
        ("small vibrations", 2.0, {}),
        ("small vibrations, not corrected", 1.5, {"corrected": False}),
        ("small vibrations, free plate", 1.5, {"clamped": False}),
        ("small vibrations, stiffer control", 1.5, {"control": 0.5}),
    ]
    for name, smoothing, options in kinds:
        errors = [linear_error(n, smoothing=smoothing, **options) for n in COUNTS]
        for n, error, order in zip(COUNTS, errors, orders([1.0 / n for n in COUNTS], errors), strict=True):
            rows.append(
                {
                    "run": name,
                    "across": n,
                    "h_over_spacing": smoothing,
                    "period_error_%": 100.0 * error,
                    "order": order,
                }
            )
            print(rows[-1], flush=True)
    for n in STEPPED:
        rows.append(
            {
                "run": "tlsph in time",
                "across": n,
                "h_over_spacing": 1.5,
                "period_error_%": 100.0 * (stepped_period(n) / exact - 1.0),
            }
        )
        print(rows[-1], flush=True)
    for label, options in (
        ("tlsph, 1 % of the speed of sound", {"speed": 0.01}),
        ("tlsph, 5 % of the speed of sound", {"speed": 0.05}),
        ("esph, artificial pressure 0.3", {"method": "esph"}),
        ("esph without it", {"method": "esph", "artificial_pressure": 0.0}),
    ):
        period = stepped_period(8, **options)  # type: ignore[arg-type]
        rows.append(
            {
                "run": label,
                "across": 8,
                "h_over_spacing": 1.5,
                "period_error_%": 100.0 * (period / exact - 1.0),
            }
        )
        print(rows[-1], flush=True)
    small = {
        str(row["across"]): row
        for row in rows
        if row["run"] == "small vibrations" and row["h_over_spacing"] == 1.5
    }
    in_time = {str(row["across"]): row for row in rows if row["run"] == "tlsph in time"}
    write_results(
        FOLDER,
        rows,
        {
            "thin_plate_period_s": thin,
            "plane_elasticity_period_s": exact,
            "thin_plate_error": thin / exact - 1.0,
            "small_vibrations": small,
            "free_plate": {
                str(row["across"]): row for row in rows if row["run"] == "small vibrations, free plate"
            },
            "in_time": in_time,
        },
    )
    figure, axis = plt.subplots(figsize=(4.8, 3.5), layout="constrained")
    for smoothing, mark in ((1.2, "v"), (1.5, "o"), (2.0, "^")):
        part = [r for r in rows if r["run"] == "small vibrations" and r["h_over_spacing"] == smoothing]
        size = [smoothing / r["across"] for r in part]
        axis.loglog(
            size, [r["period_error_%"] for r in part], mark + "-", ms=4, label=f"h = {smoothing} spacings"
        )
    part = [r for r in rows if r["run"] == "small vibrations, free plate"]
    size = [1.5 / r["across"] for r in part]
    axis.loglog(size, [r["period_error_%"] for r in part], "s--", ms=4, label="h = 1.5 spacings, free plate")
    axis.loglog(
        [1.5 / n for n in STEPPED], [r["period_error_%"] for r in in_time.values()], "k+", label="in time"
    )
    line = np.array([0.05, 0.3])
    axis.loglog(line, 350.0 * line**2, "k:", lw=0.8, label="second order")
    axis.set(xlabel="h / thickness", ylabel="period too long by (%)")
    axis.legend(fontsize=7)
    save_picture(FOLDER, figure)


if __name__ == "__main__":
    main()
