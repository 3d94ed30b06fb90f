"""What a cut leaves below the machined surface: stress, plastic strain and temperature against depth.

Taken from the last frame of a run that has unloaded (and cooled down), along verticals through the window of the
machined surface: from ``RUN_IN`` behind the edge where the tool entered to ``CLEAR`` depths of cut behind the tool's
last place. Depth counts from the surface where it is then. Stresses are Cauchy stresses in plane strain: xx along the
cut, yy normal to the surface, zz out of plane. Each level of depth has the mean over the verticals and their standard
deviation; docs/surface_integrity.md has the picture and the sources.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.interpolate import interpolate
from pfemcut.method import Frame
from pfemcut.problem import Problem
from pfemcut.results.derived.patch_recovery import recovered, triangle_areas
from pfemcut.results.derived.rays import first_crossing, loop_edges

Array = NDArray[np.float64]

VERTICALS = 64
LEVELS = 61
RUN_IN = (0.2, 2.0)
"""mm and depths of cut, of which the larger, from the edge of entry."""
CLEAR = 2.0
"""Depths of cut from the tool's last place."""
REACH = 10.0
"""Depths of cut, or down to the bottom."""
AFFECTED_STRESS = 0.1
"""Part of the largest stress in size that ends the depth affected by stress."""
AFFECTED_STRAIN = 0.01
"""Plastic strain that ends the depth affected by it."""

STRESSES = ("stress_xx", "stress_yy", "stress_zz", "stress_xy")
QUANTITIES = (*STRESSES, "plastic_strain", "temperature")


@dataclass(frozen=True)
class MachinedSurface:
    """The machined surface of a cut.

    Attributes
    ----------
    begin, end
        The window (mm in x), ``begin < end``.
    level
        Height of the lowest point of the tip (mm).
    depth
        Depth of cut (mm).
    """

    begin: float
    end: float
    level: float
    depth: float


@dataclass(frozen=True)
class ResidualProfile:
    """Means and standard deviations over the verticals, by quantity, against depth below the surface.

    Attributes
    ----------
    surface
        Where it was taken.
    depth
        mm; shape (k,).
    mean, std
        ``QUANTITIES`` (MPa, -, K), each (k,).
    section_force, section_size
        Integral of xx, and of its size, over the height below the window's surface, mean over the window (N/mm).
    """

    surface: MachinedSurface
    depth: Array
    mean: Mapping[str, Array]
    std: Mapping[str, Array]
    section_force: float
    section_size: float


def machined_surface(problem: Problem) -> tuple[MachinedSurface, ...]:
    """The machined surface of a cut and its window; none if there is no cut or too little is left between the ends."""
    for cut in problem.cut:
        tool = problem.tool[0].at(problem.time.end)
        left = max(tool.centre[0], min(x for x, _ in problem.body.outline))
        right = max(x for x, _ in problem.body.outline)
        begin = left + CLEAR * cut.depth
        end = right - max(RUN_IN[0], RUN_IN[1] * cut.depth)
        if end - begin >= cut.depth:
            return (MachinedSurface(begin, end, tool.centre[1] - tool.tip_radius, cut.depth),)
    return ()


def residual_profile(frame: Frame, surface: MachinedSurface) -> ResidualProfile:
    """The profiles of ``frame`` below the machined surface."""
    count = len(frame.points)
    fields = np.column_stack(
        [
            recovered(frame, frame.cell_fields["cauchy_stress"]),
            recovered(frame, frame.cell_fields["equivalent_plastic_strain"][:, None]),
            np.asarray(frame.point_fields["temperature"], dtype=np.float64).reshape(count, 1),
        ]
    )
    bottom = float(frame.points[:, 1].min())
    x = surface.begin + (surface.end - surface.begin) * (np.arange(VERTICALS) + 0.5) / VERTICALS
    height = surface_heights(frame, x)
    reach = min(REACH * surface.depth, float(height.min()) - bottom)
    levels = reach * np.linspace(0.0, 1.0, LEVELS) ** 2
    places = np.stack(np.broadcast_arrays(x, height - levels[:, None]), axis=-1).reshape(-1, 2)
    found, inside = interpolate(frame.points, frame.cells, fields, places, 0.5)
    values = np.where(inside[:, None], found, np.nan).reshape(LEVELS, VERTICALS, len(QUANTITIES))
    mean, std = np.nanmean(values, axis=1), np.nanstd(values, axis=1)
    force, size = _section(frame, surface)
    return ResidualProfile(
        surface,
        levels,
        dict(zip(QUANTITIES, mean.T, strict=True)),
        dict(zip(QUANTITIES, std.T, strict=True)),
        force,
        size,
    )


