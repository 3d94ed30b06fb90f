"""Pressing of a block of particles: shear bands against the spacing.

Of the last frame, the layer of particles that began nearest the middle of the thickness is looked at in the plane of
the other two axes, there where it began 0.1 mm or more away from the hold and 0.2 mm or more from the tool, at which
there is a layer of large strain: the same region with every spacing. Bands are ridges of the rate of plastic strain
(see :mod:`pfemcut.particles.measures`), its mean over the last quarter of the time, as waves run through the block;
they stand out by a quarter of the field's 95th percentile, above which the field is cut off. Bands of plastic strain
itself are given beside them. ``gradient`` is the mean of the strain's gradient over the mean strain (1/mm): it grows as
bands become sharper.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from pfemcut.particles.measures import Bands, Grid, bands, gridded, regularity
from pfemcut.validation.clouds import Cloud, cloud_at, last_cloud
from pfemcut.validation.small_files import copy_picture
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, write_table

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

MELTING = 1573.0
"""K; printed in Table 3 of Islam et al. 2019."""
COURANT = "particles.courant=0.5"
SPACINGS = (0.02, 0.0133, 0.01, 0.00667)
FROM_HOLD, FROM_TOOL = 0.1, 0.2
"""mm at the start: what is nearer is not looked at."""
_RATE_SINCE = 0.75
"""Of the time."""
_REACH = 0.24
"""mm; see :func:`pfemcut.particles.measures.bands`."""


def pressings(folder: Path, method: str) -> Study:
    """The study of the demo in ``folder``, whose case has this ``method``."""
    melting = f"body.0.material.hardening.melting_temperature={MELTING}"
    variants = tuple(
        Variant(f"spacing_{spacing:g}", (f"particles.spacing={spacing}", COURANT, melting))
        for spacing in SPACINGS
    )
    return Study(
        "bands", folder, variants, partial(_conclude, method), None, folder / "case.toml", partial=True
    )


_FIELDS = {"rate": "mean_rate", "strain": "equivalent_plastic_strain"}
_HEADER = (
    "run",
    "spacing",
    "particles",
    "time_steps",
    *(f"{name}_{part}" for name in _FIELDS for part in ("band_width", "contrast", "angles")),
    "gradient",
    "strain_left",
    "strain_middle",
    "strain_right",
    "max_temperature",
    "nearest_variation",
    "unevenness",
    "energy_error",
    "wall_time",
)


def middle_layer(cloud: Cloud) -> BoolArray:
    """Particles that began in the layer nearest the middle of the thickness; shape (n,)."""
    away = np.abs(cloud.start[:, 2] - 0.5 * (cloud.start[:, 2].min() + cloud.start[:, 2].max()))
    return np.asarray(away < away.min() + 1e-3 * cloud.problem.smoothing.spacing)


def found_bands(cloud: Cloud, name: str) -> tuple[Bands, Grid]:
    """Bands of a field in the middle layer, and the field on its grid."""
    controls = cloud.problem.smoothing
    x = cloud.start[:, 0]
    chosen = middle_layer(cloud) & (x > x.min() + FROM_HOLD) & (x < x.max() - FROM_TOOL)
    values = cloud.fields[name]
    limit = float(np.quantile(values[chosen], 0.95))
    grid = gridded(cloud.points[chosen, :2], np.minimum(values[chosen], limit), controls.spacing)
    return bands(grid, 0.25 * limit, _REACH), grid


def pressed(directory: Path) -> Cloud:
    """The last frame of a run, with the field ``mean_rate`` of plastic strain over the last quarter of the time."""
    last = last_cloud(directory)
    before = cloud_at(directory, _RATE_SINCE * last.time)
    name = "equivalent_plastic_strain"
    rate = (last.fields[name] - before.fields[name]) / (last.time - before.time)
    return replace(last, fields={**last.fields, "mean_rate": rate})


def sharpness(grid: Grid) -> float:
    """Mean length of a field's gradient over its mean (1/mm)."""
    gradient = np.linalg.norm(np.gradient(grid.values, grid.step), axis=0)
    return float(np.nanmean(gradient) / np.nanmean(grid.values))


