"""Cuts by a rigid block of particles: forces, chip, shear band, segments and the particles' disorder.

The particles of the chip are those that began above the tool's lower edge and have been lifted by a twentieth of the
feed. All figures but the force are of the last frame:

- cutting force: power of the tool over its speed, mean and deviation over the second half of the time (N/mm);
- chip thickness: median distance of the particles of the former surface, where they are lifted by half a feed or more,
  to the second row above the tool's edge (the first is torn), plus the two spacings from these rows to the sides;
- shear band: the ridge of the strain rate, see :mod:`pfemcut.particles.measures`; its angle is taken from the cutting
  direction;
- segments: peaks of plastic strain along the middle of the chip, over where particles began, 2 h or more from the face
  that the tool hit, averaged over 0.04 mm, that stand out by a tenth of its mean; their number over that length gives
  the frequency;
- noise of plastic strain from particle to particle, and disorder and clusters: of the chip's particles that began 2 h
  away from its sides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from pfemcut.particles.measures import Regularity, bands, gridded, noise, peaks_along, regularity
from pfemcut.validation.clouds import Cloud, last_cloud
from pfemcut.validation.small_files import copy_picture
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, write_table

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

MELTING = 1573.0
"""K; printed in Table 3 of Islam et al. 2019."""
FEEDS = (0.3, 0.5)
REDUCED, FULL = 0.02, 0.01
"""Spacings (mm); the second is the paper's."""
_REACH = 0.24
"""mm; see :func:`pfemcut.particles.measures.bands`."""
_STEP = 0.04
"""mm, over which strain is averaged before segments are looked for: noise of single particles is none."""


def cuts(folder: Path, method: str) -> Study:
    """The study of the demo in ``folder``, whose case has this ``method``."""
    variants = [_variant(feed, spacing) for spacing in (REDUCED, FULL) for feed in FEEDS]
    if method == "esph":
        none, kernel = "particles.artificial_pressure=0.0", 'particles.contact="kernel"'
        variants += [_variant(0.3, spacing, "gamma_0", none) for spacing in (REDUCED, FULL)]
        variants += [_variant(feed, REDUCED, "kernel", kernel) for feed in FEEDS]
    else:
        literature = "body.0.material.hardening.melting_temperature=1793.0"
        variants.append(_variant(0.3, REDUCED, "melting_1793", literature))
    return Study(
        "cuts", folder, tuple(variants), partial(_conclude, method), None, folder / "case.toml", partial=True
    )


def _variant(feed: float, spacing: float, name: str = "", *changes: str) -> Variant:
    low = 1.0 - feed
    return Variant(
        f"feed_{feed:g}_{spacing:g}" + (f"_{name}" if name else ""),
        (
            f"body.1.box=[[3.0, {low}], [3.5, {low + 1.0}]]",
            f"particles.spacing={spacing}",
            "time.end=3.0e-5",
            f"body.0.material.hardening.melting_temperature={MELTING}",
            "particles.courant=0.5",
            *changes,
        ),
    )


@dataclass(frozen=True)
class Chip:
    """Figures of a chip (mm, degree, 1/s).

    Attributes
    ----------
    thickness
        Of the chip.
    band_width, band_angle
        Half width of the shear band, and its angle from the cutting direction.
    segments, segment_length
        Number of peaks of plastic strain, and their mean distance before the cut; nan with fewer than two.
    strain_mean, strain_spread
        Of plastic strain along the middle of the chip: mean, and standard deviation over it.
    strain_noise
        Of plastic strain from particle to particle, over its mean.
    regularity
        Of the particles inside of the chip.
    """

    thickness: float
    band_width: float
    band_angle: float
    segments: int
    segment_length: float
    strain_mean: float
    strain_spread: float
    strain_noise: float
    regularity: Regularity


def chip_of(cloud: Cloud, edge: float) -> Chip:
    """Figures of the chip above the tool's lower ``edge`` (mm)."""
    controls = cloud.problem.smoothing
    spacing, reach = controls.spacing, 2.0 * controls.smoothing_length
    x, y = cloud.start.T
    top, far = y.max() + 0.5 * spacing, x.max() + 0.5 * spacing
    feed, lifted = top - edge, cloud.points[:, 1] - y
    chip = (y > edge) & (lifted > 0.05 * feed)
    inside = chip & (y > edge + reach) & (y < top - reach) & (x < far - reach)
    surface = chip & (y > top - spacing) & (lifted > 0.5 * feed)
    rake_side = chip & (y > edge + spacing) & (y < edge + 2.0 * spacing)
    thickness = np.nan
    if surface.any() and rake_side.any():
        distance, _ = cKDTree(cloud.points[rake_side]).query(cloud.points[surface])
        thickness = float(np.median(distance)) + 2.0 * spacing
    rate = cloud.fields["equivalent_plastic_strain_rate"]
    # A few particles at the tool's edge flow many times faster than the band.
    grid = gridded(cloud.points, np.minimum(rate, np.quantile(rate[chip], 0.99)), spacing)
    band = bands(grid, 0.3 * float(np.nanmax(grid.values)), _REACH)
    middle = chip & (np.abs(y - 0.5 * (top + edge)) < 1.5 * spacing) & (x < far - reach)
    strain = cloud.fields["equivalent_plastic_strain"][middle]
    peaks = np.sort(peaks_along(x[middle], strain, _STEP, 0.1 * float(strain.mean())))
    return Chip(
        thickness=thickness,
        band_width=band.width,
        band_angle=180.0 - band.angles[0] if band.angles else np.nan,
        segments=len(peaks),
        segment_length=float(np.diff(peaks).mean()) if len(peaks) > 1 else np.nan,
        strain_mean=float(strain.mean()),
        strain_spread=float(strain.std() / strain.mean()),
        strain_noise=noise(cloud.points, cloud.fields["equivalent_plastic_strain"], 0.5 * reach, inside),
        regularity=regularity(cloud.points, spacing, controls.smoothing_length, inside),
    )


