"""What a problem asks for that is allowed but physically unlikely: mistaken units, or beyond what the model holds."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pfemcut.case.particle_count import body_counts, chip_count
from pfemcut.materials.material import Material
from pfemcut.problem import ContactLaw, Problem
from pfemcut.problem.friction_memory import memory_warnings

SOUND_FRACTION = 0.1
"""Of the speed of elastic waves, where the quasi-static balance has lost its meaning."""
INERTIA_FRACTION = 0.02
"""Of the flow stress that the inertial stress rho v² may reach without an inertia term."""
HARDNESS = 3.0
"""Contact pressure of full plastic flow over the flow stress (Tabor, The Hardness of Metals, 1951)."""
PENETRATION_FRACTION = 0.1
"""Of the finest spacing that a particle under that pressure may sink into the tool."""
STIFFEST = 100.0
"""Penalty over Young's modulus per finest spacing, beyond which the equations become ill-conditioned."""
STEPS, PARTICLES = 1e6, 2e5
"""Counts that make a run of weeks."""

_RANGES = {
    "density": (5e-10, 3e-8, "tonne/mm³ (steel: 7.8e-9)"),
    "capacity": (5e7, 1e10, "mm²/(s² K) (steel: 4.6e8; 1e6 of the number in J/(kg K))"),
    "conductivity": (0.05, 3000.0, "N/(s K) (steel: 45; the number in W/(m K))"),
    "expansion": (0.0, 1e-4, "1/K (steel: 1.2e-5)"),
}
"""Lowest and highest value that metals and hard tool materials have, and the unit."""


def implausible(problem: Problem) -> list[str]:
    """What looks mistaken in a problem; one line each."""
    return [
        *(text for body in problem.bodies for text in _material(body.name, body.material)),
        *_temperatures(problem),
        *_speed(problem),
        *_contact(problem),
        *memory_warnings(problem),
        *_size(problem),
    ]


def first_flow_stress(material: Material) -> float:
    """Flow stress (MPa) of the virgin material at its reference temperature and 1/s; infinite if it never flows."""
    start = np.zeros(1)
    found = material.hardening.flow_stress(start, start + 1.0, start + material.reference_temperature)
    return float(found.value[0])


def _material(name: str, material: Material) -> Iterator[str]:
    given = {
        "density": (material.density,),
        "capacity": material.capacity.values,
        "conductivity": material.conductivity.values,
        "expansion": material.expansion.values,
    }
    for key, (low, high, unit) in _RANGES.items():
        odd = [value for value in given[key] if not low <= value <= high]
        if odd:
            yield f"material of '{name}': {key} = {odd[0]:g} is far from any metal's; its unit is {unit}"
    flow = first_flow_stress(material)
    if math.isfinite(flow) and flow < 1e5 and flow > material.young_modulus / 20.0:
        yield (
            f"material of '{name}': flow stress of {flow:.3g} MPa is above a twentieth of Young's modulus, "
            f"{material.young_modulus:g} MPa; are both in MPa?"
        )


def _temperatures(problem: Problem) -> Iterator[str]:
    given = [(f"'{body.name}'", body.temperature) for body in problem.bodies]
    given += [("the tool", tool.temperature) for tool in problem.tool]
    given += [
        (f"part '{each.part}'", value) for each in problem.temperatures for value in each.temperature.values
    ]
    melting = getattr(problem.body.material.hardening, "melting_temperature", math.inf)
    for what, value in given:
        if value < 150.0:
            yield f"temperature of {what}, {value:g}, is in K: did you mean {value + 273.15:g}?"
        if value >= melting:
            yield f"temperature of {what}, {value:g} K, is not below {melting:g} K, where '{problem.body.name}' melts"


def _speed(problem: Problem) -> Iterator[str]:
    speed = max((math.hypot(*tool.velocity) for tool in problem.tool), default=0.0)
    material = problem.body.material
    sound = math.sqrt(material.young_modulus / material.density)
    if speed > SOUND_FRACTION * sound:
        yield (
            f"the tool's speed, {speed:g} mm/s, is above {SOUND_FRACTION:.0%} of the speed of elastic waves in "
            f"'{problem.body.name}', {sound:.3g} mm/s"
        )
    stress, flow = material.density * speed**2, first_flow_stress(material)
    if not problem.time.inertia and math.isfinite(flow) and stress > INERTIA_FRACTION * flow:
        yield (
            f"the inertial stress rho v² = {stress:.3g} MPa is above {INERTIA_FRACTION:.0%} of the flow stress, "
            f"{flow:.3g} MPa: set [time] inertia = true"
        )


def _contact(problem: Problem) -> Iterator[str]:
    laws: list[tuple[str, ContactLaw]] = [("[contact]", problem.contact)] if problem.tool else []
    laws += [("[[contact]]", pair.law) for pair in problem.pairs if not problem.tool]
    laws += [("[contact.self]", rule.law) for rule in problem.self_contact]
    for where, law in laws:
        coefficient = getattr(law.friction, "coefficient", 0.0)
        if isinstance(coefficient, float) and coefficient > 1.0:
            yield f"{where} friction = {coefficient:g} is above 1: chips then stick rather than slide"
    finest = min([zone.size for zone in problem.particles.sizes.zones] + [problem.particles.sizes.far_size])
    material = problem.body.material
    flow, unit = first_flow_stress(material), material.young_modulus / finest
    for where, law in laws:
        if where == "[contact.self]":
            continue
        sinks = HARDNESS * flow / law.penalty
        if math.isfinite(flow) and flow < 1e5 and sinks > PENETRATION_FRACTION * finest:
            advised = HARDNESS * flow / (PENETRATION_FRACTION * finest)
            yield (
                f"{where} penalty = {law.penalty:g} MPa/mm is soft: under {HARDNESS:g} times the flow stress particles "
                f"sink {sinks:.2g} mm into the tool, more than a tenth of the finest spacing; advised: at least "
                f"{advised:.1g}"
            )
        if law.penalty > STIFFEST * unit:
            yield (
                f"{where} penalty = {law.penalty:g} MPa/mm is above {STIFFEST:g} times Young's modulus over the finest "
                f"spacing, {unit:.1g}: the equations become ill-conditioned"
            )


def _size(problem: Problem) -> Iterator[str]:
    time = problem.time
    steps = time.end / time.largest_step
    if steps > STEPS:
        yield f"the run has about {steps:.2g} steps or more"
    for name, count in body_counts(problem).items():
        if count > PARTICLES:
            yield f"'{name}' has about {count:.2g} particles at the start"
    if chip_count(problem) > PARTICLES:
        yield f"the chip has about {chip_count(problem):.2g} particles at the end"
