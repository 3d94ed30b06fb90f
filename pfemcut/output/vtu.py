"""Fields for ParaView: ``fields.pvd`` and, in the folder ``fields``, one VTU a frame for the body and one for the tool.

The mesh changes every frame. The collection file is rewritten and renamed with each frame, so a killed run leaves one
that opens. A frame is written completely enough to be read back (:func:`read_last_frame`), so reports and pictures
can be made from the output directory alone.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as Xml
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from meshing.initial import MeshFileError, read_quietly
from pfemcut.inputs import UserError
from pfemcut.method import Block, ContactView, Frame, IntArray
from pfemcut.tools.rigid_wedge import RigidWedge
from pfemcut.whole_files import replacing

Array = NDArray[np.float64]

COLLECTION = "fields.pvd"
FOLDER = "fields"
TOOL_LENGTH = 2.0
"""Length (mm) of the drawn faces of a tool."""

BODY_PART, TOOL_PART = 0, 1
_NAMES = {BODY_PART: "workpiece", TOOL_PART: "tool"}
TENSOR = ("xx", "yy", "zz", "xy")
_GEOMETRY = ("travel", "rake", "clearance", "tip_radius", "centre_x", "centre_y", "body")
_CONTACT = ("contact_pressure", "contact_shear", "in_contact")


_LONGEST = 200  # characters of what a reader says of a damaged file


class FieldsError(UserError):
    """Fields that can't be read back; the message says why."""


@dataclass(frozen=True)
class Entry:
    """One file of the collection: step, time (s), part and path relative to the collection."""

    step: int
    time: float
    part: int
    file: str


class FieldWriter:
    """Writes frames into an output directory.

    Parameters
    ----------
    directory
        The output directory.
    last_step
        Frames after this step are dropped from the collection (resume); -1 drops all (fresh start).
    """

    def __init__(self, directory: Path, last_step: int = -1) -> None:
        self._directory = directory
        (directory / FOLDER).mkdir(exist_ok=True)
        entries = read_collection(directory)
        self._entries = [entry for entry in entries if entry.step <= last_step]
        for entry in entries:
            if entry.step > last_step:
                (directory / entry.file).unlink(missing_ok=True)
        if entries:
            write_collection(directory, self._entries)

    def write(self, frame: Frame) -> None:
        """Write one frame; a frame of the same step is replaced."""
        self._entries = [entry for entry in self._entries if entry.step != frame.step]
        body = f"{FOLDER}/frame_{frame.step:08d}.vtu"
        _write_atomically(self._directory / body, body_mesh(frame))
        self._entries.append(Entry(frame.step, frame.time, BODY_PART, body))
        if frame.tool:
            tool = f"{FOLDER}/tool_{frame.step:08d}.vtu"
            _write_atomically(
                self._directory / tool, tool_mesh(frame.tool[0], frame.travel, frame.tool_blocks)
            )
            self._entries.append(Entry(frame.step, frame.time, TOOL_PART, tool))
        for part, block in enumerate(frame.others, TOOL_PART + 1):
            name = f"{FOLDER}/body{part}_{frame.step:08d}.vtu"
            _write_atomically(self._directory / name, other_mesh(block, part))
            self._entries.append(Entry(frame.step, frame.time, part, name))
        write_collection(self._directory, self._entries)


def body_mesh(frame: Frame) -> meshio.Mesh:
    """Return the body of a frame as a mesh; vectors and the stress tensor get their third dimension.

    The stress has the six components xx, yy, zz, xy, yz, xz that ParaView knows as a symmetric tensor.
    """
    count = frame.points.shape[0]
    point_data = {name: _padded(np.asarray(values)) for name, values in frame.point_fields.items()}
    contact = frame.contact
    values = (contact.pressure, contact.shear, np.ones(contact.particles.size))
    for name, value in zip(_CONTACT, values, strict=True):
        point_data[name] = np.zeros(count)
        point_data[name][contact.particles] = value
    if frame.cells.shape[0] == 0:
        # A meshless method: ParaView shows particles that are cells of one point.
        vertices = np.arange(count)[:, None]
        body = {"body": [np.full(count, BODY_PART, dtype=np.int32)]}
        return meshio.Mesh(_padded(frame.points), [("vertex", vertices)], point_data, body)
    cell_data = {name: [_padded(values)] for name, values in frame.cell_fields.items()}
    cell_data["body"] = [np.full(frame.cells.shape[0], BODY_PART, dtype=np.int32)]
    return meshio.Mesh(_padded(frame.points), [("triangle", frame.cells)], point_data, cell_data)


