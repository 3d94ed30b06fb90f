"""Profiles along the tool: what its surface feels of the workpiece, averaged over instants (docs/tool_profiles.md).

Positions are arc lengths along the tool: zero at the rake tangent point, positive up the rake face, negative round the
edge (the tip circle's arc) and along the flank face. Sliding speeds and shear tractions have signs: positive where the
workpiece slides, and drags the tool's surface, up the rake face.

Each particle in contact stands for the stretch of the tool between the middles of its boundary edges, over which its
traction is uniform. A station's traction is the mean over its own length, so that length times traction, summed over
the stations, is the sum of the particles' forces, whatever the sizes of stations and mesh.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from pfemcut.method import Frame
from pfemcut.results.derived.contact_length import temperature
from pfemcut.results.derived.profiles import tool_surface, tool_surface_temperature
from pfemcut.results.derived.rays import loop_edges
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

PER_DEPTH = 25
"""Stations on rake and flank face in one depth of cut."""
ON_EDGE = 6
"""Fewest stations on the edge."""
RAKE, EDGE, FLANK = "rake", "edge", "flank"

_TOUCHED = 1e-9  # of a station, below which it is not in contact

WearRate = Callable[[Array, Array, Array], Array]
"""From normal pressure (MPa), sliding speed (mm/s) and temperature (K) to the depth worn off in a second (mm/s)."""


@dataclass(frozen=True)
class ToolLoads:
    """What the particles in contact do to the tool at one instant; each of shape (k,).

    Attributes
    ----------
    arc
        Where each is (arc length, mm).
    begin, end
        Stretch of the tool that it stands for (arc length, mm).
    pressure, shear
        Normal and shear traction on the tool (MPa).
    sliding_speed
        Of the workpiece along the tool (mm/s).
    temperature
        Of the workpiece's surface (K).
    tool_temperature
        Of the tool's surface (K); nan where the tool does not conduct heat.
    """

    arc: Array
    begin: Array
    end: Array
    pressure: Array
    shear: Array
    sliding_speed: Array
    temperature: Array
    tool_temperature: Array

    def interface_temperature(self) -> Array:
        """Temperature that wears the tool (K): of its own surface, or else of the workpiece's; (k,)."""
        return np.where(np.isfinite(self.tool_temperature), self.tool_temperature, self.temperature)

    @staticmethod
    def none() -> ToolLoads:
        """No contact."""
        return ToolLoads(*(np.empty(0) for _ in fields(ToolLoads)))


@dataclass(frozen=True)
class Stations:
    """Stations along the tool.

    Attributes
    ----------
    borders
        Arc lengths between which they lie (mm), rising; shape (m + 1,).
    parts
        Part of the tool of each: ``rake``, ``edge`` or ``flank``; m names.
    """

    borders: Array
    parts: tuple[str, ...]

    @property
    def position(self) -> Array:
        """Middles (mm); shape (m,)."""
        return 0.5 * (self.borders[1:] + self.borders[:-1])

    @property
    def length(self) -> Array:
        """Lengths (mm); shape (m,)."""
        return np.diff(self.borders)

    def on(self, part: str) -> NDArray[np.bool_]:
        """Whether each station is on the ``part``; shape (m,)."""
        return np.array([each == part for each in self.parts], dtype=bool)


@dataclass(frozen=True)
class Averaged:
    """A quantity at each station at each instant, nan where undefined; shape (instants, m)."""

    samples: Array

    @property
    def mean(self) -> Array:
        """Mean over the instants that know the quantity, nan where none does; shape (m,)."""
        known = np.isfinite(self.samples)
        count = known.sum(axis=0)
        total = np.where(known, self.samples, 0.0).sum(axis=0)
        return np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0)

    @property
    def std(self) -> Array:
        """Standard deviation over the same instants; shape (m,)."""
        return np.sqrt(Averaged((self.samples - self.mean) ** 2).mean)


