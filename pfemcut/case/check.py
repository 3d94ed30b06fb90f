"""What ``pfemcut check`` tells about a case before it is run: main figures, and choices that look unwise."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from meshing.sizes import SizeField
from pfemcut.case.cutting import cutting_problem
from pfemcut.case.general import general_problem
from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.load import AnyCase, initial_temperature
from pfemcut.case.particles import SolidsCase
from pfemcut.case.schema import Case
from pfemcut.case.sections import Contact
from pfemcut.materials.material import Material
from pfemcut.results.derived.tool_heating import tool_warnings
from pfemcut.units import both


def figures(case: AnyCase, material: Material, base_directory: Path) -> list[tuple[str, str]]:
    """Main figures of the case, as name and text with unit; its files lie in ``base_directory``."""
    if isinstance(case, GeneralCase):
        return _general_figures(case, material, base_directory)
    if isinstance(case, SolidsCase):
        # Not before it's needed: numba takes a second to load.
        from pfemcut.case.particles_check import solids_figures

        return solids_figures(case, material, base_directory)
    if case.method != "pfem":
        from pfemcut.case.particles_check import cut_figures

        return cut_figures(case, material)
    cutting, tool, mesh = case.cutting, case.tool, case.mesh
    problem = cutting_problem(case, material)
    length, height = case.workpiece.length, case.workpiece.height
    advance = cutting.speed * case.time.step
    return [
        ("title", problem.title),
        ("material", f"{material.name}, initially at {both(initial_temperature(case, material), 'K', 6)}"),
        ("workpiece", f"{length:g} x {height:g} mm"),
        (
            "tool",
            f"{tool.model}, rake {tool.rake:g}, clearance {tool.clearance:g} degrees, tip {tool.tip_radius:g} mm",
        ),
        *(
            (
                "tool body",
                f"{body.material.name}, {given.width:g} x {given.height:g} mm, held at {given.supports}",
            )
            for body, given in zip(problem.others, (tool.body,), strict=False)
            if given is not None
        ),
        ("cut", f"{cutting.depth:g} mm deep, {cutting.travel:g} mm at {both(cutting.speed, 'mm/s', 6)}"),
        ("friction", _friction(case.contact)),
        *(
            (
                "self-contact",
                f"thickness {rule.thickness:.3g} mm, penalty {rule.law.penalty:.3g} MPa/mm, "
                f"friction {case.contact.self.friction:g}",
            )
            for rule in problem.self_contact
        ),
        ("integrator", case.time.integrator),
        (
            "steps",
            f"about {cutting.travel / advance:.0f} of {case.time.step:g} s ({advance * 1e3:.3g} um each)",
        ),
        (
            "spacing",
            f"tip {mesh.tip_size:g}, shear zone {mesh.shear_zone_size:g}, chip {mesh.chip_size:g}, "
            f"machined layer {mesh.surface_size:g}, far {mesh.far_size:g} mm",
        ),
        (
            "particles",
            f"about {particle_estimate(problem.particles.sizes, length, height):.0f} at first contact",
        ),
        ("output", case.output.directory),
    ]


def _friction(contact: Contact) -> str:
    if isinstance(contact.friction, float):
        return f"{contact.friction:g}"
    table = contact.friction.model_dump(exclude_defaults=True)
    law = table.pop("law", "coulomb")
    return ", ".join([law, *(f"{key} {value}" for key, value in table.items())])


def _general_figures(case: GeneralCase, material: Material, base_directory: Path) -> list[tuple[str, str]]:
    problem = general_problem(case, material, base_directory)
    return [
        ("title", problem.title),
        ("material", f"{material.name}, initially at {both(problem.body.temperature, 'K', 6)}"),
        *(
            (each.name, f"{each.material.name}, initially at {both(each.temperature, 'K', 6)}")
            for each in problem.others
        ),
        ("parts", ", ".join(dict.fromkeys(problem.parts))),
        ("integrator", case.time.integrator),
        ("steps", f"about {case.time.end / case.time.step:.0f} of {case.time.step:g} s"),
        ("spacing", f"{case.mesh.size:g} mm, {len(case.mesh.refine)} finer regions"),
        ("output", case.output.directory),
    ]


def warnings(case: AnyCase, material: Material) -> list[str]:
    """Choices that are allowed but make a cut inaccurate or meaningless; one line each."""
    if not isinstance(case, Case):
        return []
    if case.method != "pfem":
        from pfemcut.case.particles_check import unused_sections

        return unused_sections(case)
    cutting, tool, mesh, work = case.cutting, case.tool, case.mesh, case.workpiece
    advance = cutting.speed * case.time.step
    checks = [
        _tip_resolution("mesh", mesh.tip_size, tool.tip_radius),
        (
            advance > mesh.tip_size / 4.0,
            f"[time] step moves the tool by {advance:.3g} mm, more than a quarter of [mesh] tip_size; "
            f"advised: at most {mesh.tip_size / 4.0 / cutting.speed:.3g} s",
        ),
        (
            mesh.shear_zone_size > cutting.depth / 4.0,
            f"[mesh] shear_zone_size = {mesh.shear_zone_size:g} mm is more than a quarter of the depth of cut",
        ),
        (
            mesh.chip_size > cutting.depth / 3.0,
            f"[mesh] chip_size = {mesh.chip_size:g} mm is more than a third of the depth of cut",
        ),
        (
            mesh.far_size > work.height / 2.0,
            f"[mesh] far_size = {mesh.far_size:g} mm is more than half of the workpiece's height",
        ),
        (
            cutting.depth < tool.tip_radius,
            f"[cutting] depth = {cutting.depth:g} mm is below the tip radius: the tool ploughs more than it cuts",
        ),
        (
            work.height < 5.0 * cutting.depth,
            f"[workpiece] height = {work.height:g} mm is less than five depths of cut: the fixed bottom is felt",
        ),
        (
            work.length - cutting.travel < 5.0 * cutting.depth,
            f"[cutting] travel = {cutting.travel:g} mm ends less than five depths of cut from the held side",
        ),
        (
            cutting.travel < 0.3,
            f"[cutting] travel = {cutting.travel:g} mm is too short for steady means (0.1 mm behind the first 0.2)",
        ),
    ]
    if tool.body is not None:
        checks.append(_tip_resolution("tool.body", tool.body.tip_size, tool.tip_radius))
    lasts = cutting.travel / cutting.speed
    return [text for unwise, text in checks if unwise] + tool_warnings(cutting_problem(case, material), lasts)


def _tip_resolution(section: str, tip_size: float, tip_radius: float) -> tuple[bool, str]:
    """Whether a section's size at the tip (mm) is too coarse for the tip, and the words for it."""
    return (
        tip_size > tip_radius / 3.0,
        f"[{section}] tip_size = {tip_size:g} mm resolves the tip radius of {tip_radius:g} mm poorly; "
        f"advised: at most a third, {tip_radius / 3.0:.3g}",
    )


