"""Colour scales that stay the same from frame to frame and, as far as they can, from run to run.

A scale ends at a round number. So all frames of a run have one scale, that of the last frame, and runs whose values
are alike have the same one; where they aren't, both can be drawn with a scale that is given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.colors import LogNorm, Normalize
from numpy.typing import NDArray

from pfemcut.inputs import InputError, nearest

Array = NDArray[np.float64]
Scales = Mapping[str, tuple[float, float]]
"""Lower and upper end of the scales that were given, by field."""

ROUND = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
DECADES = 4

matplotlib.use("Agg")  # No display on a cluster.


def round_up(value: float) -> float:
    """Return the next of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten that is not below a positive ``value``."""
    decade = 10.0 ** math.floor(math.log10(value))
    return next(step for step in ROUND if step * decade >= value * (1.0 - 1e-12)) * decade


def temperature_scale(values: Array) -> Normalize:
    """Return a scale from the lowest temperature, rounded down to 10 K, to the highest, rounded up to 100 K."""
    low = 10.0 * math.floor(float(values.min()) / 10.0)
    return Normalize(low, max(100.0 * math.ceil(float(values.max()) / 100.0), low + 100.0))


def from_zero(values: Array) -> Normalize:
    """Return a scale from zero to the value that one per cent exceeds, rounded up.

    The highest per cent is the tip's: it would leave no colours for the chip.
    """
    return Normalize(0.0, round_up(max(float(np.percentile(values, 99.0)), 1e-12)))


def four_decades(values: Array) -> Normalize:
    """Return a logarithmic scale over four decades, up to the power of ten above the highest value."""
    decade = 10.0 ** math.ceil(math.log10(max(float(values.max()), 1.0)))
    return LogNorm(decade * 10.0**-DECADES, decade)


def given_scales(texts: Sequence[str], fields: Sequence[str]) -> Scales:
    """Return the scales of ``FIELD=LOW:HIGH`` each.

    Raises
    ------
    InputError
        If one can't be read, or names none of ``fields``.
    """
    found, problems = {}, []
    for text in texts:
        name, _, ends = text.partition("=")
        low, _, high = ends.partition(":")
        try:
            scale = (float(low), float(high))
        except ValueError:
            scale = (0.0, 0.0)
        if name not in fields:
            problems.append(f"--scale: unknown field '{name}'{nearest(name, fields)}")
        elif not (math.isfinite(scale[0]) and math.isfinite(scale[1]) and scale[0] < scale[1]):
            problems.append(f"--scale: given '{text}', must be FIELD=LOW:HIGH with numbers LOW < HIGH")
        else:
            found[name] = scale
    if problems:
        raise InputError(problems)
    return found


def with_ends(scale: Normalize, ends: tuple[float, float]) -> Normalize:
    """Return a scale of the same kind with the given ends; a logarithmic one over eight decades at most."""
    low, high = ends
    if isinstance(scale, LogNorm):
        return LogNorm(max(low, high * 1e-8), high)
    return Normalize(low, high)
