"""General plane-strain problems: from a validated case to the :class:`Problem` that solvers take."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from meshing.initial import Arc, MeshFileError, read_mesh
from meshing.sizes import Capsule, SizeField, SizeZone
from pfemcut.case.controls import (
    contact_law,
    moving_tool,
    newton_controls,
    particle_controls,
    self_contact,
    stabilisation_modulus,
    time_controls,
)
from pfemcut.case.general_schema import (
    Amount,
    BodyTable,
    BoundaryTable,
    Components,
    GeneralCase,
    GeneralMesh,
    TimeTable,
)
from pfemcut.case.load import CaseError
from pfemcut.case.sections import Contact
from pfemcut.materials.load import load_material
from pfemcut.materials.material import Material
from pfemcut.problem import (
    Axis,
    Body,
    ContactIntegration,
    ContactPair,
    Convection,
    DistributedForce,
    HeatFlux,
    MovingHeatBand,
    MovingTool,
    PrescribedMotion,
    PrescribedTemperature,
    Pressure,
    Probe,
    Problem,
    Schedule,
    Traction,
    constant,
)
from pfemcut.tools.rigid_wedge import RigidWedge


def general_problem(case: GeneralCase, material: Material, base_directory: Path) -> Problem:
    """The problem of a general case; mesh files are looked for in ``base_directory``.

    Raises
    ------
    CaseError
        If a mesh file can't be used, or a boundary names a part that it does not have.
    """
    body = _body(case.body[0], material, case.mesh, base_directory)
    others = tuple(
        _body(table, load_material(table.material, base_directory), case.mesh, base_directory)
        for table in case.body[1:]
    )
    names = [part for each in (body, *others) for part in dict.fromkeys(each.parts)]
    pairs = case.contact if isinstance(case.contact, tuple) else ()
    used = [("[[boundary]] part", side.part) for side in case.boundary]
    used += [("[[contact]] slave", part) for pair in pairs for part in pair.slave]
    used += [("[[contact]] master", part) for pair in pairs for part in pair.master]
    unknown = [(key, part) for key, part in used if part not in names]
    if unknown:
        known = ", ".join(f"'{part}'" for part in names)
        raise CaseError([f"{key}: unknown '{part}'; allowed: {known}" for key, part in unknown])
    if len(set(names)) < len(names):
        raise CaseError(["[[body]] parts: bodies must not share names of boundary parts"])
    sides = case.boundary
    return Problem(
        title=case.title or body.name,
        body=body,
        motions=tuple(motion for side in sides for motion in _motions(side, case.time.end)),
        tool=() if case.tool is None else (_moving_tool(case),),
        contact=contact_law(Contact() if isinstance(case.contact, tuple) else case.contact),
        self_contact=()
        if isinstance(case.contact, tuple)
        else self_contact(case.contact, case.contact.self, case.mesh.size, material),
        others=others,
        pairs=tuple(
            ContactPair(
                pair.slave, pair.master, contact_law(pair), ContactIntegration(pair.points), pair.smooth
            )
            for pair in pairs
        ),
        particles=particle_controls(case.mesh, size_field(case.mesh), case.mesh.velocity),
        time=time_controls(case.time, case.time.end),
        newton=newton_controls(case.solver),
        stabilisation=case.solver.stabilisation,
        stabilisation_modulus=stabilisation_modulus(case.solver, case.mesh),
        forces=tuple(DistributedForce(side.part, *_load(side.force)) for side in sides if side.force),
        tractions=tuple(Traction(side.part, *_load(side.traction)) for side in sides if side.traction),
        pressures=tuple(
            Pressure(side.part, _schedule(side.pressure)) for side in sides if side.pressure is not None
        ),
        temperatures=tuple(
            PrescribedTemperature(side.part, _schedule(side.temperature))
            for side in sides
            if side.temperature is not None
        ),
        fluxes=tuple(HeatFlux(side.part, _schedule(side.flux)) for side in sides if side.flux is not None),
        heat_bands=tuple(
            MovingHeatBand(side.part, side.band.flux, side.band.lower, side.band.upper, side.band.velocity)
            for side in sides
            if side.band
        ),
        convections=tuple(
            Convection(side.part, side.convection.coefficient, _schedule(side.convection.ambient))
            for side in sides
            if side.convection
        ),
        probes=tuple(
            Probe(each.name, each.point, [body.name for body in case.body].index(each.body or body.name))
            for each in case.probe
        ),
    )


def size_field(mesh: GeneralMesh) -> SizeField:
    """Spacing at time zero."""
    return SizeField(
        zones=tuple(
            SizeZone(Capsule(each.start, each.end or each.start, each.radius), each.size, each.growth)
            for each in mesh.refine
        ),
        far_size=mesh.size,
    )


def _body(table: BodyTable, material: Material, spacing: GeneralMesh, base_directory: Path) -> Body:
    temperature = material.reference_temperature if table.temperature is None else table.temperature
    if table.mesh is not None:
        try:
            mesh, parts = read_mesh(base_directory / table.mesh)
        except MeshFileError as error:
            raise CaseError([f"[[body]] mesh: {error}"]) from error
        return Body(
            table.name, (), parts, material, temperature, table.velocity, given=(mesh,), remesh=table.remesh
        )
    return Body(
        table.name,
        table.outline or (),
        table.parts or (),
        material,
        temperature,
        table.velocity,
        tuple(Arc(arc.side, arc.centre) for arc in table.arcs),
        remesh=table.remesh,
        sizes=() if table.coarser == 1.0 else (size_field(spacing).scaled(table.coarser),),
    )


def _moving_tool(case: GeneralCase) -> MovingTool:
    tool = case.tool
    assert tool is not None
    shape = RigidWedge(tool.centre, tool.rake, tool.clearance, tool.tip_radius)
    return moving_tool(shape, tool.velocity, tool)


def _motions(side: BoundaryTable, end: float) -> Iterator[PrescribedMotion]:
    for axis, name in ((Axis.X, "x"), (Axis.Y, "y")):
        amount = getattr(side.displacement, name, None)
        if amount is not None:
            yield PrescribedMotion(side.part, axis, _schedule(amount))
        speed = getattr(side.velocity, name, None)
        if speed is not None:
            yield PrescribedMotion(side.part, axis, Schedule((0.0, end), (0.0, speed * end)))
        slopes = [getattr(side.gradient, name + other, None) for other in "xy"]
        if side.gradient is not None and slopes != [None, None]:
            gradient = tuple(_schedule(slope or 0.0) for slope in slopes)
            yield PrescribedMotion(side.part, axis, constant(0.0), gradient, side.gradient.centre)


def _load(components: Components) -> tuple[Schedule, Schedule]:
    return _schedule(components.x or 0.0), _schedule(components.y or 0.0)


def _schedule(amount: Amount) -> Schedule:
    if isinstance(amount, TimeTable):
        return Schedule(amount.time, amount.value)
    return constant(amount)
