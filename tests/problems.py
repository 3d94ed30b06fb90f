"""Small problems for tests: blocks, cuts, meshes and outlines."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from numpy.typing import NDArray

from meshing.boundary import Outline
from meshing.initial import outline_mesh
from meshing.mesh import Boundary, Mesh
from meshing.remesh import SpacingRules
from meshing.sizes import SizeField
from meshing.triangulation import constrained_delaunay
from pfemcut.case.cutting import cutting_problem
from pfemcut.case.load import validated
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.fem.momentum_system import MomentumSystem, NodalForces
from pfemcut.materials.hardening.voce import Voce
from pfemcut.materials.material import HardeningLaw, Material, Property
from pfemcut.pfem import mechanics
from pfemcut.pfem.method import PfemMethod
from pfemcut.pfem.state import mesh_arrays
from pfemcut.pfem.step import Kernels
from pfemcut.problem import (
    Axis,
    Body,
    Coarsening,
    ContactLaw,
    ElementTransfer,
    ErrorEstimator,
    HeatFlux,
    HeatSource,
    Integrator,
    MovingTool,
    NewtonControls,
    ParticleControls,
    PrescribedMotion,
    PrescribedTemperature,
    Problem,
    Schedule,
    TimeControls,
    VolumetricHistory,
    constant,
)

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

REFERENCE_TEMPERATURE = 293.15
FOREVER = 1e12
"""Longer than any test lasts (s)."""

SIDES = ("bottom", "right", "top", "left")
RULES = SpacingRules(
    boundary_split=1.45,
    boundary_removal=0.35,
    interior_radius=0.95,
    interior_area=0.65,
    interior_spacing=0.55,
    interior_removal=0.45,
    power_smallest=0.5,
    insert=True,
    remove=True,
)


def voce(yield_stress: float, linear: float = 0.0, softening: float = 0.0) -> Voce:
    """Linear hardening from ``yield_stress`` (MPa) with slope ``linear``, softening with temperature (1/K)."""
    return Voce(
        law="voce",
        yield_stress=yield_stress,
        saturation_stress=yield_stress,
        linear_hardening=linear,
        exponent=0.0,
        flow_stress_softening=softening,
        hardening_softening=softening,
        reference_temperature=REFERENCE_TEMPERATURE,
    )


def steel(
    hardening: HardeningLaw | None = None, poisson_ratio: float = 0.3, expansion: float = 1e-5
) -> Material:
    """A steel; elastic unless ``hardening`` is given (its flow stress, 1e5 MPa, is never reached)."""
    return Material(
        name="test steel",
        source="none",
        young_modulus=206.9e3,
        poisson_ratio=poisson_ratio,
        density=7.8e-9,
        expansion=Property((REFERENCE_TEMPERATURE,), (expansion,)),
        capacity=Property((REFERENCE_TEMPERATURE,), (0.46e9,)),
        conductivity=Property((REFERENCE_TEMPERATURE,), (45.0,)),
        reference_temperature=REFERENCE_TEMPERATURE,
        taylor_quinney=0.9,
        hardening=voce(1e5) if hardening is None else hardening,
    )


def fixed_x(part: str) -> PrescribedMotion:
    """A part held in x."""
    return moving(part, Axis.X, 0.0)


def fixed_y(part: str) -> PrescribedMotion:
    """A part held in y."""
    return moving(part, Axis.Y, 0.0)


def moving(part: str, axis: Axis, velocity: float) -> PrescribedMotion:
    """A part that moves with constant ``velocity`` (mm/s) from time zero."""
    return PrescribedMotion(part, axis, Schedule((0.0, FOREVER), (0.0, velocity * FOREVER)))


def hot(part: str, temperature: float) -> PrescribedTemperature:
    """A part held at a ``temperature`` (K)."""
    return PrescribedTemperature(part, constant(temperature))


def heated(part: str, flux: float) -> HeatFlux:
    """A part that takes up a constant ``flux`` (mW/mm²)."""
    return HeatFlux(part, constant(flux))


def block_problem(
    *,
    width: float = 1.0,
    height: float = 1.0,
    size: float | SizeField = 0.15,
    material: Material | None = None,
    motions: tuple[PrescribedMotion, ...] = (),
    temperatures: tuple[PrescribedTemperature, ...] = (),
    fluxes: tuple[HeatFlux, ...] = (),
    tool: tuple[MovingTool, ...] = (),
    friction: float = 0.0,
    reference_speed: float = 100.0,
    remesh: bool = True,
    step: float = 1e-5,
    steps: int = 10,
    integrator: Integrator = Integrator.IMPL_EX,
    inertia: bool = False,
    tolerance: float = 1e-8,
    stabilisation: float = 1.0,
) -> Problem:
    """A block [0, width] x [0, height] with sides bottom, right, top and left."""
    return Problem(
        title="block",
        body=Body(
            name="block",
            outline=((0.0, 0.0), (width, 0.0), (width, height), (0.0, height)),
            parts=SIDES,
            material=steel() if material is None else material,
            temperature=REFERENCE_TEMPERATURE,
        ),
        motions=motions,
        temperatures=temperatures,
        fluxes=fluxes,
        tool=tool,
        contact=ContactLaw(
            penalty=4e7,
            friction=Coulomb(coefficient=friction),
            reference_speed=reference_speed,
            heat_partition=0.5,
        ),
        particles=ParticleControls(
            sizes=size if isinstance(size, SizeField) else SizeField((), size),
            sizes_velocity=(0.0, 0.0),
            coarsening=Coarsening(ErrorEstimator.NONE, 0.01, 3.0),
            volumetric_history=VolumetricHistory.INCREMENT if remesh else VolumetricHistory.ELEMENT,
            transfer=ElementTransfer.LINEAR,
            remesh=remesh,
            insert=True,
            remove=True,
            boundary_split=RULES.boundary_split,
            boundary_removal=RULES.boundary_removal,
            interior_radius=RULES.interior_radius,
            interior_area=RULES.interior_area,
            interior_spacing=RULES.interior_spacing,
            interior_removal=RULES.interior_removal,
            power_tolerance=0.05,
            power_smallest=RULES.power_smallest,
        ),
        time=TimeControls(
            step=step,
            end=steps * step,
            largest_step=step,
            step_tolerance=0.3,
            first_step_fraction=1.0,
            growth=1.25,
            smallest_step_fraction=1e-3,
            integrator=integrator,
            heat_source=HeatSource.IMPLICIT,
            inertia=inertia,
        ),
        newton=NewtonControls(tolerance=tolerance, max_iterations=15),
        stabilisation=stabilisation,
        cut=(),
    )


SHORT_CUT: Mapping[str, Mapping[str, Any]] = {
    "workpiece": {"length": 1.2, "height": 0.6, "material": "aisi4340"},
    "tool": {"rake": 0.0, "clearance": 5.0, "tip_radius": 0.025},
    "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.5},
    "mesh": {
        "tip_size": 0.008,
        "shear_zone_size": 0.02,
        "chip_size": 0.03,
        "surface_size": 0.03,
        "far_size": 0.6,
        "growth": 0.15,
    },
    "time": {"step": 2.082e-7},
}
"""A coarse cut of AISI 4340 at twice the paper's time step."""


