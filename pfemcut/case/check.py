"""What ``pfemcut check`` tells about a case before it is run: main figures, and choices that look unwise."""

from __future__ import annotations

from pathlib import Path

from pfemcut.case.cutting import cutting_problem
from pfemcut.case.general_schema import GeneralCase
from pfemcut.case.lamina import lamina_figures, lamina_warnings
from pfemcut.case.lamina_schema import LaminaCase
from pfemcut.case.load import AnyCase, AnyMaterial, initial_temperature, solid
from pfemcut.case.particle_count import body_counts
from pfemcut.case.particles import SolidsCase
from pfemcut.case.plausible import implausible
from pfemcut.case.sections import Contact
from pfemcut.case.translate import meshed_problem_of
from pfemcut.materials.material import Material
from pfemcut.results.derived.tool_heating import tool_warnings
from pfemcut.units import both


def figures(case: AnyCase, material: AnyMaterial, base_directory: Path) -> list[tuple[str, str]]:
    """Main figures of the case, as name and text with unit; its files lie in ``base_directory``."""
    if isinstance(case, LaminaCase):
        return lamina_figures(case)
    material = solid(material)
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
    problem = meshed_problem_of(case, material, base_directory)
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
            f"about {body_counts(problem)[problem.body.name]:.0f} at first contact",
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
    problem = meshed_problem_of(case, material, base_directory)
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


def warnings(case: AnyCase, material: AnyMaterial, base_directory: Path = Path()) -> list[str]:
    """Choices that are allowed but make a run inaccurate, meaningless or endless; one line each."""
    if isinstance(case, LaminaCase):
        return lamina_warnings(case)
    material = solid(material)
    if isinstance(case, GeneralCase):
        return implausible(meshed_problem_of(case, material, base_directory))
    if isinstance(case, SolidsCase):
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
            case.time.largest_step is not None and cutting.speed * case.time.largest_step > mesh.tip_size,
            "[time] largest_step moves the tool by more than [mesh] tip_size; "
            f"advised: at most {mesh.tip_size / cutting.speed:.3g} s",
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
            cutting.depth < tool.tip_radius / 5.0,
            f"[cutting] depth = {cutting.depth:g} mm is below a fifth of the tip radius: no chip is to be expected",
        ),
        (
            tool.tip_radius / 5.0 <= cutting.depth < tool.tip_radius,
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
        (
            cutting.chip_length is not None and cutting.chip_length < 5.0 * cutting.depth,
            f"[cutting] chip_length = {cutting.chip_length} mm may cut the chip off where it touches the tool; "
            f"advised: at least five depths, {5.0 * cutting.depth:g}",
        ),
    ]
    if tool.body is not None:
        checks.append(_tip_resolution("tool.body", tool.body.tip_size, tool.tip_radius))
    lasts = cutting.travel / cutting.speed
    problem = cutting_problem(case, material)
    unwise = [text for is_unwise, text in checks if is_unwise]
    return unwise + implausible(problem) + tool_warnings(problem, lasts)


def _tip_resolution(section: str, tip_size: float, tip_radius: float) -> tuple[bool, str]:
    """Whether a section's size at the tip (mm) is too coarse for the tip, and the words for it."""
    return (
        tip_size > tip_radius / 3.0,
        f"[{section}] tip_size = {tip_size:g} mm resolves the tip radius of {tip_radius:g} mm poorly; "
        f"advised: at most a third, {tip_radius / 3.0:.3g}",
    )
