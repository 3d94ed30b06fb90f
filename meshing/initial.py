"""Initial mesh of a body: graded mesh of an outline (gmsh), or a mesh read from a file (meshio)."""

from __future__ import annotations

import signal
import warnings
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Boundary, Mesh, signed_areas
from meshing.sizes import SizeField

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


LARGEST_COORDINATE = 1e6
"""Of a node in a file (mm)."""
_FLAT = 1e-9  # area of a triangle over the square of its extent, at most, that is called none


class MeshFileError(Exception):
    """A mesh file that does not hold a usable triangle mesh; the message says why."""


@dataclass(frozen=True)
class Arc:
    """A polygon side that is a circular arc, below half a turn.

    Attributes
    ----------
    side
        The side that starts at this corner.
    centre
        Centre of the circle (mm).
    circumscribed
        Whether its edges touch the circle in their middles, instead of joining points on it; the ends of the side stay
        on the circle. For contact, which sees a smooth curve through the middles of the edges.
    """

    side: int
    centre: tuple[float, float]
    circumscribed: bool = False


def outline_mesh(corners: Array, sizes: SizeField, parts: IntArray, arcs: tuple[Arc, ...] = ()) -> Mesh:
    """Triangulate the outline with the given ``corners`` (k, 2), counter-clockwise, with spacing ``sizes``.

    Parameters
    ----------
    corners
        Corner positions (mm).
    sizes
        Wished spacing (mm).
    parts
        Part number of the side that starts at each corner; shape (k,).
    arcs
        Sides that are arcs; the others are straight.
    """
    interrupted = signal.getsignal(signal.SIGINT)
    import gmsh  # takes half a second to load

    gmsh.initialize(["pfemcut", "-v", "1"], readConfigFiles=False)
    try:
        for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.{option}", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay: the most regular triangles
        geometry = gmsh.model.geo
        tags = [geometry.addPoint(float(x), float(y), 0.0) for x, y in corners]
        centres = {arc.side: geometry.addPoint(*arc.centre, 0.0) for arc in arcs}
        sides = [
            geometry.addCircleArc(a, centres[i], b) if i in centres else geometry.addLine(a, b)
            for i, (a, b) in enumerate(zip(tags, tags[1:] + tags[:1], strict=True))
        ]
        geometry.addPlaneSurface([geometry.addCurveLoop(sides)])
        geometry.synchronize()
        # Later gmsh versions hand over one argument more.
        gmsh.model.mesh.setSizeCallback(lambda _d, _t, x, y, *_: float(sizes(np.array([[x, y]]))[0]))
        gmsh.model.mesh.generate(2)
        mesh = _collect(gmsh.model.mesh, sides, parts)
    finally:
        gmsh.finalize()
        # gmsh 4.13 lets Ctrl-C kill, and forgets what it did before.
        if signal.getsignal(signal.SIGINT) is not interrupted:
            signal.signal(signal.SIGINT, interrupted)
    for arc in arcs:
        if arc.circumscribed:
            ends = corners[arc.side], corners[(arc.side + 1) % len(corners)]
            mesh = _circumscribed(mesh, *ends, np.asarray(arc.centre))
    return mesh


def _circumscribed(mesh: Mesh, corner: Array, next_corner: Array, centre: Array) -> Mesh:
    """``mesh`` with the particles between two corners of its boundary moved off the circle round ``centre``."""
    boundary = mesh.boundary
    at = mesh.points[boundary.particles]
    first = int(np.argmin(np.hypot(*(at - corner).T)))
    last = int(np.argmin(np.hypot(*(at - next_corner).T)))
    entries = [first]
    while entries[-1] != last:
        entries.append(int(boundary.following[entries[-1]]))
    offset = at[entries] - centre
    angle = np.unwrap(np.arctan2(offset[:, 1], offset[:, 0]))
    half = 0.25 * np.abs(angle[2:] - angle[:-2])  # half of the mean angle of the two edges at each particle
    points = mesh.points.copy()
    points[boundary.particles[entries[1:-1]]] = centre + offset[1:-1] / np.cos(half)[:, None]
    return replace(mesh, points=points)


def _collect(mesh: Any, sides: list[int], parts: IntArray) -> Mesh:
    node_tags, coordinates, _ = mesh.getNodes()
    number = np.zeros(int(node_tags.max()) + 1, dtype=np.int64)
    number[node_tags] = np.arange(len(node_tags))
    points = coordinates.reshape(-1, 3)[:, :2].copy()
    _, triangles = mesh.getElementsByType(2)
    cells = number[triangles].reshape(-1, 3)
    flipped = signed_areas(points, cells) < 0.0
    cells[flipped] = cells[flipped][:, [0, 2, 1]]

    particles, edge_parts = [], []
    for side, part in zip(sides, parts, strict=True):
        _, lines = mesh.getElementsByType(1, side)
        starts = number[lines].reshape(-1, 2)[:, 0]  # gmsh lists a line's edges in its direction
        particles.append(starts)
        edge_parts.append(np.full(len(starts), part))
    loop = np.concatenate(particles)
    boundary = Boundary(loop, np.concatenate(edge_parts), np.array([0, len(loop)]))
    return _without_loose_nodes(points, cells, boundary)