def tool_mesh(tool: RigidWedge, travel: float, blocks: tuple[Block, ...] = ()) -> meshio.Mesh:
    """Return a tool as a mesh that carries its geometry as constant cell data: its block, or else its outline."""
    points = tool.outline(TOOL_LENGTH)
    cells = np.column_stack([np.arange(len(points) - 1), np.arange(1, len(points))])
    kind, fields, cell_fields = "line", {}, {}
    for block in blocks:
        points, cells, kind = block.points, block.cells, "triangle"
        fields = {name: _padded(np.asarray(values)) for name, values in block.point_fields.items()}
        cell_fields = {name: [_padded(values)] for name, values in block.cell_fields.items()}
    constants = {
        "travel": travel,
        "rake": tool.rake,
        "clearance": tool.clearance,
        "tip_radius": tool.tip_radius,
        "centre_x": tool.centre[0],
        "centre_y": tool.centre[1],
    }
    cell_data = {name: [np.full(len(cells), value)] for name, value in constants.items()}
    cell_data["body"] = [np.full(len(cells), TOOL_PART, dtype=np.int32)]
    return meshio.Mesh(_padded(points), [(kind, cells)], fields, {**cell_data, **cell_fields})


def other_mesh(block: Block, part: int) -> meshio.Mesh:
    """Return another body as a mesh with the given part number."""
    point_data = {name: _padded(np.asarray(values)) for name, values in block.point_fields.items()}
    cell_data = {name: [_padded(values)] for name, values in block.cell_fields.items()}
    cell_data["body"] = [np.full(len(block.cells), part, dtype=np.int32)]
    return meshio.Mesh(_padded(block.points), [("triangle", block.cells)], point_data, cell_data)


def read_last_frame(directory: Path, until: float = math.inf) -> Frame:
    """Read the last frame of an output directory back, or the last one up to the time ``until`` (s).

    Raises
    ------
    FieldsError
        If there is none or a file is damaged.
    """
    entries = [entry for entry in read_collection(directory) if entry.time <= until * (1.0 + 1e-9)]
    if not entries:
        raise FieldsError(f"{directory / COLLECTION}: there are no fields")
    last = max(entry.step for entry in entries)
    return read_frame(directory, [entry for entry in entries if entry.step == last])


def read_frame(directory: Path, entries: Sequence[Entry]) -> Frame:
    """Read one frame back, whose files of the collection are ``entries``.

    Raises
    ------
    FieldsError
        If a file is damaged.
    """
    try:
        frame = _frame(directory, entries)
        cells_fit = not frame.cells.size or (frame.cells.min() >= 0 and frame.cells.max() < len(frame.points))
        if not cells_fit or not np.isfinite(frame.points).all():
            raise ValueError("its cells and points do not fit")
    except (KeyError, IndexError, ValueError, TypeError, AttributeError) as error:
        names = ", ".join(entry.file for entry in entries)
        raise FieldsError(f"{directory}: {names}: damaged ({repr(error)[:_LONGEST]})") from error
    return frame


def _frame(directory: Path, entries: Sequence[Entry]) -> Frame:
    files = {entry.part: entry for entry in entries}
    body = _read(directory / files[BODY_PART].file)
    tool: tuple[RigidWedge, ...] = ()
    blocks: tuple[Block, ...] = ()
    travel = 0.0
    if TOOL_PART in files:
        found = _read(directory / files[TOOL_PART].file)
        constants, blocks = _constants(found), _blocks(found)
        travel = constants["travel"]
        centre = (constants["centre_x"], constants["centre_y"])
        tool = (RigidWedge(centre, constants["rake"], constants["clearance"], constants["tip_radius"]),)

    points = np.asarray(body.points, dtype=np.float64)[:, :2]
    point_fields = {
        name: values[:, :2] if values.ndim == 2 else values
        for name, values in body.point_data.items()
        if name not in _CONTACT
    }
    cell_fields = {
        name: values[0][:, : len(TENSOR)] if values[0].ndim == 2 else values[0]
        for name, values in body.cell_data.items()
        if name != "body"
    }
    cells = body.cells_dict.get("triangle", np.empty((0, 3))).astype(np.int64)
    particles = np.flatnonzero(body.point_data["in_contact"] > 0.0)
    contact = ContactView(
        particles,
        tool[0].arc_length(points[particles]) if tool else np.zeros(particles.size),
        body.point_data["contact_pressure"][particles],
        body.point_data["contact_shear"][particles],
    )
    step, time = files[BODY_PART].step, files[BODY_PART].time
    loops = boundary_loops(cells)
    return Frame(step, time, travel, points, cells, loops, point_fields, cell_fields, tool, contact, blocks)