@dataclass(frozen=True)
class ToolProfiles:
    """Profiles along the tool, averaged over instants.

    Attributes
    ----------
    stations
        Where.
    instants
        How many.
    contact
        Part of each station that is in contact, mean over the instants; shape (m,).
    quantities
        ``pressure``, ``shear`` (MPa), ``sliding_speed`` (mm/s), ``temperature`` of the workpiece (K), ``heat_flux`` of
        friction (mW/mm²); ``tool_temperature`` (K) of a tool that conducts; ``wear_rate`` (mm/s) if constants are
        given. Temperatures and sliding speed are means over what is in contact, the others over the whole station.
    forces
        Cutting and thrust force (N/mm) that the particles' tractions add up to at each instant; shape (instants, 2).
    """

    stations: Stations
    instants: int
    contact: Array
    quantities: dict[str, Averaged]
    forces: Array

    def friction(self) -> Array:
        """Apparent coefficient of friction: mean shear over mean pressure, without sign; nan without pressure; (m,)."""
        pressure = self.quantities["pressure"].mean
        ratio = np.full_like(pressure, np.nan)
        return np.divide(np.abs(self.quantities["shear"].mean), pressure, out=ratio, where=pressure > 0.0)


def tool_loads(frame: Frame, tool_velocity: tuple[float, float], step: float = 0.0) -> ToolLoads:
    """What the body of ``frame`` does to its tool.

    Parameters
    ----------
    frame
        An instant with a tool.
    tool_velocity
        Velocity of the tool (mm/s); of a deformable one, where it is held.
    step
        Time (s) since the surface had the lengths that the contact forces were found with: the last time step for a
        rigid tool, zero if particles and tool were moved together.
    """
    tool, contact = frame.tool[0], frame.contact
    velocity = np.asarray(frame.point_fields["velocity"], dtype=np.float64)
    before, after = facing_halves(tool, frame.points - step * velocity, loop_edges(frame.loops))
    arc = tool.arc_length(frame.points[contact.particles])
    _, along = directions(tool, frame.points[contact.particles])
    slip = velocity[contact.particles] - _surface_velocity(frame, arc, tool_velocity)
    sliding = np.sum(slip * along, axis=1)
    surface, warmth = tool_surface_temperature(frame)
    return ToolLoads(
        arc,
        arc - before[contact.particles],
        arc + after[contact.particles],
        contact.pressure,
        # Friction works against the slip, so the tool is dragged along with it.
        np.copysign(contact.shear, sliding),
        sliding,
        temperature(frame)[contact.particles],
        np.interp(arc, surface, warmth) if surface.size else np.full(arc.size, np.nan),
    )


def _surface_velocity(frame: Frame, arc: Array, tool_velocity: tuple[float, float]) -> Array:
    """Velocity (mm/s) of the tool's surface at arc lengths, with that of its deformation if it deforms; (k, 2)."""
    for tool, block in zip(frame.tool, frame.tool_blocks, strict=False):
        if "velocity" in block.point_fields:
            particles, at = tool_surface(tool, block)
            velocity = np.asarray(block.point_fields["velocity"], dtype=np.float64)[particles]
            return np.column_stack([np.interp(arc, at, component) for component in velocity.T])
    return np.tile(tool_velocity, (arc.size, 1))


def facing_halves(tool: RigidWedge, points: Array, edges: IntArray) -> tuple[Array, Array]:
    """Length along the tool (mm) of half the boundary edge before and after each particle; shape (n,) each.

    The body lies on the left of its edges (b, 2), so that they run up the rake face. Lengths are projected on the
    tool's tangent at the particle, and zero where the body does not face the tool, as contact has them.
    """
    along = points[edges[:, 1]] - points[edges[:, 0]]
    outward = np.column_stack([along[:, 1], -along[:, 0]])  # times the edge's length
    halves = []
    for ends in (edges[:, 1], edges[:, 0]):
        normal, _ = directions(tool, points[ends])
        half = 0.5 * np.maximum(-np.sum(outward * normal, axis=1), 0.0)
        halves.append(np.bincount(ends, half, minlength=len(points)).astype(np.float64, copy=False))
    return halves[0], halves[1]


def directions(tool: RigidWedge, points: Array) -> tuple[Array, Array]:
    """Outward normal of the tool next to ``points``, and its tangent up the rake face; shape (k, 2) each."""
    normal = tool.closest(points).normal
    return normal, np.column_stack([normal[:, 1], -normal[:, 0]])