def _conclude(method: str, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    clouds = [pressed(outcome.directory) for outcome in outcomes]
    rows = [_row(outcome, cloud) for outcome, cloud in zip(outcomes, clouds, strict=True)]
    write_table(results / "bands.csv", f"Pressing with {method.upper()}", _HEADER, rows)
    _draw(method, clouds, results / "bands.png")
    _draw_along(method, clouds, results / "strain.png")
    content = {"pressings": finite_figures(_HEADER, rows), "melting_temperature": MELTING}
    return content, all(outcome.summary["finished"] for outcome in outcomes)


def _row(outcome: Outcome, cloud: Cloud) -> list[str | float]:
    controls = cloud.problem.smoothing
    last = {name: float(column[-1]) for name, column in outcome.history.items()}
    found: list[str | float] = []
    for name in _FIELDS.values():
        band, grid = found_bands(cloud, name)
        found += [band.width, band.contrast, " ".join(f"{angle:.0f}" for angle in band.angles)]
    thirds = along(cloud, 3)
    reach = 2.0 * controls.smoothing_length
    x, y = cloud.start[:, 0], cloud.start[:, 1]
    inside = middle_layer(cloud) & (x > reach) & (x < x.max() - reach) & (y > reach) & (y < y.max() - reach)
    regular = regularity(cloud.points, controls.spacing, controls.smoothing_length, inside)
    return [
        outcome.variant.name,
        controls.spacing,
        last["nodes"],
        last["time_steps"],
        *found,
        sharpness(grid),
        *(float(value) for value in thirds),
        last["max_temperature"],
        regular.variation,
        regular.unevenness,
        last["energy_error"],
        float(outcome.summary["wall_time"]["value"]),
    ]


def along(cloud: Cloud, parts: int) -> Array:
    """Mean plastic strain of equal ``parts`` of the block from the hold to the tool, by where particles began."""
    x = cloud.start[:, 0]
    strain = cloud.fields["equivalent_plastic_strain"]
    part = np.minimum((x / (x.max() + x.min()) * parts).astype(int), parts - 1)
    return np.bincount(part, strain, minlength=parts) / np.bincount(part, minlength=parts)


def _draw(method: str, clouds: Sequence[Cloud], path: Path) -> None:
    """The middle layer of each run, by plastic strain and by its rate."""
    figure, axes = plt.subplots(
        2, len(clouds), figsize=(3.6 * len(clouds), 6.0), layout="constrained", squeeze=False
    )
    labels = {"strain": "plastic strain", "rate": "its mean rate (1/s)"}
    for row, (name, label) in zip(axes, labels.items(), strict=True):
        for at, cloud in zip(row, clouds, strict=True):
            chosen = middle_layer(cloud)
            values = cloud.fields[_FIELDS[name]][chosen]
            size = (72.0 * 2.9 * cloud.problem.smoothing.spacing / 0.95) ** 2
            drawn = at.scatter(
                *cloud.points[chosen, :2].T,
                c=values,
                s=size,
                marker="s",
                linewidths=0.0,
                vmax=float(np.quantile(values, 0.95)),
                cmap="turbo",
            )
            figure.colorbar(drawn, ax=at, label=label, location="bottom", shrink=0.8)
            at.set(aspect="equal", title=f"{cloud.problem.smoothing.spacing:g} mm")
    figure.suptitle(f"{method.upper()}, {clouds[-1].time * 1e6:.1f} µs")
    figure.savefig(path, dpi=90)
    plt.close(figure)
    copy_picture(path, path)


def _draw_along(method: str, clouds: Sequence[Cloud], path: Path) -> None:
    figure, at = plt.subplots(figsize=(6.5, 4.0), layout="constrained")
    for cloud in clouds:
        place = (np.arange(25) + 0.5) / 25
        at.plot(place, along(cloud, 25), label=f"{cloud.problem.smoothing.spacing:g} mm")
    at.set(
        xlabel="place at the start, from the hold (mm)",
        ylabel="mean plastic strain",
        ylim=(0.0, 1.0),
        title=method.upper(),
    )
    at.legend(fontsize="small", title="spacing")
    at.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)
