"""From a validated case of a lamina to its problem, and what ``pfemcut check`` tells about it."""

from __future__ import annotations

import math
from typing import Any

from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.inputs import InputError
from pfemcut.particles.problem import ExplicitTime
from pfemcut.peridynamics.lamina import young_modulus
from pfemcut.peridynamics.load import lamina_of
from pfemcut.peridynamics.micromodulus import CELL
from pfemcut.peridynamics.plate import Hole, LineCrack, Plate
from pfemcut.peridynamics.problem import Criterion, Failure, LaminaProblem, Pull

LARGEST_COUNT = 4_000_000
"""Sites beyond which there is no use in running."""

_GRIP = 2.0  # spacings


def lamina_problem(case: LaminaCase) -> LaminaProblem:
    """The problem of a lamina, whose constants stand in the case.

    Raises
    ------
    InputError
        If the lattice would have more sites than could ever be run.
    """
    given, lattice, pull = case.lamina, case.lattice, case.pull
    count = given.length * given.width / (CELL * lattice.spacing**2)
    if count > LARGEST_COUNT:
        raise InputError(
            [f"[lattice] spacing: given {lattice.spacing:g}, asks for {count:.3g} sites, must be at most 4e6"]
        )
    material: Any = given.material
    return LaminaProblem(
        title=case.title or "Lamina in tension",
        lamina=lamina_of(material),
        plate=Plate(
            length=given.length,
            width=given.width,
            thickness=given.thickness,
            grip=_GRIP * lattice.spacing if given.grip is None else given.grip,
            fibre_angle=math.radians(given.fibre_angle),
            holes=tuple(Hole(each.radius, each.centre) for each in case.hole),
            cracks=tuple(
                LineCrack(each.length, math.radians(each.angle), each.centre) for each in case.crack
            ),
        ),
        spacing=lattice.spacing,
        failure=Failure(Criterion(lattice.criterion), lattice.growth, lattice.fibres_break),
        pull=Pull(pull.speed, pull.grips == "sliding", pull.protected),
        time=ExplicitTime(pull.elongation / pull.speed, lattice.courant, lattice.batch, lattice.mass_scaling),
        damping=lattice.damping,
    )


def lamina_figures(case: LaminaCase) -> list[tuple[str, str]]:
    """Main figures of the case, as name and text with unit."""
    problem = lamina_problem(case)
    lamina, plate, critical = problem.lamina, problem.plate, problem.critical
    modulus = young_modulus(lamina, plate.fibre_angle)
    return [
        ("title", problem.title),
        ("method", case.method),
        ("material", f"{lamina.name}, {modulus:.5g} MPa along the pull by laminate theory"),
        (
            "plate",
            f"{plate.length:g} x {plate.width:g} x {plate.thickness:g} mm, "
            f"fibre at {case.lamina.fibre_angle:g} degrees",
        ),
        ("cut out", f"{len(plate.holes)} holes, {len(plate.cracks)} line cracks"),
        (
            "lattice",
            f"spacing {problem.spacing:g} mm, {len(problem.sites)} sites, {problem.bonds.once.sum()} bonds",
        ),
        (
            "critical stretch",
            f"{critical.opening:.3g} opening, {critical.shear:.3g} shear; at a crack's tip "
            f"{critical.growth_opening:.3g} and {critical.growth_shear:.3g}",
        ),
        ("pull", f"to {case.pull.elongation:g} mm at {case.pull.speed:g} mm/s"),
        (
            "steps",
            f"{problem.time.end / problem.dt:.0f} of {problem.dt:.3g} s, in batches of {problem.time.batch}",
        ),
        ("output", case.output.directory),
    ]


def lamina_warnings(case: LaminaCase) -> list[str]:
    """Choices that are allowed but unwise; one line each."""
    problem = lamina_problem(case)
    across = problem.plate.length / math.sqrt(
        problem.lamina.transverse_modulus / problem.lamina.density / problem.time.mass_scaling
    )
    finest = [hole.radius for hole in problem.plate.holes]
    finest += [0.5 * crack.length for crack in problem.plate.cracks]
    checks = [
        (
            problem.time.end < 5.0 * across,
            f"[pull] speed: the pull lasts {problem.time.end / across:.2g} times as long as a wave across the fibre "
            "takes along the plate: waves, not statics, decide; advised: at least 5",
        ),
        (
            bool(finest) and problem.spacing > min(finest) / 5.0,
            f"[lattice] spacing = {problem.spacing:g} mm is coarse for a hole or crack of half size "
            f"{min(finest, default=0.0):g} mm; advised: at most a fifth",
        ),
    ]
    return [text for unwise, text in checks if unwise]
