"""Orthogonal cutting: from a validated case to the :class:`Problem` that solvers take."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from meshing.initial import Arc
from meshing.sizes import Box, Capsule, SizeField, SizeZone
from pfemcut.case.controls import (
    contact_law,
    moving_tool,
    newton_controls,
    particle_controls,
    self_contact,
    stabilisation_modulus,
    time_controls,
)
from pfemcut.case.load import initial_temperature
from pfemcut.case.schema import After, Case, Cutting, Mesh, Tool, ToolBody
from pfemcut.materials.load import load_material
from pfemcut.materials.material import Material
from pfemcut.problem import (
    Axis,
    Body,
    ContactIntegration,
    ContactPair,
    Cooling,
    Cut,
    PrescribedMotion,
    Problem,
    Release,
    Schedule,
    Withdrawal,
    fixed,
    relaxed,
)
from pfemcut.tools.rigid_wedge import RigidWedge

_DEPTHS_AWAY = 2.0
_BENDING = 3.0
_COOLING = 20.0  # 50 times the time constant 4 H² / (pi² a) of a layer H with a cold bottom

TOOL = "tool"
"""Name of the body of a deformable tool."""


def cutting_problem(case: Case, material: Material) -> Problem:
    """The problem of an orthogonal cut.

    The workpiece is [0, L] x [0, H], fixed at the bottom and, unless its end is free, with u_x = 0 at x = 0. The tool
    enters at x = L and moves towards -x; its tip circle's lowest point lies ``depth`` below the top surface, and it
    touches the workpiece first at time zero.
    """
    length, height = case.workpiece.length, case.workpiece.height
    tool = starting_tool(case)
    mesh = case.mesh
    sizes = size_field(mesh, tool, case.cutting.depth, height)
    if case.workpiece.end == "free":
        sizes = replace(sizes, zones=(*sizes.zones, exit_zone(mesh, case.cutting.depth, height)))
    velocity = (-case.cutting.speed, 0.0)
    moving = moving_tool(tool, velocity, case.tool)
    given = case.tool.body
    end = case.cutting.travel / case.cutting.speed
    problem = Problem(
        title=case.title or f"Cutting of {material.name}",
        body=Body(
            name="workpiece",
            outline=((0.0, 0.0), (length, 0.0), (length, height), (0.0, height)),
            parts=("bottom", "side", "top", "fixed"),
            material=material,
            temperature=initial_temperature(case, material),
        ),
        motions=(
            fixed("bottom", Axis.X),
            fixed("bottom", Axis.Y),
            *((fixed("fixed", Axis.X),) if case.workpiece.end == "held" else ()),
            *(() if given is None else support_motions(given.supports, velocity, end)),
        ),
        tool=(moving if given is None else replace(moving, body=TOOL),),
        others=() if given is None else (tool_body(case, given, tool, velocity),),
        pairs=()
        if given is None
        else (
            ContactPair(
                slave=("side", "top", "bottom", "fixed"),
                master=("tool_rake", "tool_tip", "tool_flank"),
                law=contact_law(case.contact),
                integration=ContactIntegration(given.contact_points),
                smooth=given.smooth,
            ),
        ),
        contact=contact_law(case.contact),
        self_contact=self_contact(case.contact, case.contact.self, mesh.chip_size, material),
        particles=particle_controls(mesh, sizes, velocity),
        time=time_controls(case.time, end),
        newton=newton_controls(case.solver),
        stabilisation=case.solver.stabilisation,
        stabilisation_modulus=stabilisation_modulus(case.solver, mesh),
        cut=(
            Cut(
                depth=case.cutting.depth,
                speed=case.cutting.speed,
                surface=height,
                chip_length=_or_infinite(case.cutting.chip_length),
            ),
        ),
    )
    return problem if case.after is None else relaxed(problem, after_cut(case, case.after, material))


def after_cut(case: Case, after: After, material: Material) -> tuple[Withdrawal | Cooling | Release, ...]:
    """The stages after the cut."""
    cutting, held = case.cutting, case.workpiece.end == "held"
    initial = initial_temperature(case, material)
    at = np.array([initial])
    diffusivity = float((material.conductivity(at) / (material.density * material.capacity(at)))[0])
    # Heat reaches the bottom through the height, from the chip through the length of the chip.
    way = max(case.workpiece.height, cutting.travel)
    stages: list[Withdrawal | Cooling | Release] = [
        Withdrawal(
            _DEPTHS_AWAY * cutting.depth if after.withdrawal is None else after.withdrawal, cutting.speed
        )
    ]
    if after.cool:
        stages.append(
            Cooling(
                temperature=initial if after.temperature is None else after.temperature,
                sinks=("bottom", "fixed") if held else ("bottom",),
                free=("side", "top") if held else ("side", "top", "fixed"),
                coefficient=after.convection,
                time=_COOLING * way**2 / diffusivity if after.cooling_time is None else after.cooling_time,
                steps=after.cooling_steps,
            )
        )
    if after.release:
        corners = ((Axis.X, "fixed"), (Axis.Y, "fixed"), (Axis.Y, "side"))
        stages.append(Release(tuple(fixed("bottom", axis, corner) for axis, corner in corners)))
    return tuple(stages)


def starting_tool(case: Case) -> RigidWedge:
    """The tool at time zero, where it just touches the side face x = L."""
    tool, cutting = case.tool, case.cutting
    centre = (
        case.workpiece.length + leading_reach(tool, cutting),
        case.workpiece.height - cutting.depth + tool.tip_radius,
    )
    return RigidWedge(centre, tool.rake, tool.clearance, tool.tip_radius)


def tool_body(case: Case, given: ToolBody, tool: RigidWedge, velocity: tuple[float, float]) -> Body:
    """The body of a deformable tool: flank face, back, top, rake face and tip arc, finest at the tip."""
    x, y = tool.centre
    back, top = x + given.width, y - tool.tip_radius + given.height
    foot, heel = tool.rake_tangent_point, tool.flank_tangent_point
    up, along = tool.rake_direction, tool.flank_direction
    rake_top = foot + (top - foot[1]) / up[1] * up
    flank_end = heel + (back - heel[0]) / along[0] * along
    corners = (heel, flank_end, (back, top), rake_top, foot)
    face = foot + 3.0 * case.cutting.depth * up
    zones = (
        SizeZone(Capsule(tool.centre, tool.centre, tool.tip_radius), given.tip_size, given.growth),
        SizeZone(Capsule(_pair(foot), _pair(face), 0.0), given.face_size, given.growth),
    )
    return Body(
        name=TOOL,
        outline=tuple(_pair(corner) for corner in corners),
        parts=("tool_flank", "tool_back", "tool_top", "tool_rake", "tool_tip"),
        material=load_material(given.material, Path(), section="tool.body.material"),
        temperature=case.tool.temperature,
        velocity=velocity,
        arcs=(Arc(4, tool.centre, circumscribed=given.smooth),),
        remesh=False,
        sizes=(SizeField(zones, 0.25 * min(given.width, given.height)),),
    )


def support_motions(supports: str, velocity: tuple[float, float], end: float) -> tuple[PrescribedMotion, ...]:
    """The sides that a tool is held at move with it until the time ``end`` (s)."""
    return tuple(
        PrescribedMotion(part, axis, Schedule((0.0, end), (0.0, speed * end)))
        for name, part in (("top", "tool_top"), ("back", "tool_back"))
        if name in supports
        for axis, speed in zip((Axis.X, Axis.Y), velocity, strict=True)
    )


def _or_infinite(length: float | None) -> float:
    return math.inf if length is None else length


def _pair(point: Any) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def leading_reach(tool: Tool, cutting: Cutting) -> float:
    """How far (mm) the tool extends ahead of its tip circle's centre, over the heights where there is workpiece.

    With a rake of zero or more the foremost point is the circle's, at the height of its centre, or at the top
    surface if that lies lower (``depth`` below the tip radius). A negative rake face leans forward, so there the
    tool meets the corner of the workpiece first, on the rake face or, for a shallow cut, on the circle.
    """
    rake, radius = math.radians(tool.rake), tool.tip_radius
    top = cutting.depth - radius  # height of the top surface above the centre
    foremost = top if tool.rake < 0.0 else min(top, 0.0)
    tangent = radius * math.sin(rake)  # height of the rake face's lower end above the centre
    if foremost > tangent:
        return radius * math.cos(rake) - (foremost - tangent) * math.tan(rake)
    return math.sqrt(radius**2 - foremost**2)


def size_field(mesh: Mesh, tool: RigidWedge, depth: float, surface: float) -> SizeField:
    """Spacing at time zero; the field then moves with the tool.

    ===============  =========================================================================  ===============
    zone             region                                                                     size
    ===============  =========================================================================  ===============
    tip              disc of one tip radius round the centre of the tip circle                  tip_size
    shear zone       within 0.6 depth of the line from the rake face's lower end to the free    shear_zone_size
                     surface one depth ahead of the tip
    chip             everything above the uncut surface                                         chip_size
    machined layer   behind the tool (surface_length), to 0.25 depth below the machined surface surface_size
    ===============  =========================================================================  ===============

    Parameters
    ----------
    mesh
        Sizes and growth.
    tool
        The tool at time zero.
    depth
        Uncut chip thickness (mm).
    surface
        Height of the uncut surface (mm).
    """
    centre_x, centre_y = tool.centre
    foot_x, foot_y = tool.rake_tangent_point
    machined = surface - depth
    chip_foot = surface + 0.3 * depth
    # Steep, so that the chip's zone ends at the uncut surface instead of refining all of it ahead of the tool.
    chip_growth = max(mesh.growth, (mesh.far_size - mesh.chip_size) / (0.3 * depth))
    return SizeField(
        zones=(
            SizeZone(
                Capsule((centre_x, centre_y), (centre_x, centre_y), tool.tip_radius),
                mesh.tip_size,
                mesh.growth,
            ),
            SizeZone(
                Capsule((float(foot_x), float(foot_y)), (centre_x - depth, surface), 0.6 * depth),
                mesh.shear_zone_size,
                mesh.growth,
            ),
            SizeZone(Box((-math.inf, chip_foot), (math.inf, math.inf)), mesh.chip_size, chip_growth),
            SizeZone(
                Box(
                    (centre_x, machined - 0.25 * depth),
                    (centre_x + _or_infinite(mesh.surface_length), surface),
                ),
                mesh.surface_size,
                mesh.growth,
            ),
        ),
        far_size=mesh.far_size,
    )


def exit_zone(mesh: Mesh, depth: float, surface: float) -> SizeZone:
    """What the tool pushes out through the free end x = 0, and this face down to where it bends, three depths."""
    below = surface - _BENDING * depth
    return SizeZone(Box((-math.inf, below), (0.0, math.inf)), mesh.shear_zone_size, mesh.growth, still=True)