def surface_heights(frame: Frame, x: Array) -> Array:
    """Height (mm) of the machined surface at ``x`` (k,): where a ray from the bottom upwards first leaves the body."""
    below = float(frame.points[:, 1].min()) - 1.0
    origins = np.column_stack([x, np.full(len(x), below)])
    edges = loop_edges(frame.loops)
    distance, _ = first_crossing(
        origins,
        np.tile([0.0, 1.0], (len(x), 1)),
        frame.points[edges[:, 0]],
        frame.points[edges[:, 1]],
        outward=True,
    )
    return origins[:, 1] + distance


def residual_figures(profile: ResidualProfile) -> dict[str, dict[str, float | str]]:
    """The figures of the summary that describe ``profile``; see :mod:`pfemcut.results.definitions`."""
    xx, depth = profile.mean["stress_xx"], profile.depth
    strain = profile.mean["plastic_strain"]
    low, high = int(np.argmin(xx)), int(np.argmax(xx))
    peak = float(np.abs(xx).max())

    def at_surface(name: str, unit: str) -> dict[str, float | str]:
        return {"mean": float(profile.mean[name][0]), "std": float(profile.std[name][0]), "unit": unit}

    def value(amount: float, unit: str) -> dict[str, float | str]:
        return {"value": amount, "unit": unit}

    return {
        "residual_surface_xx": at_surface("stress_xx", "MPa"),
        "residual_surface_zz": at_surface("stress_zz", "MPa"),
        "residual_surface_yy": at_surface("stress_yy", "MPa"),
        "residual_compression": value(float(xx[low]), "MPa"),
        "residual_compression_depth": value(float(depth[low]), "mm"),
        "residual_tension": value(float(xx[high]), "MPa"),
        "residual_tension_depth": value(float(depth[high]), "mm"),
        "residual_affected_depth": value(last_above(depth, np.abs(xx), AFFECTED_STRESS * peak), "mm"),
        "surface_plastic_strain": at_surface("plastic_strain", "-"),
        "deformed_depth": value(last_above(depth, strain, AFFECTED_STRAIN), "mm"),
        "residual_section_force": value(profile.section_force, "N/mm"),
        "residual_section_size": value(profile.section_size, "N/mm"),
        "residual_window_begin": value(profile.surface.begin, "mm"),
        "residual_window_end": value(profile.surface.end, "mm"),
        "residual_warmest": value(float(profile.mean["temperature"].max()), "K"),
    }


def last_above(depth: Array, values: Array, limit: float) -> float:
    """Depth (mm) below which ``values`` stay below ``limit``, linear between levels; the last depth if they do not."""
    above = np.flatnonzero(values >= limit)
    if not above.size:
        return 0.0
    at = int(above[-1])
    if at + 1 == len(depth):
        return float(depth[-1])
    part = (values[at] - limit) / (values[at] - values[at + 1])
    return float(depth[at] + part * (depth[at + 1] - depth[at]))


def _section(frame: Frame, surface: MachinedSurface) -> tuple[float, float]:
    """Mean over the window of the integral over the height of xx and of its size (N/mm), exact for the elements."""
    corners = frame.points[frame.cells]
    below = corners[:, :, 1].mean(axis=1) < surface.level + 0.5 * surface.depth
    part = _area_left_of(corners[below], surface.end) - _area_left_of(corners[below], surface.begin)
    xx = frame.cell_fields["cauchy_stress"][below, 0]
    length = surface.end - surface.begin
    return float(part @ xx) / length, float(part @ np.abs(xx)) / length


def _area_left_of(corners: Array, x: float) -> Array:
    """Area of each triangle (m, 3, 2) on the left of the vertical through ``x``; shape (m,)."""
    first, second, third = np.sort(corners[:, :, 0], axis=1).T
    area = triangle_areas(corners)
    width = np.maximum(third - first, 1e-300)
    rising = np.clip(x - first, 0.0, second - first) ** 2 / np.maximum((second - first) * width, 1e-300)
    falling = np.clip(third - x, 0.0, third - second) ** 2 / np.maximum((third - second) * width, 1e-300)
    share = np.where(x <= second, rising, 1.0 - falling)
    return area * np.where(x >= third, 1.0, np.where(x <= first, 0.0, share))
