"""The ladder of spacings of a Taylor bar: final length and diameter, with corrected and with plain kernel gradients.

A bar of a square lattice has no round edge, so its diameter depends on how it is measured. Three measures are given:
from surface to surface (the extent of the particles plus one spacing, as in the history), from centre to centre, and
the nominal diameter times the stretch of the outermost particle's radius, which is exact at the start.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from pfemcut.case.load import load_case, solid
from pfemcut.case.particles import Cylinder, SolidsCase
from pfemcut.output.directory import INPUTS
from pfemcut.particles.measures import Regularity, regularity
from pfemcut.validation.clouds import Cloud, last_cloud
from pfemcut.validation.small_files import copy_picture
from pfemcut.validation.study import Outcome, Study, Variant, finite_figures, write_table

Array = NDArray[np.float64]

SPACINGS = (0.63, 0.5, 0.4, 0.33)
PAPERS_MELTING = 1293.0
"""K; printed in Table 1 of Islam et al. 2019."""
REFERENCES = {"experiment": (34.6, 9.5), "LS-DYNA": (34.4, 10.6)}
"""Final length and mushroom diameter (mm): House et al. 1995, Batra and Zhang 2008, both as cited by Islam et al."""
PAPER = {"esph": (34.19, 9.80), "tlsph": (34.18, 9.83)}
"""The same of Islam et al. 2019, section 3.1, at a spacing of 0.5 mm."""

_HEADER = (
    "run",
    "spacing",
    "corrected",
    "melting_temperature",
    "particles",
    "time_steps",
    "length",
    "length_centres",
    "diameter",
    "diameter_centres",
    "diameter_stretched",
    "max_eqps",
    "max_temperature",
    "unevenness",
    "energy_error",
    "wall_time",
)


@dataclass(frozen=True)
class Bar:
    """A bar's size from the positions of its particles (mm).

    Attributes
    ----------
    length, diameter
        Extent of the particles plus one spacing.
    length_centres, diameter_centres
        Extent of the particles.
    diameter_stretched
        Nominal diameter times largest distance from the axis over that at the start.
    """

    length: float
    length_centres: float
    diameter: float
    diameter_centres: float
    diameter_stretched: float


def measured(start: Array, points: Array, radius: float, spacing: float) -> Bar:
    """The bar along z whose particles began at ``start`` (n, 3) and are at ``points`` (n, 3) now.

    Parameters
    ----------
    radius, spacing
        Nominal radius and spacing of the particles (mm).
    """
    far, first = (2.0 * float(np.hypot(each[:, 0], each[:, 1]).max()) for each in (points, start))
    length = float(np.ptp(points[:, 2]))
    return Bar(length + spacing, length, far + spacing, far, 2.0 * radius * far / first)


def ladder(folder: Path, method: str) -> Study:
    """The study of the demo in ``folder``, whose case has this ``method``."""
    variants = [_variant(spacing, corrected, ()) for spacing in SPACINGS for corrected in (True, False)]
    melting = (f"body.0.material.hardening.melting_temperature={PAPERS_MELTING}",)
    variants += [_variant(0.5, corrected, melting) for corrected in (True, False)]
    conclude = partial(_conclude, method)
    return Study(
        "ladder", folder, tuple(variants), conclude, travel=None, case=folder / "case.toml", partial=True
    )


def _variant(spacing: float, corrected: bool, changes: tuple[str, ...]) -> Variant:
    name = f"{'corrected' if corrected else 'plain'}_{spacing:g}"
    if changes:
        name += f"_melting_{PAPERS_MELTING:g}"
    return Variant(
        name, (f"particles.spacing={spacing}", f"particles.corrected={str(corrected).lower()}", *changes)
    )


def _conclude(method: str, outcomes: Sequence[Outcome], results: Path) -> tuple[dict[str, Any], bool]:
    clouds = [last_cloud(outcome.directory) for outcome in outcomes]
    rows = [_row(outcome, cloud) for outcome, cloud in zip(outcomes, clouds, strict=True)]
    write_table(results / "ladder.csv", f"Taylor bar, {method}", _HEADER, rows)
    _draw_ladder(method, rows, results / "ladder.png")
    names = [outcome.variant.name for outcome in outcomes]
    finest = max(range(len(names)), key=lambda k: ("plain" not in names[k], len(clouds[k].points)))
    _draw_bar(method, names[finest], clouds[finest], results / "bar.png")
    content = {
        "bars": finite_figures(_HEADER, rows),
        "published": {
            name: {"final_length": length, "mushroom_diameter": diameter}
            for name, (length, diameter) in {**REFERENCES, "paper": PAPER[method]}.items()
        },
        "picture": names[finest],
    }
    return content, all(outcome.summary["finished"] for outcome in outcomes)


def _row(outcome: Outcome, cloud: Cloud) -> list[str | float]:
    case, material = load_case(outcome.directory / INPUTS)
    assert isinstance(case, SolidsCase)
    shape = case.body[0].cylinder
    assert isinstance(shape, Cylinder)
    spacing = case.particles.spacing
    bar = measured(cloud.start, cloud.points, shape.radius, spacing)
    last = {name: float(column[-1]) for name, column in outcome.history.items()}
    return [
        outcome.variant.name,
        spacing,
        "yes" if case.particles.corrected else "no",
        float(getattr(solid(material).hardening, "melting_temperature", np.nan)),
        last["nodes"],
        last["time_steps"],
        bar.length,
        bar.length_centres,
        bar.diameter,
        bar.diameter_centres,
        bar.diameter_stretched,
        last["max_eqps"],
        last["max_temperature"],
        regularity_inside(cloud, shape).unevenness,
        last["energy_error"],
        float(outcome.summary["wall_time"]["value"]),
    ]


def regularity_inside(cloud: Cloud, shape: Cylinder) -> Regularity:
    """How regular the particles lie that began 2 h or more inside of the lower fifth of the bar, its mushroom."""
    controls = cloud.problem.smoothing
    reach = 2.0 * controls.smoothing_length
    inside = np.hypot(cloud.start[:, 0], cloud.start[:, 1]) < shape.radius - reach
    inside &= (cloud.start[:, 2] > reach) & (cloud.start[:, 2] < 0.2 * shape.length)
    return regularity(cloud.points, controls.spacing, controls.smoothing_length, inside)


def _draw_ladder(method: str, rows: Sequence[Sequence[str | float]], path: Path) -> None:
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 4.0), layout="constrained")
    table = [dict(zip(_HEADER, row, strict=True)) for row in rows]
    columns = (("length",), ("diameter", "diameter_centres", "diameter_stretched"))
    for at, names, reference in zip(axes, columns, (0, 1), strict=True):
        for corrected, colour in (("yes", "tab:blue"), ("no", "tab:red")):
            chosen = [
                row for row in table if row["corrected"] == corrected and "melting" not in str(row["run"])
            ]
            for name, style in zip(names, ("o-", "v:", "s--"), strict=False):
                label = f"{'corrected' if corrected == 'yes' else 'plain'}, {name.replace('_', ', ')}"
                x, y = [row["spacing"] for row in chosen], [row[name] for row in chosen]
                at.plot(x, y, style, color=colour, label=label, markersize=4.0)
        lines = {**REFERENCES, "paper": PAPER[method]}
        for (name, values), grey in zip(lines.items(), ("black", "0.4", "0.65"), strict=True):
            at.axhline(values[reference], color=grey, linewidth=1.0, label=name)
        at.set(
            xlabel="spacing (mm)", ylabel="final length (mm)" if reference == 0 else "mushroom diameter (mm)"
        )
        at.grid(alpha=0.3)
    # Lengths, from surface to surface, have the lines of the diameters that are measured so.
    handles, labels = axes[1].get_legend_handles_labels()
    labels = [
        label.replace(", diameter", "", 1) + ", surfaces" * label.endswith("diameter") for label in labels
    ]
    figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize="x-small")
    figure.suptitle(f"Taylor bar, {method.upper()}")
    figure.savefig(path, dpi=90)
    plt.close(figure)


def _draw_bar(method: str, name: str, cloud: Cloud, path: Path) -> None:
    """The particles that began nearest the plane y = 0, coloured by plastic strain and by temperature."""
    spacing = cloud.problem.smoothing.spacing
    section = np.abs(cloud.start[:, 1] - 0.5 * spacing) < 0.1 * spacing
    fields = {"equivalent_plastic_strain": "plastic strain", "temperature": "temperature (K)"}
    figure, axes = plt.subplots(2, 1, figsize=(9.0, 5.4), layout="constrained")
    for at, (field, label) in zip(axes, fields.items(), strict=True):
        values = cloud.fields[field][section]
        x, z = cloud.points[section, 0], cloud.points[section, 2]
        drawn = at.scatter(
            z, x, c=values, s=(72.0 * spacing * 0.24) ** 2, marker="s", linewidths=0.0, cmap="turbo"
        )
        figure.colorbar(drawn, ax=at, label=label, shrink=0.8)
        at.set(aspect="equal", xlabel="z (mm)", ylabel="x (mm)")
    kind = "plain" if "plain" in name else "corrected"
    figure.suptitle(f"{method.upper()}, spacing {spacing:g} mm, {kind} gradients, {cloud.time * 1e6:.0f} µs")
    figure.savefig(path, dpi=90)
    plt.close(figure)
    copy_picture(path, path)