def _without_loose_nodes(points: Array, cells: IntArray, boundary: Boundary) -> Mesh:
    """The mesh without nodes that belong to no triangle, such as centres of arcs."""
    used = np.zeros(len(points), dtype=bool)
    used[cells] = True
    number = np.cumsum(used) - 1
    boundary = Boundary(number[boundary.particles], boundary.parts, boundary.starts)
    count = int(used.sum())
    return Mesh(points[used], number[cells], boundary, np.arange(count), count)


def read_mesh(path: Path) -> tuple[Mesh, tuple[str, ...]]:
    """A triangle mesh from any file that meshio reads, and the names of its boundary parts.

    Boundary edges that belong to a physical group (gmsh) or cell set of lines take its name, others ``boundary``.

    Raises
    ------
    MeshFileError
        If the file can't be read, holds no triangles, or none that make a body, or its boundary does not form simple
        loops.
    """
    found = read_quietly(path)
    points = np.asarray(found.points, dtype=np.float64)
    triangles = [block.data for block in found.cells if block.type == "triangle" and len(block.data)]
    if not triangles or points.ndim != 2 or points.shape[1] < 2:
        raise MeshFileError(f"{path}: holds no triangles")
    points, cells = points[:, :2], np.vstack(triangles).astype(np.int64)
    if cells.min() < 0 or cells.max() >= len(points):
        raise MeshFileError(f"{path}: a triangle has a node that is not there")
    corners = points[cells]
    if not np.isfinite(corners).all() or np.abs(corners).max() > LARGEST_COORDINATE:
        raise MeshFileError(f"{path}: a node lies beyond {LARGEST_COORDINATE:g} mm, or nowhere")
    areas = signed_areas(points, cells)
    if np.any(np.abs(areas) <= _FLAT * np.ptp(corners, axis=1).max(axis=1) ** 2):
        raise MeshFileError(f"{path}: a triangle has no area")
    flipped = areas < 0.0
    cells[flipped] = cells[flipped][:, [0, 2, 1]]
    try:
        names, named = _named_edges(found)
    except (IndexError, KeyError, TypeError, ValueError) as error:
        raise MeshFileError(f"{path}: its groups of lines can't be read: {error!r}") from error
    boundary = _boundary_loops(cells, named, path)
    return _without_loose_nodes(points, cells, boundary), (*names, "boundary")


def read_quietly(path: Path, file_format: str | None = None) -> Any:
    """What meshio reads, of the format that the name means unless it is given.

    Raises
    ------
    MeshFileError
        If it can't read the file.
    """
    import meshio

    try:
        # Numpy warns of numbers that it gave up on in the middle. What meshio prints is said below, in one line.
        with warnings.catch_warnings(), redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            warnings.simplefilter("error", DeprecationWarning)
            return meshio.read(path, file_format=file_format)
    except SystemExit as error:
        raise MeshFileError(f"{path}: not a mesh that meshio can read, in any format of that name") from error
    # A damaged file ends its readers in any way: lists too short, names unknown, arrays that do not fit.
    except Exception as error:
        raise MeshFileError(f"{path}: not a mesh that meshio can read: {error!r}") from error


def _named_edges(found: Any) -> tuple[list[str], dict[tuple[int, int], int]]:
    """Names of the groups of lines, and the group of each line by its sorted ends."""
    members: dict[str, IntArray] = {
        name: blocks["line"]
        for name, blocks in found.cell_sets_dict.items()
        if "line" in blocks and not name.startswith("gmsh:")
    }
    # Older gmsh formats number the groups and name the numbers (with the dimension) apart.
    tags = found.cell_data_dict.get("gmsh:physical", {}).get("line")
    if tags is not None:
        for name, (tag, dimension) in found.field_data.items():
            if dimension == 1:
                members.setdefault(name, np.flatnonzero(tags == tag))
    group: dict[tuple[int, int], int] = {}
    for number, lines in enumerate(members.values()):
        ends = found.cells_dict["line"][lines].tolist()
        group.update({(min(a, b), max(a, b)): number for a, b in ends})
    return list(members), group


def _boundary_loops(cells: IntArray, named: dict[tuple[int, int], int], path: Path) -> Boundary:
    directed = np.vstack([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    base = int(cells.max()) + 1
    key = directed[:, 0] * base + directed[:, 1]
    if len(np.unique(key)) < len(key):
        raise MeshFileError(f"{path}: triangles overlap")
    outer = directed[~np.isin(key, directed[:, 1] * base + directed[:, 0])]
    following = dict(outer.tolist())
    if len(following) != len(outer):
        raise MeshFileError(f"{path}: boundary loops touch in a point")
    particles: list[int] = []
    starts = [0]
    while following:
        first = at = next(iter(following))
        while True:
            particles.append(at)
            at = following.pop(at)
            if at == first:
                break
        starts.append(len(particles))
    loop = np.array(particles, dtype=np.int64)
    boundary = Boundary(loop, np.zeros(len(loop), dtype=np.int64), np.array(starts))
    other = len(set(named.values()))
    parts = [named.get((min(a, b), max(a, b)), other) for a, b in boundary.edges.tolist()]
    return Boundary(loop, np.array(parts, dtype=np.int64), np.array(starts))
