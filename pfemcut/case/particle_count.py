"""How many particles a size field asks for, before anything is meshed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from meshing.sizes import SizeField
from pfemcut.inputs import InputError
from pfemcut.problem import Problem

LARGEST_COUNT = 2_000_000
"""Particles beyond which there is no use in counting, or running."""


def body_counts(problem: Problem) -> dict[str, float]:
    """About how many particles each body has at the start, by its name; infinite beyond ``LARGEST_COUNT``."""
    counts = {}
    for body in problem.bodies:
        for mesh in body.given:
            counts[body.name] = float(len(mesh.points))
        if body.outline:
            corners = np.asarray(body.outline, dtype=np.float64)
            low, (length, height) = corners.min(axis=0), np.ptp(corners, axis=0)
            sizes = (*body.sizes, problem.particles.sizes)[0]
            counts[body.name] = particle_estimate(sizes, float(length), float(height), (low[0], low[1]))
    return counts


def chip_count(problem: Problem) -> float:
    """About how many particles the chip of a cut has at the end; zero if nothing is cut."""
    count = 0.0
    for cut in problem.cut:
        spacing = float(problem.particles.sizes(np.array([[0.0, cut.surface + cut.depth]]))[0])
        count += cut.depth * cut.speed * problem.time.end / (math.sqrt(0.75) * spacing**2)
    return count


def require_countable(problem: Problem) -> None:
    """Raise :class:`InputError` for a body, or the chip at the end, that would have too many particles."""
    counts = {**body_counts(problem), "the chip": chip_count(problem)}
    wrong = [name for name, count in counts.items() if count > LARGEST_COUNT]
    if wrong:
        limit = f"more than {LARGEST_COUNT / 1e6:g} million particles"
        raise InputError(f"[mesh] sizes ask for {limit} in '{name}'; make them larger" for name in wrong)


def require_fillable(name: str, lengths: Sequence[float], spacing: float) -> None:
    """Raise :class:`InputError` if a box of these ``lengths`` (mm) takes too many particles ``spacing`` (mm) apart."""
    # By logarithms: the product may overflow.
    cells = [max(math.log(length) - math.log(spacing), 0.0) for length in lengths if length > 0.0]
    if sum(cells) > math.log(LARGEST_COUNT):
        limit = f"more than {LARGEST_COUNT / 1e6:g} million particles"
        raise InputError([f"[particles] spacing asks for {limit} in '{name}'; make it larger"])


def particle_estimate(
    sizes: SizeField, length: float, height: float, corner: tuple[float, float] = (0.0, 0.0)
) -> float:
    """About how many particles of spacing ``sizes`` fill a block.

    A particle of an equilateral triangulation owns an area of sqrt(3)/2 h²; the boundary adds half a particle
    per spacing. The integrals are taken over squares that are quartered until they are no wider than h; the number is
    infinite if that takes more than ``LARGEST_COUNT`` squares.

    Parameters
    ----------
    sizes
        Spacing (mm).
    length, height
        Of the block (mm).
    corner
        Its lower left corner (mm).
    """
    side = sizes.far_size
    if not (length / side + 1.0) * (height / side + 1.0) < LARGEST_COUNT:
        return math.inf
    origin = np.asarray(corner)
    columns, rows = max(math.ceil(length / side), 1), max(math.ceil(height / side), 1)
    widths = np.array([length / columns, height / rows])
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    centres = origin + np.column_stack([x.ravel(), y.ravel()]) * widths
    quarters = np.array([[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]])

    inside = 0.0
    while len(centres):
        spacing = sizes(centres)
        fine = spacing >= widths.max()
        inside += float(np.sum(widths.prod() / (math.sqrt(0.75) * spacing[fine] ** 2)))
        if inside > LARGEST_COUNT or 4 * np.count_nonzero(~fine) > LARGEST_COUNT:
            return math.inf
        centres = (centres[~fine, None, :] + quarters * widths).reshape(-1, 2)
        widths = widths / 2.0

    outline = 0.0
    for start, end in (
        ((0.0, 0.0), (length, 0.0)),
        ((length, 0.0), (length, height)),
        ((length, height), (0.0, height)),
        ((0.0, height), (0.0, 0.0)),
    ):
        a, b = origin + start, origin + end
        parts = 4000
        middle = a + ((np.arange(parts) + 0.5) / parts)[:, None] * (b - a)
        outline += float(np.sum(np.hypot(*(b - a)) / parts / sizes(middle)))
    count = inside + outline / 2.0
    return count if count <= LARGEST_COUNT else math.inf