def tool_force(history: Mapping[str, Array], speed: float) -> tuple[Array, Array]:
    """Middle times (s) of the batches, and the force (N/mm) on the tool in the cutting direction from its work."""
    time, work = history["time"], history["hold_work"]
    return 0.5 * (time[1:] + time[:-1]), np.diff(work) / (np.diff(time) * speed)


_HEADER = (
    "run",
    "feed",
    "spacing",
    "particles",
    "time",
    "cutting_force",
    "cutting_force_std",
    "chip_thickness",
    "band_width",
    "band_angle",
    "segments",
    "segment_length",
    "segment_frequency",
    "strain_mean",
    "strain_spread",
    "strain_noise",
    "max_temperature",
    "nearest_mean",
    "nearest_variation",
    "clustered",
    "unevenness",
    "energy_error",
    "wall_time",
)


def _conclude(method: str, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    clouds = [last_cloud(outcome.directory) for outcome in outcomes]
    rows = [_row(outcome, cloud) for outcome, cloud in zip(outcomes, clouds, strict=True)]
    write_table(results / "cuts.csv", f"Cuts with {method.upper()}", _HEADER, rows)
    for outcome, cloud in zip(outcomes, clouds, strict=True):
        _draw(method, outcome.variant.name, cloud, results / f"{outcome.variant.name}.png")
    _draw_forces(method, outcomes, clouds, results / "forces.png")
    content = {"cuts": finite_figures(_HEADER, rows), "melting_temperature": MELTING}
    return content, all(outcome.summary["finished"] for outcome in outcomes)


def _edge(cloud: Cloud) -> float:
    """Height of the tool's lower edge (mm)."""
    return float(cloud.others[:, 1].min()) - 0.5 * cloud.problem.smoothing.spacing


def _speed(cloud: Cloud) -> float:
    return float(-cloud.problem.bodies[1].velocity[0])


def _row(outcome: Outcome, cloud: Cloud) -> list[str | float]:
    edge, speed = _edge(cloud), _speed(cloud)
    time, force = tool_force(outcome.history, speed)
    late = force[time > 0.5 * cloud.time]
    chip = chip_of(cloud, edge)
    last = {name: float(column[-1]) for name, column in outcome.history.items()}
    return [
        outcome.variant.name,
        float(cloud.start[:, 1].max() + 0.5 * cloud.problem.smoothing.spacing - edge),
        cloud.problem.smoothing.spacing,
        last["nodes"],
        cloud.time,
        float(late.mean()),
        float(late.std()),
        chip.thickness,
        chip.band_width,
        chip.band_angle,
        float(chip.segments),
        chip.segment_length,
        speed / chip.segment_length,
        chip.strain_mean,
        chip.strain_spread,
        chip.strain_noise,
        last["max_temperature"],
        chip.regularity.mean,
        chip.regularity.variation,
        chip.regularity.clustered,
        chip.regularity.unevenness,
        last["energy_error"],
        float(outcome.summary["wall_time"]["value"]),
    ]


def _draw(method: str, name: str, cloud: Cloud, path: Path) -> None:
    """Particles by plastic strain and by temperature, near the chip."""
    fields = {"equivalent_plastic_strain": "plastic strain", "temperature": "temperature (K)"}
    low, high = cloud.others[:, 0].min() - 1.2, cloud.others[:, 0].min() + 0.6
    figure, axes = plt.subplots(1, 2, figsize=(12.0, 6.0), layout="constrained")
    size = (72.0 * 5.8 * cloud.problem.smoothing.spacing / 1.8) ** 2
    for at, (field, label) in zip(axes, fields.items(), strict=True):
        values = cloud.fields[field]
        limit = float(np.quantile(values[values > values.min()], 0.98))
        drawn = at.scatter(
            *cloud.points.T, c=values, s=size, marker="s", linewidths=0.0, vmax=limit, cmap="turbo"
        )
        at.scatter(*cloud.others.T, color="0.8", s=size, marker="s", linewidths=0.0)
        figure.colorbar(drawn, ax=at, label=label, location="bottom", shrink=0.8)
        at.set(aspect="equal", xlim=(low, high), xlabel="x (mm)", ylabel="y (mm)")
    figure.suptitle(f"{method.upper()}, {_words(name)}, {cloud.time * 1e6:.0f} µs")
    figure.savefig(path, dpi=80)
    plt.close(figure)
    copy_picture(path, path)


def _words(name: str) -> str:
    """A variant's name with units: feed, spacing and what else differs."""
    _, feed, spacing, *others = name.split("_")
    return f"feed {feed} mm, spacing {spacing} mm" + (f", {' '.join(others)}" if others else "")


def _draw_forces(method: str, outcomes: Sequence[Outcome], clouds: Sequence[Cloud], path: Path) -> None:
    figure, at = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
    for outcome, cloud in zip(outcomes, clouds, strict=True):
        time, force = tool_force(outcome.history, _speed(cloud))
        at.plot(time * 1e6, force, linewidth=0.9, label=_words(outcome.variant.name))
    at.set(xlabel="time (µs)", ylabel="cutting force (N/mm)", title=method.upper())
    at.legend(fontsize="small")
    at.grid(alpha=0.3)
    figure.savefig(path, dpi=90)
    plt.close(figure)