def cut_problem(**sections: Mapping[str, Any]) -> Problem:
    """The short cut with the keys of the given sections replaced."""
    table = {
        name: {**SHORT_CUT.get(name, {}), **sections.get(name, {})} for name in {**SHORT_CUT, **sections}
    }
    case, material = validated(table, Path())
    return cutting_problem(case, material)


def advanced(problem: Problem, steps: int) -> PfemMethod:
    """The run of ``problem`` after ``steps`` steps."""
    method = PfemMethod.start(problem)
    for _ in range(steps):
        method.advance()
    return method


def start_on(problem: Problem, mesh: Mesh) -> PfemMethod:
    """A run at time zero on a given mesh of the problem's body."""
    arrays = dict(PfemMethod.start(problem).state())
    particles, elements = len(arrays["mesh/points"]), len(arrays["mesh/cells"])
    for name, values in arrays.items():
        if name.startswith("fields/"):
            count = {particles: len(mesh.points), elements: len(mesh.cells)}[len(values)]
            arrays[name] = np.repeat(values[:1], count, axis=0)
    arrays |= mesh_arrays(mesh)
    return PfemMethod.restore(problem, arrays)


def with_fields(problem: Problem, method: PfemMethod, **fields: Array) -> PfemMethod:
    """The run with some of its fields replaced, going on with ``problem``."""
    arrays = dict(method.state())
    for name, values in fields.items():
        assert arrays[f"fields/{name}"].shape == values.shape
        arrays[f"fields/{name}"] = values
    return PfemMethod.restore(problem, arrays)


