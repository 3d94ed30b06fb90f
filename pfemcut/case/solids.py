"""From a validated case to the :class:`ParticleProblem` that explicit particle methods take: cuts and solids."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pfemcut.case.controls import contact_law, moving_tool
from pfemcut.case.cutting import starting_tool
from pfemcut.case.load import CaseError, initial_temperature
from pfemcut.case.particle_count import require_fillable
from pfemcut.case.particles import ExplicitParticles, Particles, Point, Solid, SolidsCase
from pfemcut.case.schema import Case
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.materials.load import load_material
from pfemcut.materials.material import Material
from pfemcut.particles.lattice import box_lattice, cylinder_lattice
from pfemcut.particles.problem import (
    ExplicitTime,
    Formulation,
    Gauge,
    ParticleBody,
    ParticleProblem,
    SmoothingControls,
    Wall,
)
from pfemcut.problem import ContactLaw, Cut

Array = NDArray[np.float64]

_SPACINGS_A_DEPTH = 10.0
_AXES = "xyz"


def cutting_particles(case: Case, material: Material) -> ParticleProblem:
    """The problem of an orthogonal cut: the block, or its part near the tool, filled with particles.

    As in the PFEM's problem the bottom is fixed and the far side held in x; here that is the outermost row of
    particles of what is filled.

    Raises
    ------
    CaseError
        If the tool is none that particles know.
    """
    given = case.particles or Particles()
    if case.after is not None or case.workpiece.end != "held":
        raise CaseError([f"method = '{case.method}' has no [after], and no [workpiece] end but 'held'"])
    if case.tool.model != "rigid" or case.tool.conduction is not None:
        raise CaseError(
            [f"[tool]: with method = '{case.method}' it must be rigid, without [tool.conduction]"]
        )
    spacing = case.cutting.depth / _SPACINGS_A_DEPTH if given.spacing is None else given.spacing
    length, height = case.workpiece.length, case.workpiece.height
    low = np.array(
        [
            length - min(given.filled_length or length, length),
            height - min(given.filled_height or height, height),
        ]
    )
    require_fillable("workpiece", (length - low[0], height - low[1]), spacing)
    points, volume = box_lattice(low, np.array([length, height]), spacing)
    bottom = points[:, 1] < low[1] + spacing
    far = points[:, 0] < low[0] + spacing
    velocity = (-case.cutting.speed, 0.0)
    return ParticleProblem(
        title=case.title or f"Cutting of {material.name}",
        formulation=Formulation(case.method),
        bodies=(
            ParticleBody(
                name="workpiece",
                points=points,
                volume=volume,
                material=material,
                temperature=initial_temperature(case, material),
                velocity=np.zeros(2),
                held=np.column_stack([bottom | far, bottom]),
            ),
        ),
        walls=(),
        tool=(moving_tool(starting_tool(case), velocity, case.tool),),
        contact=contact_law(case.contact),
        time=explicit_time(given, case.cutting.travel / case.cutting.speed),
        smoothing=smoothing_controls(given, spacing),
        cut=(Cut(depth=case.cutting.depth, speed=case.cutting.speed, surface=height),),
        conduction=given.conduction,
    )


def solids_problem(case: SolidsCase, material: Material, base_directory: Path) -> ParticleProblem:
    """The problem of solids; the first body's material is given, files of others lie in ``base_directory``.

    Raises
    ------
    CaseError
        If a hold has no particle in its box.
    """
    materials = [material, *(load_material(each.material, base_directory) for each in case.body[1:])]
    bodies = tuple(_body(case, table, each) for table, each in zip(case.body, materials, strict=True))
    points = np.concatenate([body.points for body in bodies])
    empty = [
        f"[[hold]] box: no particle in {hold.box[0]} to {hold.box[1]}; the outer ones lie half a spacing inside"
        for hold in case.hold
        if not _inside(hold.box, points).any()
    ]
    if empty:
        raise CaseError(empty)
    stiffest = max(each.young_modulus for each in materials)
    spacing = case.particles.spacing
    gauges = tuple(Gauge(number, 2) for number, table in enumerate(case.body) if table.cylinder)[:1]
    return ParticleProblem(
        title=case.title or case.body[0].name,
        formulation=Formulation(case.method),
        bodies=bodies,
        walls=tuple(
            Wall(
                np.array(wall.point),
                np.array(wall.normal) / math.hypot(*wall.normal),
                stiffest / spacing if wall.penalty is None else wall.penalty,
            )
            for wall in case.wall
        ),
        tool=(),
        contact=ContactLaw(stiffest / spacing, Coulomb(coefficient=0.0), 1.0, 0.5),
        time=explicit_time(case.particles, case.time.end),
        smoothing=smoothing_controls(
            case.particles,
            spacing,
            kernel_contact=case.method == "esph" and case.particles.contact != "pinball",
        ),
        gauges=gauges,
        conduction=case.particles.conduction,
    )


def explicit_time(given: ExplicitParticles, end: float) -> ExplicitTime:
    """Explicit time steps until ``end`` (s)."""
    return ExplicitTime(end, given.courant, given.batch, given.mass_scaling)


def smoothing_controls(
    given: ExplicitParticles, spacing: float, *, kernel_contact: bool = False
) -> SmoothingControls:
    """Constants of SPH with particles ``spacing`` (mm) apart."""
    return SmoothingControls(
        spacing=spacing,
        smoothing_length=given.smoothing * spacing,
        corrected=given.corrected,
        alpha=given.alpha,
        beta=given.beta,
        zero_energy=given.zero_energy,
        reference_update=given.reference_update,
        artificial_pressure=given.artificial_pressure,
        pinball=given.pinball,
        kernel_contact=kernel_contact,
    )


def _body(case: SolidsCase, table: Solid, material: Material) -> ParticleBody:
    points, volume = _filled(table, case.particles.spacing)
    held = np.full(points.shape, table.rigid)
    for hold in case.hold:
        inside = _inside(hold.box, points)
        for axis in hold.axes:
            if _AXES.index(axis) < case.dimension:
                held[inside, _AXES.index(axis)] = True
    return ParticleBody(
        name=table.name,
        points=points,
        volume=volume,
        material=material,
        temperature=material.reference_temperature if table.temperature is None else table.temperature,
        velocity=np.array(table.velocity or (0.0,) * case.dimension),
        held=held,
    )


def _inside(box: tuple[Point, Point], points: Array) -> NDArray[np.bool_]:
    low, high = (np.array(corner) for corner in box)
    return np.asarray(((points >= low) & (points <= high)).all(axis=1))


def _filled(table: Solid, spacing: float) -> tuple[Array, float]:
    for shape in (table.cylinder,) if table.cylinder else ():
        require_fillable(table.name, (2.0 * shape.radius, 2.0 * shape.radius, shape.length), spacing)
        points, volume = cylinder_lattice(shape.radius, shape.length, spacing)
        return points + np.array(shape.base), volume
    low, high = table.box or ((0.0, 0.0), (0.0, 0.0))
    require_fillable(table.name, [b - a for a, b in zip(low, high, strict=True)], spacing)
    return box_lattice(np.array(low), np.array(high), spacing)
