"""The mechanical half of a time step: momentum solve, then the implicit constitutive update (paper, Box 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.contact.node_to_segment import SurfaceContact
from pfemcut.fem.momentum_system import MomentumKernels, MomentumSystem, NodalForces
from pfemcut.fem.partition import Partition
from pfemcut.materials.material import Material
from pfemcut.materials.return_mapping import (
    Multiplier,
    Trial,
    elastic_strain,
    elastic_trial,
    extrapolated_multiplier,
    implicit_multiplier,
    returned_deviator,
)
from pfemcut.materials.volumetric import volume_ratio_from_pressure
from pfemcut.pfem.bodies import densities, moduli, over_cells, thermal_strains
from pfemcut.pfem.kinematics import (
    deformation_gradient,
    element_mean,
    lumped,
    nodal_average,
    shape_gradients,
)
from pfemcut.pfem.loads import inertia_forces, load_forces, motion_particles
from pfemcut.pfem.newton import Linearisation, StepFailed, solve_momentum, solve_with_friction
from pfemcut.pfem.stabilisation import modulus_ratio
from pfemcut.pfem.state import Fields
from pfemcut.pfem.step_contact import ContactResult, StepContact
from pfemcut.problem import Body, Integrator, Problem, VolumetricHistory
from pfemcut.timing import Stopwatch

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_ROOT_2_3 = np.sqrt(2.0 / 3.0)
_ELASTIC_STRAIN = 1e-3  # gives a stress of that kind to a material that does not yield
_NEGLIGIBLE_STRESS = 1e-3  # of the initial flow stress: scale of a force that counts before there is contact


@dataclass(frozen=True)
class Motion:
    """Outcome of the momentum solve.

    Attributes
    ----------
    displacement
        Over the step (mm); (n, 2).
    pressure
        Cauchy pressure (MPa); (n,).
    reactions
        Forces of prescribed motions on the body (N/mm); (n, 2).
    contact
        One entry for each rigid tool.
    body_contact
        One entry for each contact pair.
    self_contact
        One entry if bodies may touch themselves.
    volume_ratio
        J at the end of the step; (m,).
    trial
        Elastic trial state at the solution.
    multiplier
        Multiplier that the momentum solve saw; (m,).
    iterations
        Linear solves.
    """

    displacement: Array
    pressure: Array
    reactions: Array
    contact: tuple[ContactResult, ...]
    body_contact: tuple[SurfaceContact, ...]
    self_contact: tuple[SurfaceContact, ...]
    volume_ratio: Array
    trial: Trial
    multiplier: Array
    iterations: int


@dataclass(frozen=True)
class PlasticUpdate:
    """Implicit internal variables at the end of a step.

    Attributes
    ----------
    b_elastic, eqps, multiplier_rate
        See :class:`pfemcut.pfem.state.Fields`.
    eqps_increment
        (m,).
    flow_stress
        MPa; (m,).
    """

    b_elastic: Array
    eqps: Array
    multiplier_rate: Array
    eqps_increment: Array
    flow_stress: Array


def pressure_volume_ratios(material: Material, cells: IntArray, fields: Fields) -> Array:
    """J of ``cells`` (m, 3), recomputed from the particles' pressure and the temperature it belongs to; (m,)."""
    pressure = element_mean(fields.pressure, cells)
    strain = element_mean(material.thermal_strain(fields.momentum_temperature), cells)
    return volume_ratio_from_pressure(pressure / material.bulk_modulus, strain)


def flow_stresses(problem: Problem, mesh: Mesh, eqps: Array, rate: Array, temperature: Array) -> Array:
    """Flow stress of the elements (MPa), each by its body's law; all (m,)."""
    return over_cells(
        problem,
        mesh,
        lambda body, c: body.material.hardening.flow_stress(eqps[c], rate[c], temperature[c]).value,
    )


def surface_flow_stress(problem: Problem, mesh: Mesh, fields: Fields) -> Array:
    """Flow stress of the last step (MPa), averaged over the elements around each particle; (n,)."""
    stress = flow_stresses(
        problem,
        mesh,
        fields.eqps,
        _ROOT_2_3 * fields.multiplier_rate,
        element_mean(fields.temperature, mesh.cells),
    )
    return nodal_average(stress, signed_areas(mesh.points, mesh.cells), mesh.cells, len(mesh.points))