def particle_estimate(sizes: SizeField, length: float, height: float) -> float:
    """About how many particles of spacing ``sizes`` fill the block [0, length] x [0, height] (mm).

    A particle of an equilateral triangulation owns an area of sqrt(3)/2 h²; the boundary adds half a particle
    per spacing. The integrals are taken over squares that are quartered until they are no wider than h.
    """
    side = sizes.far_size
    columns, rows = math.ceil(length / side), math.ceil(height / side)
    widths = np.array([length / columns, height / rows])
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    centres = np.column_stack([x.ravel(), y.ravel()]) * widths
    quarters = np.array([[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]])

    inside = 0.0
    while len(centres):
        spacing = sizes(centres)
        fine = spacing >= widths.max()
        inside += float(np.sum(widths.prod() / (math.sqrt(0.75) * spacing[fine] ** 2)))
        centres = (centres[~fine, None, :] + quarters * widths).reshape(-1, 2)
        widths = widths / 2.0

    outline = 0.0
    for start, end in (
        ((0.0, 0.0), (length, 0.0)),
        ((length, 0.0), (length, height)),
        ((length, height), (0.0, height)),
        ((0.0, height), (0.0, 0.0)),
    ):
        a, b = np.array(start), np.array(end)
        parts = 4000
        middle = a + ((np.arange(parts) + 0.5) / parts)[:, None] * (b - a)
        outline += float(np.sum(np.hypot(*(b - a)) / parts / sizes(middle)))
    return inside + outline / 2.0
