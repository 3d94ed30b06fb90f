"""Chip thickness and chip ratio (picture: docs/pictures/chip_thickness.png).

The mean distance (mm) between the two surfaces of the chip from 1 to 2 depths of cut beyond the end of contact,
measured normal to the chip's own rake side, which is the normal of the rake face where the chip is straight. Where the
chip curls away from the rake at an angle, the distance along the rake's normal would be too large by one over its
cosine. A chip too short for the whole range is measured on the part that exists, and flagged.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pfemcut.results.derived.chip_section import ChipSection


@dataclass(frozen=True)
class ChipThickness:
    """Mean thickness (mm), nan if the chip is too short; whether the whole range was measured."""

    mean: float
    complete: bool


def chip_thickness(section: ChipSection) -> ChipThickness:
    """Return the mean thickness over the stations of ``section`` (1 to 2 depths)."""
    local = section.thickness
    return ChipThickness(float(local.mean()) if local.size else math.nan, section.complete)
