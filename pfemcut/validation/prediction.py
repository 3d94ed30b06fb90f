"""Predictions of measured cuts: their uncertainty, and how far they are from the measurements.

Uncertainty of a predicted figure, as half-width, the root of the sum of squares of

- mesh: grid convergence index (Roache 1994) of one cut of the set, whose mesh is coarsened,
- step: the same with longer steps,
- window: twice the standard deviation over the steady window.

Mesh and step parts are relative and taken over from the cut that was repeated to all others.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from pfemcut.converge.order import grid_convergence_index
from pfemcut.inputs import InputError, explained, read_toml
from pfemcut.validation.study import Outcome

ORDER = 1.0
"""Assumed of the error in the mesh size and in the step; two runs don't show it."""
WINDOW_DEVIATIONS = 2.0

LABELS = {
    "cutting_force": "cutting force (N/mm)",
    "thrust_force": "feed force (N/mm)",
    "chip_ratio": "chip / uncut thickness",
}
"""The compared figures."""


class Value(BaseModel):
    """A measured value with its scatter (half-width)."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    value: float = Field(gt=0)
    scatter: float = Field(ge=0)


class MeasuredCut(BaseModel):
    """One measured cut; forces in N over the width of cut, the chip thickness over the uncut one."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    name: str = Field(min_length=1)
    cutting_force: Value
    thrust_force: Value
    chip_ratio: Value


class Measurements(BaseModel):
    """A ``measured.toml``: the width of cut (mm), where the values stand, and the cuts."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    width: float = Field(gt=0)
    source: str = Field(min_length=1)
    cut: list[MeasuredCut]


@dataclass(frozen=True)
class Figure:
    """A figure with its half-width; nan where it is not known."""

    value: float
    half_width: float


@dataclass(frozen=True)
class PlannedCut:
    """A cut of a set: name of its run, uncut chip thickness (mm), cutting speed (m/min)."""

    name: str
    depth: float
    speed: float


def planned(micrometres: int, speed: float) -> PlannedCut:
    """A cut by its uncut chip thickness (um) and speed (m/min), named by both."""
    return PlannedCut(f"{micrometres}um_{speed:g}", micrometres / 1000.0, speed)


def cut_changes(
    cut: PlannedCut,
    tip_size: float,
    mesh_factor: float = 1.0,
    step_factor: float = 1.0,
) -> tuple[str, ...]:
    """What a cut changes in its set's case: depth, speed, block, mesh and steps, but for friction.

    The block is 10 depths high and 20 long, for a travel up to 10. The shear zone has 12 particles a depth. In the
    nominal step the tool goes on by a tenth of ``tip_size`` (mm), in the largest by half of it; the controller chooses
    between.
    """
    depth, speed = cut.depth, cut.speed * 1000.0 / 60.0
    sizes = {
        "tip_size": tip_size,
        "shear_zone_size": depth / 12.0,
        "chip_size": 0.15 * depth,
        "surface_size": 0.2 * depth,
        "growth": 0.1,
    }
    values = {
        "cutting.depth": depth,
        "cutting.speed": speed,
        "contact.reference_speed": 0.01 * speed,
        "workpiece.length": 20.0 * depth,
        "workpiece.height": 10.0 * depth,
        "mesh.far_size": 2.0 * depth,
        **{f"mesh.{key}": size * mesh_factor for key, size in sizes.items()},
        "time.step": step_factor * 0.1 * tip_size / speed,
        "time.largest_step": step_factor * 0.5 * tip_size / speed,
        "time.step_tolerance": step_factor * 0.1,
    }
    return tuple(f"{key}={value:.6g}" for key, value in values.items())


def load_measurements(path: Path) -> dict[str, dict[str, Figure]]:
    """Read a ``measured.toml``: figures by name of the cut, forces in N/mm.

    Raises
    ------
    InputError
        With one line for each problem found.
    """
    try:
        content = Measurements.model_validate(read_toml(path))
    except ValidationError as error:
        raise InputError([f"{path}: {line}" for line in explained(error, Measurements)]) from None
    return {
        cut.name: {
            "cutting_force": _per_width(cut.cutting_force, content.width),
            "thrust_force": _per_width(cut.thrust_force, content.width),
            "chip_ratio": _per_width(cut.chip_ratio, 1.0),
        }
        for cut in content.cut
    }


def convergence_index(fine: float, coarse: float, ratio: float) -> float:
    """Grid convergence index of the fine value, relative to it, with the assumed order."""
    return grid_convergence_index(fine, coarse, ratio, ORDER)


def half_width(value: float, relative_parts: Sequence[float], window_deviation: float) -> float:
    """Half-width of a predicted ``value``; parts that are not known (nan) are left out."""
    parts = [value * part for part in relative_parts] + [WINDOW_DEVIATIONS * window_deviation]
    return math.sqrt(sum(part**2 for part in parts if math.isfinite(part)))


def predicted(outcome: Outcome, depth: float) -> dict[str, Figure]:
    """The compared figures of a run with the standard deviation over the window."""
    found = {
        name: Figure(outcome.mean(name), outcome.std(name)) for name in ("cutting_force", "thrust_force")
    }
    thickness = Figure(outcome.mean("chip_thickness"), outcome.std("chip_thickness"))
    return {**found, "chip_ratio": Figure(thickness.value / depth, thickness.half_width / depth)}


def differences(
    predictions: Mapping[str, Mapping[str, Figure]], measured: Mapping[str, Mapping[str, Figure]]
) -> dict[str, dict[str, float]]:
    """(predicted − measured) / measured, by cut and figure, of the cuts in both."""
    return {
        cut: {name: predictions[cut][name].value / figure.value - 1.0 for name, figure in figures.items()}
        for cut, figures in measured.items()
        if cut in predictions
    }


def mean_and_largest(found: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """Mean and largest absolute difference over the cuts, by figure."""
    return {
        name: {
            "mean": float(np.mean([abs(cut[name]) for cut in found.values()])),
            "largest": float(np.max([abs(cut[name]) for cut in found.values()])),
        }
        for name in LABELS
        if found
    }


def numerical_parts(
    figures: Mapping[str, Figure] | None, coarser: Mapping[str, Figure] | None, ratio: float
) -> dict[str, float]:
    """Relative convergence index of each figure; nan while a run is missing."""
    return {
        name: math.nan
        if figures is None or coarser is None
        else convergence_index(figures[name].value, coarser[name].value, ratio)
        for name in LABELS
    }


def _per_width(measured: Value, width: float) -> Figure:
    return Figure(measured.value / width, measured.scatter / width)