def stations_of(loads: Sequence[ToolLoads], tool: RigidWedge, depth: float) -> Stations:
    """Stations over all that was in contact at one of the instants, of which at least the edge's.

    On rake and flank they are a twenty-fifth of the depth of cut (mm) long; the edge is divided into equal ones that
    are not longer, and at least six.
    """
    size = depth / PER_DEPTH
    arc = tool.tip_radius * tool.arc_angle
    top = max((float(each.end.max(initial=0.0)) for each in loads), default=0.0)
    bottom = min((float(each.begin.min(initial=0.0)) for each in loads), default=0.0)
    on_rake = math.ceil(top / size)
    on_flank = math.ceil(max(-arc - bottom, 0.0) / size)
    on_edge = max(ON_EDGE, math.ceil(arc / size))
    borders = np.concatenate(
        [
            -arc - size * np.arange(on_flank, 0, -1),
            np.linspace(-arc, 0.0, on_edge + 1),
            size * np.arange(1, on_rake + 1),
        ]
    )
    return Stations(borders, (FLANK,) * on_flank + (EDGE,) * on_edge + (RAKE,) * on_rake)


def averaged_profiles(
    loads: Sequence[ToolLoads], tool: RigidWedge, depth: float, wear: tuple[WearRate, ...] = ()
) -> ToolProfiles:
    """Average the ``loads`` of instants (at least one), all with the same weight.

    The wear rate is that of each particle's own pressure, speed and temperature, then averaged: it is far from linear
    in the temperature.

    Parameters
    ----------
    loads
        Of each instant.
    tool
        The tool; where it is does not matter.
    depth
        Depth of cut (mm), which sets the length of the stations.
    wear
        Law of the wear rate, or none.
    """
    stations = stations_of(loads, tool, depth)
    spread = [_shares(each, stations) for each in loads]
    covered = np.array([each.sum(axis=0) for each in spread])

    def over_station(values: Sequence[Array]) -> Averaged:
        return Averaged(np.array([value @ share for value, share in zip(values, spread, strict=True)]))

    def over_contact(values: Sequence[Array]) -> Averaged:
        total = over_station(values).samples
        return Averaged(np.divide(total, covered, out=np.full_like(total, np.nan), where=covered > _TOUCHED))

    quantities = {
        "pressure": over_station([each.pressure for each in loads]),
        "shear": over_station([each.shear for each in loads]),
        "sliding_speed": over_contact([each.sliding_speed for each in loads]),
        "temperature": over_contact([each.temperature for each in loads]),
        "heat_flux": over_station([each.shear * each.sliding_speed for each in loads]),
    }
    if all(np.isfinite(each.tool_temperature).all() for each in loads):
        quantities["tool_temperature"] = over_contact([each.tool_temperature for each in loads])
    for law in wear:
        quantities["wear_rate"] = over_station(
            [law(each.pressure, each.sliding_speed, each.interface_temperature()) for each in loads]
        )
    forces = np.array([force_on_tool(each, tool) for each in loads])
    return ToolProfiles(stations, len(loads), covered.mean(axis=0), quantities, forces)


def force_on_tool(loads: ToolLoads, tool: RigidWedge) -> Array:
    """Cutting and thrust force (N/mm) of the particles' tractions over their stretches; shape (2,)."""
    length = loads.end - loads.begin
    return _resultant(loads.arc, loads.pressure * length, loads.shear * length, tool)


def force_of_profiles(profiles: ToolProfiles, tool: RigidWedge) -> Array:
    """Cutting and thrust force (N/mm) that the mean pressure and shear integrate to; shape (2,)."""
    length = profiles.stations.length
    pressure, shear = (profiles.quantities[name].mean for name in ("pressure", "shear"))
    return _resultant(profiles.stations.position, pressure * length, shear * length, tool)


def _resultant(arc: Array, normal_force: Array, shear_force: Array, tool: RigidWedge) -> Array:
    """Sum of forces at arc lengths: against the tool's motion towards -x, and upwards."""
    # The normal turns with the arc on the edge, and stays on either face.
    angle = np.clip(-arc / tool.tip_radius, 0.0, tool.arc_angle)
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    normal = cosine * tool.rake_normal - sine * tool.rake_direction
    along = cosine * tool.rake_direction + sine * tool.rake_normal
    return np.asarray(shear_force @ along - normal_force @ normal)


def _shares(loads: ToolLoads, stations: Stations) -> Array:
    """Part of each station that each particle's stretch covers; shape (k, m)."""
    low = np.maximum(loads.begin[:, None], stations.borders[None, :-1])
    high = np.minimum(loads.end[:, None], stations.borders[None, 1:])
    return np.maximum(high - low, 0.0) / stations.length
