"""Chip curl radius (mm): of the circle through the chip's rake side beyond the end of contact.

Measured from 1 to 6 depths of cut beyond the end of contact, since over a shorter arc the roughness of the surface
drowns its curvature. Positive if the chip curls away from the rake face; inf for a straight chip.
"""

from __future__ import annotations

import math

import numpy as np

from pfemcut.results.derived.chip_section import ChipSection

REACH = 6.0
"""Far end of the stations for the curl, in depths beyond the end of contact."""

STRAIGHT = 1e-9


def curl_radius(section: ChipSection) -> float:
    """Return the radius (mm) of the algebraic circle fit to the rake side of ``section``; nan without stations.

    The circle a (x² + y²) + b x + c y + d = 0 of least algebraic distance is the last right singular vector of the
    points' design matrix, lengths centred and scaled by their size; the circle becomes a line as a goes to zero, so
    a straight chip is no special case.
    """
    points = section.rake_side
    if points.shape[0] < 4:
        return math.nan
    centred = points - points.mean(axis=0)
    size = float(np.sqrt((centred**2).sum(axis=1).mean()))
    x, y = (centred / size).T
    design = np.column_stack([x * x + y * y, x, y, np.ones_like(x)])
    a, b, c, d = np.linalg.svd(design, full_matrices=False)[2][-1]
    discriminant = b * b + c * c - 4.0 * a * d
    if abs(a) < STRAIGHT * math.hypot(b, c) or discriminant <= 0.0:
        return math.inf
    # The chip curls away from the rake if the circle's centre lies on the positive side of n.
    side = math.copysign(1.0, -c / (2.0 * a))
    return side * size * math.sqrt(discriminant) / (2.0 * abs(a))