def prescribed_increments(
    problem: Problem, mesh: Mesh, displacement: Array, start_time: float, step: float
) -> tuple[BoolArray, Array]:
    """Which unknowns (u_x, u_y, p) are prescribed and to what over ``step`` (s); both (n, 3).

    ``displacement`` is that since time zero (mm); shape (n, 2).
    """
    fixed = np.zeros((len(mesh.points), 3), dtype=bool)
    value = np.zeros((len(mesh.points), 3))
    for motion in problem.motions:
        particles = motion_particles(problem, mesh, motion)
        fixed[particles, motion.axis.value] = True
        shape = motion.shape(mesh.points[particles] - displacement[particles])
        value[particles, motion.axis.value] = shape @ motion.increment(start_time, start_time + step)
    return fixed, value


def solve_motion(
    problem: Problem,
    kernels: MomentumKernels,
    partition: Partition,
    mesh: Mesh,
    fields: Fields,
    guess: Array,
    *,
    integrator: Integrator,
    start_time: float,
    step: float,
    last_step: float,
    watch: Stopwatch,
) -> Motion:
    """Contact search and momentum solve over ``step`` (s) from the configuration of ``mesh``.

    The iteration starts at ``guess`` (n, 3), displacement and pressure.

    Raises
    ------
    pfemcut.pfem.newton.StepFailed
        If the step is too long.
    """
    cells, count = mesh.cells, len(mesh.points)
    stiffness = moduli(problem, mesh)
    shear_modulus = stiffness[:, 0]
    gradients = shape_gradients(mesh.points, cells)
    areas = signed_areas(mesh.points, cells)
    ratio = fields.volume_ratio
    temperature = element_mean(fields.temperature, cells)
    contact = StepContact.search(
        problem,
        mesh,
        fields,
        guess[:, :2],
        start_time + step,
        step,
        last_step,
        flow_stress=lambda: surface_flow_stress(problem, mesh, fields),
    )
    # Lumped mass of the backward-Euler inertia term m (u / dt - v) / dt; zero in a quasi-static run.
    mass = lumped(areas * densities(problem, mesh) / ratio, cells, count) * float(problem.time.inertia)
    softening = modulus_ratio(
        problem.stabilisation_modulus, fields.b_elastic, fields.eqps, fields.multiplier_rate
    )

    def kinematics(unknown: Array) -> tuple[Trial, Multiplier]:
        trial = elastic_trial(
            fields.b_elastic,
            deformation_gradient(gradients, cells, unknown[:, :2]),
            shear_modulus,
        )
        if integrator is Integrator.IMPLICIT:
            multiplier = implicit_multipliers(
                problem, mesh, trial, fields.eqps, temperature, step, fields.multiplier_rate
            )
        else:
            multiplier = extrapolated_multiplier(trial, fields.multiplier_rate, step)
        return trial, multiplier

    def linearise(unknown: Array, smoothing: float = 1.0) -> Linearisation:
        trial, multiplier = kinematics(unknown)
        element = np.column_stack(
            [
                fields.b_elastic,
                ratio,
                multiplier.value,
                multiplier.by_norm,
                multiplier.by_mu_bar,
                trial.norm,
                trial.mu_bar,
                softening,
            ]
        )
        nodal = NodalForces.sum(
            [
                *contact.forces(unknown[:, :2], smoothing),
                load_forces(problem, mesh, unknown[:, :2], start_time + step),
                inertia_forces(unknown, mass, contact.velocity, step),
            ]
        )
        return Linearisation(element, nodal, float(trial.jacobian.min()))

    fixed, value = prescribed_increments(problem, mesh, fields.displacement, start_time, step)
    start = guess.copy()
    start[fixed] = value[fixed]
    strain = thermal_strains(problem, mesh, fields.temperature)
    incremental = problem.particles.volumetric_history is VolumetricHistory.INCREMENT
    settled = fields.pressure if incremental else np.zeros(count)
    size = np.sqrt(lumped(areas, cells, count))
    nodal_modulus = nodal_average(shear_modulus, areas, cells, count)
    solve = solve_momentum if contact.frictionless else solve_with_friction
    with MomentumSystem(
        kernels,
        partition,
        mesh.points,
        fixed,
        stiffness,
        problem.stabilisation,
        strain,
        settled,
        # Measured on cuts; a body that turns by degrees in a step needs the whole tangent.
        symmetric=bool(problem.cut) and contact.frictionless,
        watch=watch,
        couplings=contact.couplings,
    ) as system:
        solution = solve(
            system,
            linearise,
            start,
            fixed,
            # Not the bulk modulus: in a nearly incompressible body the volume change of second order would rule the
            # line search.
            2.0 * nodal_modulus / size,
            _NEGLIGIBLE_STRESS * min(map(_stress_scale, problem.bodies)) * float(size.min()),
            problem.newton,
        )
    trial, multiplier = kinematics(solution.unknown)
    displacement = solution.unknown[:, :2].copy()
    require_unfolded(mesh, displacement)
    between_bodies = contact.between_bodies(displacement)
    contact.require_found(displacement, between_bodies)
    return Motion(
        displacement=displacement,
        pressure=solution.unknown[:, 2].copy(),
        reactions=np.where(fixed[:, :2], solution.reactions, 0.0),
        contact=contact.with_tools(displacement),
        body_contact=between_bodies,
        self_contact=contact.of_bodies_with_themselves(displacement),
        volume_ratio=trial.jacobian * ratio,
        trial=trial,
        multiplier=multiplier.value,
        iterations=solution.iterations,
    )


