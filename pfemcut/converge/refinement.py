"""What refinement changes in a case: all sizes of its meshes, its time steps, or both by the same factor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.load import AnyCase
from pfemcut.case.particles import ExplicitEnd
from pfemcut.sweep.plan import Values, Variant

SIZES = (
    "size",
    "tip_size",
    "shear_zone_size",
    "chip_size",
    "surface_size",
    "far_size",
    "face_size",
    "growth",
    "spacing",
)
"""Keys that scale with the mesh; the growth decides how fast the spacing widens, so it is one of them."""
MESHES = (("mesh",), ("tool", "body"), ("tool", "conduction"), ("particles",), ("lattice",))
"""Tables that these keys are in."""
CASE = "case"
"""Name of the case as it is."""


class What(StrEnum):
    """What is refined."""

    MESH = "mesh"
    STEP = "step"
    BOTH = "both"
    TOGETHER = "together"


@dataclass(frozen=True)
class Ladder:
    """Variants of one case from the coarsest level to the finest.

    Attributes
    ----------
    name
        ``mesh``, ``step`` or ``together``.
    factors
        Sizes relative to the case's, falling.
    variants
        The variant of each factor.
    """

    name: str
    factors: tuple[float, ...]
    variants: tuple[Variant, ...]


def ladders_of(case: AnyCase, what: What, ratio: float, levels: int, finer: int) -> tuple[Ladder, ...]:
    """The ladders of a case: one, or for both a ladder of the mesh and one of the step.

    Parameters
    ----------
    case
        The case.
    what
        What is refined.
    ratio
        Of the sizes of neighbouring levels.
    levels
        Number of levels.
    finer
        How many of them are finer than the case; the others are the case itself and coarser ones.
    """
    factors = tuple(ratio**power for power in range(levels - 1 - finer, -finer - 1, -1))
    whats = (What.MESH, What.STEP) if what is What.BOTH else (what,)
    return tuple(
        Ladder(each.value, factors, tuple(_variant(case, each, factor) for factor in factors))
        for each in whats
    )


def _variant(case: AnyCase, what: What, factor: float) -> Variant:
    if factor == 1.0:
        return Variant(CASE, {})
    values: dict[str, Any] = {}
    if what is not What.STEP:
        values |= scaled_sizes(case, factor)
    if what is not What.MESH:
        values |= scaled_steps(case, factor)
    return Variant(f"{what.value}={factor:.4g}", values)


def scaled_sizes(case: AnyCase, factor: float) -> dict[str, float]:
    """All sizes of the case's meshes times the factor, by ``section.key``."""
    table = case.model_dump()
    found: dict[str, float] = {}
    for path in MESHES:
        inner: Any = table
        for key in path:
            inner = inner.get(key) if isinstance(inner, Mapping) else None
        found |= {f"{'.'.join(path)}.{key}": _rounded(factor * value) for key, value in _sizes(inner)}
    return found


def scaled_steps(case: AnyCase, factor: float) -> Values:
    """The case's time steps times the factor, by ``section.key``.

    Where steps may grow beyond the nominal one, plastic flow decides how far: what it allows scales too.
    """
    if isinstance(case, LaminaCase):
        return {}
    time = case.time
    if isinstance(time, ExplicitEnd):
        # Explicit steps follow the spacing of the particles by themselves.
        return {}
    found = {"time.step": _rounded(factor * time.step)}
    if time.largest_step is not None:
        found["time.largest_step"] = _rounded(factor * time.largest_step)
        found["time.step_tolerance"] = _rounded(factor * time.step_tolerance)
    return found


def _sizes(table: Any) -> Iterator[tuple[str, float]]:
    """Sizes in a table and in the tables of its lists, by their key."""
    for key, value in table.items() if isinstance(table, Mapping) else ():
        if key in SIZES and isinstance(value, float):
            yield key, value
        elif isinstance(value, Sequence) and not isinstance(value, str):
            for index, each in enumerate(value):
                yield from ((f"{key}.{index}.{inner}", size) for inner, size in _sizes(each))


def _rounded(value: float) -> float:
    """To ten digits, so that a size reads well and the same power of a ratio is the same size."""
    return float(f"{value:.10g}")
