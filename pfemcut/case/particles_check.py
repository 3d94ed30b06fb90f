"""What ``pfemcut check`` tells about cases of explicit particle methods."""

from __future__ import annotations

from pathlib import Path

from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.case.solids import cutting_particles, solids_problem
from pfemcut.materials.material import Material
from pfemcut.particles.integrate import stable_step
from pfemcut.particles.problem import ParticleProblem


def cut_figures(case: Case, material: Material) -> list[tuple[str, str]]:
    """Main figures of a cut with particles, as name and text with unit."""
    tool, cutting = case.tool, case.cutting
    return [
        *_figures(cutting_particles(case, material)),
        (
            "tool",
            f"rigid, rake {tool.rake:g}, clearance {tool.clearance:g} degrees, tip {tool.tip_radius:g} mm",
        ),
        ("cut", f"{cutting.depth:g} mm deep, {cutting.travel:g} mm at {cutting.speed:g} mm/s"),
        ("output", case.output.directory),
    ]


def solids_figures(case: SolidsCase, material: Material, base_directory: Path) -> list[tuple[str, str]]:
    """Main figures of a case of solids, as name and text with unit."""
    return [
        *_figures(solids_problem(case, material, base_directory)),
        ("output", case.output.directory),
    ]


def unused_sections(case: Case) -> list[str]:
    """What a case file says to the PFEM only, and could leave out."""
    given = [name for name in ("mesh", "solver") if name in case.model_fields_set]
    if not given:
        return []
    return [f"method = '{case.method}' makes no use of " + ", ".join(f"[{name}]" for name in given)]


def _figures(problem: ParticleProblem) -> list[tuple[str, str]]:
    smoothing, time = problem.smoothing, problem.time
    step = stable_step(problem, problem.velocities)
    return [
        ("title", problem.title),
        ("method", problem.formulation.value),
        *(
            (
                body.name,
                f"{body.material.name}, {len(body.points)} particles, initially at {body.temperature:g} K",
            )
            for body in problem.bodies
        ),
        ("spacing", f"{smoothing.spacing:g} mm, h {smoothing.smoothing_length:g} mm"),
        (
            "heat",
            "conducted between particles" if problem.conduction else "stays where it arises (adiabatic)",
        ),
        ("steps", f"about {time.end / step:.0f} of {step:.3g} s, in batches of {time.batch}"),
    ]