def body_points(directory: Path, entry: Entry) -> tuple[Array, dict[str, NDArray[np.generic]]]:
    """Points of a body's file with all three coordinates (mm; (n, 3)), and the fields on them.

    Raises
    ------
    FieldsError
        If the file is damaged.
    """
    body = _read(directory / entry.file)
    return np.asarray(body.points, dtype=np.float64), dict(body.point_data)


def _blocks(tool: meshio.Mesh) -> tuple[Block, ...]:
    triangles = tool.cells_dict.get("triangle")
    if triangles is None:
        return ()
    points = np.asarray(tool.points, dtype=np.float64)[:, :2]
    point_fields = {
        name: values[:, :2] if values.ndim == 2 else values for name, values in tool.point_data.items()
    }
    cell_fields = {
        name: values[0][:, : len(TENSOR)] if values[0].ndim == 2 else values[0]
        for name, values in tool.cell_data.items()
        if name not in _GEOMETRY
    }
    return (Block(points, triangles.astype(np.int64), point_fields, cell_fields),)


def boundary_loops(cells: IntArray) -> tuple[IntArray, ...]:
    """Return the closed loops of edges that belong to one triangle only, the body on the left.

    Parameters
    ----------
    cells
        Triangles, counter-clockwise; shape (m, 3).
    """
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    _, inverse, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    border = edges[counts[inverse.ravel()] == 1]
    following: dict[int, list[int]] = {}
    for start, end in border.tolist():
        following.setdefault(start, []).append(end)
    loops: list[IntArray] = []
    while following:
        start = next(iter(following))
        loop, here = [], start
        while here in following:
            loop.append(here)
            ends = following[here]
            here = ends.pop()
            if not ends:
                del following[loop[-1]]
            if here == start:
                break
        loops.append(np.array(loop, dtype=np.int64))
    return tuple(loops)


def read_collection(directory: Path) -> list[Entry]:
    """Return the entries of ``fields.pvd``; none if there is no such file."""
    path = directory / COLLECTION
    if not path.exists():
        return []
    try:
        sets = Xml.parse(path).getroot().iter("DataSet")
        return [
            Entry(
                int(Path(s.attrib["file"]).stem[-8:]),
                float(s.attrib["timestep"]),
                int(s.attrib["part"]),
                s.attrib["file"],
            )
            for s in sets
        ]
    except (OSError, Xml.ParseError, KeyError, ValueError) as error:
        raise FieldsError(f"{path}: damaged ({str(error)[:_LONGEST]})") from error


def write_collection(directory: Path, entries: list[Entry]) -> None:
    """Write ``fields.pvd``, at once."""
    root = Xml.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = Xml.SubElement(root, "Collection")
    for entry in entries:
        Xml.SubElement(
            collection,
            "DataSet",
            timestep=repr(entry.time),
            group="",
            part=str(entry.part),
            file=entry.file,
            name=_NAMES.get(entry.part, f"body {entry.part}"),
        )
    Xml.indent(root)
    with replacing(directory / COLLECTION) as temporary:
        Xml.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)


def _padded(values: NDArray[np.generic]) -> NDArray[np.generic]:
    """Return two-component vectors as three, four-component tensors as six; others as they are."""
    missing = {2: 1, 4: 2}.get(values.shape[1], 0) if values.ndim == 2 else 0
    return np.pad(values, [(0, 0), (0, missing)]) if missing else values


def _write_atomically(path: Path, mesh: meshio.Mesh) -> None:
    with replacing(path) as temporary:
        meshio.write(temporary, mesh, file_format="vtu", binary=True, compression="zlib")


def _read(path: Path) -> meshio.Mesh:
    try:
        return read_quietly(path, file_format="vtu")
    except MeshFileError as error:
        raise FieldsError(str(error)[: len(str(path)) + _LONGEST]) from error


def _constants(mesh: meshio.Mesh) -> dict[str, float]:
    return {name: float(mesh.cell_data[name][0][0]) for name in _GEOMETRY}
