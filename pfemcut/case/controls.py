"""From the sections that all case files share to the controls of a problem."""

from __future__ import annotations

from meshing.sizes import SizeField
from pfemcut.case.sections import ConductanceTable, Contact, Solver, Spacing, Time, ToolHeat
from pfemcut.case.sections import SelfContact as SelfContactTable
from pfemcut.contact.conductance import Conductance
from pfemcut.contact.friction_laws.coulomb import Coulomb
from pfemcut.materials.material import Material
from pfemcut.problem import (
    Coarsening,
    Conductor,
    ContactLaw,
    ElementTransfer,
    ErrorEstimator,
    HeatSource,
    Integrator,
    MovingTool,
    NewtonControls,
    ParticleControls,
    SelfContact,
    StabilisationModulus,
    TimeControls,
    VolumetricHistory,
)
from pfemcut.tools.rigid_wedge import RigidWedge

_THICKNESS = 0.25  # of the spacing
_STIFFNESS = 0.05  # of Young's modulus: the pressure at which surfaces that touch close on each other


def contact_law(contact: Contact) -> ContactLaw:
    """The law of contact."""
    friction = contact.friction
    return ContactLaw(
        penalty=contact.penalty,
        friction=Coulomb(coefficient=friction) if isinstance(friction, float) else friction,
        reference_speed=contact.reference_speed,
        heat_partition=contact.heat_partition,
        conductance=_conductance(contact.conductance),
    )


def self_contact(
    contact: Contact, given: SelfContactTable | None, spacing: float, material: Material
) -> tuple[SelfContact, ...]:
    """How a body of particles about ``spacing`` (mm) apart touches itself; ``contact`` is how it touches others."""
    if given is None or not given.enabled:
        return ()
    thickness = _THICKNESS * spacing if given.thickness is None else given.thickness
    stiff = _STIFFNESS * material.young_modulus / thickness
    law = ContactLaw(
        penalty=stiff if given.penalty is None else given.penalty,
        friction=Coulomb(coefficient=given.friction),
        reference_speed=given.reference_speed,
        heat_partition=0.5,
        conductance=_conductance(contact.conductance if given.conductance is None else given.conductance),
    )
    return (SelfContact(law, thickness, spacing),)


def _conductance(given: float | ConductanceTable) -> Conductance:
    if isinstance(given, ConductanceTable):
        return Conductance(given.value, given.reference_pressure, given.exponent)
    return Conductance(given)


def moving_tool(shape: RigidWedge, velocity: tuple[float, float], heat: ToolHeat) -> MovingTool:
    """The tool with what it has to do with heat."""
    given = heat.conduction
    conductor = () if given is None else (Conductor(**given.model_dump()),)
    return MovingTool(shape, velocity, heat.temperature, conductor)


def particle_controls(
    spacing: Spacing, sizes: SizeField, sizes_velocity: tuple[float, float]
) -> ParticleControls:
    """Insertion and removal in a size field that moves with ``sizes_velocity`` (mm/s)."""
    return ParticleControls(
        sizes=sizes,
        sizes_velocity=sizes_velocity,
        remesh=spacing.remesh,
        insert=spacing.insert,
        remove=spacing.remove,
        boundary_split=spacing.boundary_split,
        boundary_removal=spacing.boundary_removal,
        interior_radius=spacing.interior_radius,
        interior_area=spacing.interior_area,
        interior_spacing=spacing.interior_spacing,
        interior_removal=spacing.interior_removal,
        coarsening=Coarsening(
            ErrorEstimator(spacing.coarsening), spacing.coarsening_tolerance, spacing.coarsening_largest
        ),
        volumetric_history=_volumetric_history(spacing),
        transfer=ElementTransfer(spacing.transfer),
        power_tolerance=spacing.power_tolerance,
        power_smallest=spacing.power_smallest,
    )


def _volumetric_history(spacing: Spacing) -> VolumetricHistory:
    if spacing.volumetric_history == "auto":
        return VolumetricHistory.INCREMENT if spacing.remesh else VolumetricHistory.ELEMENT
    return VolumetricHistory(spacing.volumetric_history)


def stabilisation_modulus(solver: Solver, spacing: Spacing) -> StabilisationModulus:
    """Modulus of the pressure projection.

    Where it acts on the whole pressure, a modulus that changes when an element begins to flow makes the pressure jump.
    """
    if solver.stabilisation_modulus == "auto":
        on_increment = _volumetric_history(spacing) is VolumetricHistory.INCREMENT
        return StabilisationModulus.SECANT if on_increment else StabilisationModulus.ELASTIC
    return StabilisationModulus(solver.stabilisation_modulus)


def time_controls(time: Time, end: float) -> TimeControls:
    """Time stepping until ``end`` (s)."""
    return TimeControls(
        step=time.step,
        largest_step=time.step if time.largest_step is None else time.largest_step,
        step_tolerance=time.step_tolerance,
        end=end,
        first_step_fraction=time.first_step_fraction,
        growth=time.growth,
        smallest_step_fraction=time.smallest_step_fraction,
        integrator=Integrator(time.integrator),
        heat_source=HeatSource(time.heat_source),
        inertia=time.inertia,
    )


def newton_controls(solver: Solver) -> NewtonControls:
    """Newton iteration."""
    return NewtonControls(solver.tolerance, solver.max_iterations)
