"""Figures of the summary that come from the profiles along the tool: their resultant force, and wear rates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pfemcut.results.derived.tool_profiles import EDGE, FLANK, RAKE, ToolProfiles

Array = NDArray[np.float64]
Figure = dict[str, float | str]


def profile_figures(profiles: ToolProfiles) -> dict[str, Figure]:
    """Figures by name, each with mean, standard deviation over the instants, and unit; wear rates if there are any."""
    figures = {
        "profile_cutting_force": _figure(profiles.forces[:, 0], "N/mm"),
        "profile_thrust_force": _figure(profiles.forces[:, 1], "N/mm"),
    }
    if "wear_rate" not in profiles.quantities:
        return figures
    stations, wear = profiles.stations, profiles.quantities["wear_rate"]
    for name, part in (("crater_wear_rate", RAKE), ("edge_wear_rate", EDGE)):
        at = np.flatnonzero(stations.on(part))
        if at.size and wear.mean[at].max() > 0.0:
            worst = at[np.argmax(wear.mean[at])]
            figures[name] = _figure(wear.samples[:, worst], "mm/s")
            if part == RAKE:
                figures["crater_wear_position"] = {"value": float(stations.position[worst]), "unit": "mm"}
    flank = stations.on(FLANK)
    if flank.any():
        length = stations.length[flank]
        figures["flank_wear_rate"] = _figure(wear.samples[:, flank] @ length / length.sum(), "mm/s")
    return figures


def _figure(samples: Array, unit: str) -> Figure:
    return {"mean": float(samples.mean()), "std": float(samples.std()), "unit": unit}
