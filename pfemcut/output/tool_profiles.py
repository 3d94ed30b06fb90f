"""``tool_profiles.csv``: the loads of the tool's surface, averaged over the steady window (docs/tool_profiles.md).

Everything is rebuilt from the output directory, so a resumed run and one without a break give the same table, and so
does ``pfemcut report``.
"""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pfemcut.output.directory import CONTACT, HISTORY, INPUTS, PROFILES, writing
from pfemcut.output.vtu import TOOL_PART, Entry, FieldsError, read_collection, read_frame
from pfemcut.results.contact_table import read_contact
from pfemcut.results.derived.steady_window import SteadyWindow, steady_window
from pfemcut.results.derived.tool_profiles import ToolLoads, ToolProfiles, averaged_profiles, tool_loads
from pfemcut.results.history import as_text, read_table
from pfemcut.tools.rigid_wedge import RigidWedge
from pfemcut.wear.load import wear_of
from pfemcut.wear.usui import UsuiWear
from pfemcut.whole_files import write_text

Array = NDArray[np.float64]

_TOLERANCE = 1e-9  # mm of travel, with which the window's borders belong to it


@dataclass(frozen=True)
class CutInputs:
    """What the profiles need of ``inputs.resolved.toml``.

    Attributes
    ----------
    tool
        The tool, at the origin.
    speed, depth
        Cutting speed (mm/s) and depth of cut (mm).
    deformable
        Whether the tool is a meshed body.
    conducts
        Whether the tool takes heat through the interface, and warms.
    wear
        Law of the wear rate, or none.
    """

    tool: RigidWedge
    speed: float
    depth: float
    deformable: bool
    conducts: bool
    wear: tuple[UsuiWear, ...]


@dataclass(frozen=True)
class CutProfiles:
    """Profiles of a run, what they were made with, and the travel (mm) of the first and last instant."""

    profiles: ToolProfiles
    inputs: CutInputs
    travel: tuple[float, float]


@dataclass(frozen=True)
class _Instants:
    """Travel (mm) and loads of instants in the window, of which there may be none."""

    travel: list[float]
    loads: list[ToolLoads]


def cut_profiles(directory: Path, wear: tuple[UsuiWear, ...] = ()) -> tuple[CutProfiles, ...]:
    """Profiles of the run in ``directory``; none unless it is a cut that has had contact.

    ``wear`` replaces the case's law of the wear rate.

    They come from the records of ``contact.csv`` in the steady window; where these don't cover it (runs of older
    versions), from the frames of the fields in the window, or else from the last frame.

    Raises
    ------
    pfemcut.results.history.HistoryError
        If a table is damaged.
    """
    if not (directory / HISTORY).exists() or not (directory / INPUTS).exists():
        return ()
    history = read_table(directory / HISTORY)
    case = tomllib.loads((directory / INPUTS).read_text(encoding="utf-8"))
    if not history or not history["step"].size:
        return ()
    window = steady_window(history["travel"], history["cutting_force"])
    for inputs in cut_inputs(case):
        inputs = replace(inputs, wear=wear or inputs.wear)
        found = _recorded(directory, history, window)
        if not found.loads:
            found = _of_frames(directory, history, window, inputs)
        if not any(each.pressure.any() for each in found.loads):
            return ()
        loads = found.loads if inputs.conducts else [_without_tool_temperature(each) for each in found.loads]
        profiles = averaged_profiles(loads, inputs.tool, inputs.depth, inputs.wear)
        return (CutProfiles(profiles, inputs, (found.travel[0], found.travel[-1])),)
    return ()


def cut_inputs(case: Mapping[str, Any]) -> tuple[CutInputs, ...]:
    """What the profiles need of a resolved case; none unless it is a cut."""
    cutting, tool = case.get("cutting", {}), case.get("tool", {})
    if not {"speed", "depth"} <= set(cutting) or not {"rake", "clearance", "tip_radius"} <= set(tool):
        return ()
    conductance = case.get("contact", {}).get("conductance", 0.0)
    if isinstance(conductance, Mapping):
        conductance = conductance["value"]
    return (
        CutInputs(
            tool=RigidWedge((0.0, 0.0), tool["rake"], tool["clearance"], tool["tip_radius"]),
            speed=cutting["speed"],
            depth=cutting["depth"],
            deformable="body" in tool,
            conducts=conductance > 0.0 and ("conduction" in tool or "body" in tool),
            wear=(wear_of(tool["wear"]),) if "wear" in tool else (),
        ),
    )


def write_table(directory: Path, profiles: ToolProfiles) -> Path:
    """Write ``tool_profiles.csv``, at once; its path."""
    columns = table_of(profiles)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    path = directory / PROFILES
    with writing(directory):
        write_text(path, text.getvalue())
    return path


def table_of(profiles: ToolProfiles) -> dict[str, list[str]]:
    """Columns of ``tool_profiles.csv`` as text, in order."""
    stations = profiles.stations
    columns = {
        "position": _texts(stations.position),
        "length": _texts(stations.length),
        "part": list(stations.parts),
        "contact": _texts(profiles.contact),
    }
    for name, averaged in profiles.quantities.items():
        columns[name] = _texts(averaged.mean)
        columns[f"{name}_std"] = _texts(averaged.std)
        if name == "shear":
            columns["friction"] = _texts(profiles.friction())
    return columns


def _recorded(directory: Path, history: Mapping[str, Array], window: SteadyWindow) -> _Instants:
    steps, loads = read_contact(directory / CONTACT)
    travel = np.interp(steps, history["step"], history["travel"])
    inside = np.flatnonzero(_inside(travel, window))
    if not inside.size or travel[inside[0]] > 0.5 * (window.begin + window.end):
        # An older version's run that was taken further has records of its end alone.
        return _Instants([], [])
    return _Instants([float(travel[i]) for i in inside], [loads[i] for i in inside])


def _of_frames(
    directory: Path, history: Mapping[str, Array], window: SteadyWindow, inputs: CutInputs
) -> _Instants:
    """Loads of the frames in the window, or of the last one; a frame that can't be read is left out."""
    steps: dict[int, list[Entry]] = {}
    # None of a tool that has withdrawn.
    last = history["step"][np.argmax(history["travel"] >= history["travel"][-1] - _TOLERANCE)]
    for entry in read_collection(directory):
        if entry.step > last:
            continue
        steps.setdefault(entry.step, []).append(entry)
    with_tool = [step for step in sorted(steps) if any(each.part == TOOL_PART for each in steps[step])]
    travel = np.interp(with_tool, history["step"], history["travel"])
    found = _Instants([], [])
    chosen = np.flatnonzero(_inside(travel, window))
    for at in chosen if chosen.size else range(len(with_tool))[-1:]:
        try:
            frame = read_frame(directory, steps[with_tool[at]])
        except FieldsError:
            continue
        row = np.flatnonzero(history["step"] == with_tool[at])
        step = 0.0 if inputs.deformable or not row.size or "dt" not in history else history["dt"][row[0]]
        found.travel.append(float(travel[at]))
        found.loads.append(tool_loads(frame, (-inputs.speed, 0.0), float(step)))
    return found


def _inside(travel: Array, window: SteadyWindow) -> NDArray[np.bool_]:
    return (travel >= window.begin - _TOLERANCE) & (travel <= window.end + _TOLERANCE)


def _without_tool_temperature(loads: ToolLoads) -> ToolLoads:
    """Of a tool that takes no heat: its temperature says nothing of the interface's."""
    return replace(loads, tool_temperature=np.full_like(loads.arc, np.nan))


def _texts(values: Array) -> list[str]:
    return [as_text(value) for value in values]