def prescribe_boundary(monkeypatch: pytest.MonkeyPatch, displacement: Callable[[Array], Array]) -> None:
    """Make every step move all boundary particles by a function of their positions, instead of the conditions."""

    def increments(_: Problem, mesh: Mesh, *__: float) -> tuple[NDArray[np.bool_], Array]:
        fixed, value = np.zeros((len(mesh.points), 3), dtype=bool), np.zeros((len(mesh.points), 3))
        particles = mesh.boundary.particles
        fixed[particles, :2] = True
        value[particles, :2] = displacement(mesh.points[particles])
        return fixed, value

    monkeypatch.setattr(mechanics, "prescribed_increments", increments)


def no_forces() -> NodalForces:
    """No contact, loads or inertia."""
    return NodalForces.sum([])


def dense_tangent(system: MomentumSystem, count: int, fixed: NDArray[np.bool_]) -> Array:
    """The matrix of the Newton correction at the last residual, rows and columns in the order of (n, 3)."""
    system.assemble(no_forces())
    indices = np.arange(3 * count, dtype=np.int32)
    return system.matrix().getValues(indices, indices)[np.ix_(~fixed.ravel(), ~fixed.ravel())]


@cache
def kernels() -> Kernels:
    """The compiled forms, made once a session."""
    return Kernels(MPI.COMM_WORLD)


@cache
def _rectangle(width: float, height: float, size: float) -> Mesh:
    corners = np.array([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    return outline_mesh(corners, SizeField((), size), np.arange(4))


def rectangle_mesh(width: float = 1.0, height: float = 1.0, size: float = 0.15, jitter: float = 0.0) -> Mesh:
    """A block whose interior particles are moved at random by ``jitter`` times the size, retriangulated."""
    mesh = _rectangle(width, height, size)
    if not jitter:
        return mesh
    rng = np.random.default_rng(7)
    shift = jitter * size * rng.uniform(-1.0, 1.0, mesh.points.shape)
    shift[mesh.boundary.particles] = 0.0
    points = mesh.points + shift
    return replace(mesh, points=points, cells=constrained_delaunay(points, mesh.boundary.edges))


def star_outline(seed: int, count: int, noise: float, hole: int = 0) -> Outline:
    """A star-shaped loop of ``count`` unevenly spaced corners in four parts, and a clockwise hole of part 4.

    ``hole`` is the number of the hole's corners; none if zero.
    """
    rng = np.random.default_rng(seed)

    def loop(corners: int, radius: float, direction: int) -> Array:
        angle = 2.0 * np.pi * (np.arange(corners) + 0.45 * rng.uniform(-1.0, 1.0, corners)) / corners
        reach = radius * (1.0 + noise * rng.uniform(-1.0, 1.0, corners))
        return (reach[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))[::direction]

    points, parts, starts = loop(count, 1.0, 1), 4 * np.arange(count) // count, [0, count]
    if hole:
        points = np.vstack([points, loop(hole, 0.3, -1)])
        parts = np.concatenate([parts, np.full(hole, 4)])
        starts.append(count + hole)
    return Outline(points, np.arange(len(points)), parts, np.array(starts))


def inside_star(outline: Outline, points: Array) -> NDArray[np.bool_]:
    """Which of ``points`` (n, 2) lie inside the loops (even-odd rule)."""
    a = outline.points
    b = a[outline.topology.following]
    x, y = points[:, 0, None], points[:, 1, None]
    straddles = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    crossing = x < a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return np.sum(straddles & crossing, axis=1) % 2 == 1


def star_mesh(seed: int, count: int, noise: float, interior: int, hole: int = 0) -> Mesh:
    """The star filled with a random cloud of ``interior`` points (fewer inside), triangulated."""
    outline = star_outline(seed, count, noise, hole)
    cloud = np.random.default_rng(seed + 1).uniform(-1.5, 1.5, (interior, 2))
    points = np.vstack([outline.points, cloud[inside_star(outline, cloud)]])
    boundary = Boundary(outline.particles, outline.parts, outline.starts)
    cells = constrained_delaunay(points, boundary.edges)
    return Mesh(points, cells, boundary, 100 + np.arange(len(points)), 100 + len(points))
