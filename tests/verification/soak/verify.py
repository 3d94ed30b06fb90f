"""20,000 steps of a small cut: memory stays flat, no step fails or hangs.

    python -m tests.verification.soak.verify

takes about a quarter of an hour. The run's own output goes to out/soak.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from pfemcut.validation.provenance import ROOT, machine

from ..common import save_picture, write_results
from .sampled import Sample, sampled_run

FOLDER = Path(__file__).parent

STEPS = 20_000
SETTLED = 1_000  # steps after which memory must stay
EVERY = 100
LIMIT = 0.05  # of the resident memory after SETTLED steps


def growth(samples: Sequence[Sample], settled: int) -> float:
    """Largest resident memory from step ``settled`` on, relative to the one there, minus one."""
    resident = [sample["resident_megabytes"] for sample in samples if sample["step"] >= settled]
    return max(resident) / resident[0] - 1.0


def late_slope(samples: Sequence[Sample]) -> float:
    """Straight-line growth of the resident memory over the last half of the steps (bytes a step)."""
    late = samples[len(samples) // 2 :]
    steps, resident = zip(*((each["step"], each["resident_megabytes"]) for each in late), strict=True)
    return 1e6 * float(np.polyfit(steps, resident, 1)[0])


def draw(samples: Sequence[Sample]) -> None:
    """Resident memory, particles and pace against the step."""
    step = [sample["step"] for sample in samples]
    figure, axes = plt.subplots(3, 1, figsize=(8, 6), layout="constrained", sharex=True)
    for axis, column, label in zip(
        axes,
        ("resident_megabytes", "particles", "milliseconds_per_step"),
        ("resident memory (MB)", "particles", "ms per step"),
        strict=True,
    ):
        axis.plot(step, [sample[column] for sample in samples], "C0", linewidth=1.0)
        axis.set(ylabel=label, ylim=(0.0, None))
        axis.grid(alpha=0.3)
    axes[-1].set(xlabel="step")
    save_picture(FOLDER, figure)


def main() -> bool:
    """Run, record, and say whether the soak passed."""
    summary, samples = sampled_run(FOLDER / "case.toml", ROOT / "out" / "soak", EVERY)
    last = samples[-1]
    grown = growth(samples, SETTLED)
    slowest = max(sample["slowest_step_milliseconds"] for sample in samples[1:])
    passed = summary.finished and summary.steps >= STEPS and last["halved_steps"] == 0 and grown < LIMIT
    write_results(
        FOLDER,
        samples,
        {
            "machine": machine(),
            "ending": summary.ending,
            "steps": summary.steps,
            "halved_steps": int(last["halved_steps"]),
            "memory_growth": grown,
            "memory_limit": LIMIT,
            "late_bytes_per_step": late_slope(samples),
            "resident_megabytes": {
                "settled": next(s["resident_megabytes"] for s in samples if s["step"] >= SETTLED),
                "largest": max(sample["resident_megabytes"] for sample in samples),
                "end": last["resident_megabytes"],
            },
            "particles": {"settled": samples[SETTLED // EVERY - 1]["particles"], "end": last["particles"]},
            "milliseconds_per_step": float(np.mean([sample["milliseconds_per_step"] for sample in samples])),
            "slowest_step_milliseconds": slowest,
            "passed": passed,
        },
    )
    draw(samples)
    return passed


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
