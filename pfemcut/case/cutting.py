"""Orthogonal cutting: from a validated case to the :class:`Problem` that solvers take."""

from __future__ import annotations

import math

from meshing.sizes import Box, Capsule, SizeField, SizeZone
from pfemcut.case.controls import contact_law, moving_tool, newton_controls, particle_controls, time_controls
from pfemcut.case.load import initial_temperature
from pfemcut.case.schema import Case, Cutting, Mesh, Tool
from pfemcut.materials.material import Material
from pfemcut.problem import (
    Axis,
    Body,
    Cut,
    Problem,
    fixed,
)
from pfemcut.tools.rigid_wedge import RigidWedge


def cutting_problem(case: Case, material: Material) -> Problem:
    """The problem of an orthogonal cut.

    The workpiece is [0, L] x [0, H], fixed at the bottom and with u_x = 0 at x = 0. The tool enters at x = L
    and moves towards -x; its tip circle's lowest point lies ``depth`` below the top surface, and it touches the
    workpiece first at time zero.
    """
    length, height = case.workpiece.length, case.workpiece.height
    tool = starting_tool(case)
    mesh = case.mesh
    return Problem(
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
            fixed("fixed", Axis.X),
        ),
        tool=(moving_tool(tool, (-case.cutting.speed, 0.0), case.tool),),
        contact=contact_law(case.contact),
        particles=particle_controls(
            mesh, size_field(mesh, tool, case.cutting.depth, height), (-case.cutting.speed, 0.0)
        ),
        time=time_controls(case.time, case.cutting.travel / case.cutting.speed),
        newton=newton_controls(case.solver),
        stabilisation=case.solver.stabilisation,
        cut=(Cut(depth=case.cutting.depth, speed=case.cutting.speed, surface=height),),
    )


def starting_tool(case: Case) -> RigidWedge:
    """The tool at time zero, where it just touches the side face x = L."""
    tool, cutting = case.tool, case.cutting
    centre = (
        case.workpiece.length + leading_reach(tool, cutting),
        case.workpiece.height - cutting.depth + tool.tip_radius,
    )
    return RigidWedge(centre, tool.rake, tool.clearance, tool.tip_radius)


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
    machined layer   behind the tool, to 0.25 depth below the machined surface                  surface_size
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
                Box((centre_x, machined - 0.25 * depth), (math.inf, surface)), mesh.surface_size, mesh.growth
            ),
        ),
        far_size=mesh.far_size,
    )