def _stress_scale(body: Body) -> float:
    """A stress (MPa) that counts in the body: at which it yields, or of a small elastic strain."""
    material, zero = body.material, np.zeros(1)
    yield_stress = material.hardening.flow_stress(zero, zero, np.array([body.temperature])).value[0]
    return min(float(yield_stress), _ELASTIC_STRAIN * material.shear_modulus)


def implicit_multipliers(
    problem: Problem,
    mesh: Mesh,
    trial: Trial,
    eqps: Array,
    temperature: Array,
    step: float,
    rate_guess: Array,
) -> Multiplier:
    """Backward-Euler multipliers of all bodies, each with its hardening law; ``temperature`` of the elements (m,)."""
    parts = [
        implicit_multiplier(
            trial.of(cells),
            body.material.hardening,
            eqps[cells],
            temperature[cells],
            step,
            rate_guess[cells],
        )
        for body, cells in zip(problem.bodies, mesh.cell_ranges, strict=True)
    ]
    return parts[0] if len(parts) == 1 else Multiplier.joined(parts)


def require_unfolded(mesh: Mesh, displacement: Array) -> None:
    """Fail if the ``displacement`` (n, 2) of the step turns an edge of the boundary round.

    At the tip of the tool a soft element may let a particle slide past the next one along the surface, with all areas
    positive.

    Raises
    ------
    StepFailed
        An edge turns by more than a right angle.
    """
    edges = mesh.boundary.edges
    before = mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
    after = before + displacement[edges[:, 1]] - displacement[edges[:, 0]]
    if np.any(np.sum(before * after, axis=1) <= 0.0):
        raise StepFailed("an edge of the boundary would turn round")


def update_plasticity(
    problem: Problem, mesh: Mesh, fields: Fields, motion: Motion, step: float
) -> PlasticUpdate:
    """Backward-Euler return mapping at the solved displacement and the temperature of the start of the step."""
    temperature = element_mean(fields.temperature, mesh.cells)
    multiplier = implicit_multipliers(
        problem, mesh, motion.trial, fields.eqps, temperature, step, motion.multiplier / step
    ).value
    increment = _ROOT_2_3 * multiplier
    eqps = fields.eqps + increment
    deviator = returned_deviator(motion.trial, multiplier)
    return PlasticUpdate(
        b_elastic=elastic_strain(deviator, moduli(problem, mesh)[:, :1]),
        eqps=eqps,
        multiplier_rate=multiplier / step,
        eqps_increment=increment,
        flow_stress=flow_stresses(problem, mesh, eqps, increment / step, temperature),
    )
