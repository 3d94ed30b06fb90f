"""Everything the PFEM carries from step to step; each field is declared once.

The declaration of a field (where it lives, unit, transfer rule) is read by the transfer; a checkpoint
holds every field.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshing.bodies import separated
from meshing.mesh import Boundary, Mesh
from pfemcut.materials.volumetric import volume_ratio_from_pressure

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Where(Enum):
    """What a field has one row of."""

    PARTICLE = "particle"
    ELEMENT = "element"


class Transfer(Enum):
    """How a field passes to a new mesh.

    INTERPOLATE: stays on particles, inserted ones interpolate in the old mesh. INHERIT: an element that changed takes
    its value from the old elements in its place (:class:`pfemcut.problem.ElementTransfer`); INHERIT_UNIMODULAR: so
    does its deviator, and the determinant becomes 1; INHERIT_INVERSE: so does the inverse of its value.
    """

    INTERPOLATE = "interpolate"
    INHERIT = "inherit"
    INHERIT_UNIMODULAR = "inherit, det = 1"
    INHERIT_INVERSE = "inherit 1/value"


@dataclass(frozen=True)
class Declaration:
    """Declaration of a state field."""

    name: str
    where: Where
    unit: str
    transfer: Transfer


def _stored(where: Where, unit: str, inherit: Transfer = Transfer.INHERIT) -> Any:
    transfer = Transfer.INTERPOLATE if where is Where.PARTICLE else inherit
    return field(metadata={"where": where, "unit": unit, "transfer": transfer})


@dataclass(frozen=True)
class Fields:
    """Fields on particles (n rows) and elements (m rows).

    Attributes
    ----------
    temperature
        K; (n,).
    momentum_temperature
        Temperature that the last momentum solve saw, to which ``pressure`` belongs (K); (n,).
    pressure
        Cauchy pressure, tension positive (MPa); (n,).
    displacement
        Displacement since time zero (mm); (n, 2).
    last_displacement
        Displacement over the last step (mm), the predictor of the next; (n, 2).
    sliding_speed
        Speed against a rigid tool that its friction knows, see :func:`pfemcut.contact.friction.remembered_speed`
        (mm/s); zero without a rigid tool; (n,).
    b_elastic
        Isochoric elastic left Cauchy-Green tensor, xx, yy, zz, xy; (m, 4).
    volume_ratio
        J; (m,).
    eqps
        Equivalent plastic strain; (m,).
    multiplier_rate
        Rate of the plastic multiplier in the last step (1/s); (m,).
    plastic_power
        Plastic power per current volume in the last step (mW/mm³); (m,).
    """

    temperature: Array = _stored(Where.PARTICLE, "K")
    momentum_temperature: Array = _stored(Where.PARTICLE, "K")
    pressure: Array = _stored(Where.PARTICLE, "MPa")
    displacement: Array = _stored(Where.PARTICLE, "mm")
    last_displacement: Array = _stored(Where.PARTICLE, "mm")
    sliding_speed: Array = _stored(Where.PARTICLE, "mm/s")
    b_elastic: Array = _stored(Where.ELEMENT, "1", Transfer.INHERIT_UNIMODULAR)
    # Its inverse, so that the mass int rho_0 / J dV is kept.
    volume_ratio: Array = _stored(Where.ELEMENT, "1", Transfer.INHERIT_INVERSE)
    eqps: Array = _stored(Where.ELEMENT, "1")
    multiplier_rate: Array = _stored(Where.ELEMENT, "1/s")
    plastic_power: Array = _stored(Where.ELEMENT, "mW/mm3")


def declarations() -> Iterator[Declaration]:
    """Declarations of all fields, in order."""
    for each in dataclasses.fields(Fields):
        yield Declaration(each.name, each.metadata["where"], each.metadata["unit"], each.metadata["transfer"])


def initial_fields(
    mesh: Mesh,
    temperature: float,
    thermal_strain: float = 0.0,
    last_displacement: tuple[float, float] = (0.0, 0.0),
    sliding_speed: float = 0.0,
) -> Fields:
    """Stress-free fields.

    Parameters
    ----------
    mesh
        The initial mesh.
    temperature
        Uniform temperature (K).
    thermal_strain
        3 alpha (theta - theta_0) at it.
    last_displacement
        Displacement over the step before, which inertia continues (mm).
    sliding_speed
        Speed against a rigid tool (mm/s).
    """
    n, m = len(mesh.points), len(mesh.cells)
    return Fields(
        temperature=np.full(n, temperature),
        momentum_temperature=np.full(n, temperature),
        pressure=np.zeros(n),
        displacement=np.zeros((n, 2)),
        last_displacement=np.tile(np.asarray(last_displacement, dtype=np.float64), (n, 1)),
        sliding_speed=np.full(n, sliding_speed),
        b_elastic=np.tile([1.0, 1.0, 1.0, 0.0], (m, 1)),
        volume_ratio=volume_ratio_from_pressure(np.zeros(m), np.full(m, thermal_strain)),
        eqps=np.zeros(m),
        multiplier_rate=np.zeros(m),
        plastic_power=np.zeros(m),
    )


def separated_fields(fields: Fields, mesh: Mesh) -> tuple[Fields, ...]:
    """The fields of each body of ``mesh``."""
    if len(mesh.first_particles) == 1:
        return (fields,)
    ranges = {Where.PARTICLE: mesh.particle_ranges, Where.ELEMENT: mesh.cell_ranges}
    return tuple(
        Fields(**{each.name: getattr(fields, each.name)[ranges[each.where][i]] for each in declarations()})
        for i in range(len(mesh.first_particles))
    )


def joined_fields(parts: Sequence[Fields]) -> Fields:
    """Fields of all bodies, one after the other."""
    if len(parts) == 1:
        return parts[0]
    return Fields(
        **{each.name: np.concatenate([getattr(part, each.name) for part in parts]) for each in declarations()}
    )


@dataclass(frozen=True)
class Clock:
    """Time stepping state.

    Attributes
    ----------
    step, time
        Steps done and time reached (s).
    last_dt
        Length of the last step (s).
    next_dt
        Length wished for the next (s).
    """

    step: int
    time: float
    last_dt: float
    next_dt: float


@dataclass(frozen=True)
class Ledger:
    """Cumulative energies (mJ/mm), areas (mm²) and counts since the start of the run.

    Work and sinks are defined in the documentation's page on the energy ledger; ``thermoelastic``,
    ``contact`` and ``remeshing`` can have either sign. Heat: ``heat_generated`` is chi times plastic work plus the
    body's part of friction, ``heat_supplied`` came through boundaries, ``heat_to_tool`` left through the interface,
    ``heat_to_holder`` left a conducting tool, ``heat_remeshing`` is the content after minus before each transfer.
    ``cut_off_mass`` (tonne/mm), ``cut_off_energy`` (stored, with inertia also kinetic) and ``cut_off_heat`` went with
    pieces of the chip.
    """

    tool_work: float = 0.0
    plastic: float = 0.0
    friction: float = 0.0
    thermoelastic: float = 0.0
    remeshing: float = 0.0
    contact: float = 0.0
    boundary_work: float = 0.0
    stabilisation: float = 0.0
    heat_generated: float = 0.0
    heat_supplied: float = 0.0
    heat_to_tool: float = 0.0
    heat_to_holder: float = 0.0
    heat_remeshing: float = 0.0
    cut_off_mass: float = 0.0
    cut_off_energy: float = 0.0
    cut_off_heat: float = 0.0
    area_drift: float = 0.0
    inserted: int = 0
    removed: int = 0
    outside: int = 0
    step_cuts: int = 0
    extrapolated_steps: int = 0

    def plus(self, **amounts: float) -> Ledger:
        """The ledger with ``amounts`` added."""
        return dataclasses.replace(self, **{name: getattr(self, name) + x for name, x in amounts.items()})


@dataclass(frozen=True)
class State:
    """Mesh, fields, clock and ledger: what a checkpoint holds.

    ``initial_mass`` and ``initial_kinetic_energy`` are those of the start (tonne/mm, mJ/mm); ``probes`` are the
    identities of the particles that the problem's probes follow; ``last_tool_force`` (2,) and ``last_reactions``
    (motions, 3) are the force on the tool (N/mm), and those of the prescribed motions with their moments, at the end
    of the last step; ``tool_temperature`` is that of a conducting tool's block (K), else empty.
    """

    mesh: Mesh
    fields: Fields
    clock: Clock
    ledger: Ledger
    initial_mass: float
    initial_kinetic_energy: float
    probes: IntArray
    last_tool_force: Array
    last_reactions: Array
    tool_temperature: Array


def separated_states(state: State, first_parts: Sequence[int]) -> tuple[State, ...]:
    """``state`` with the mesh and the fields of each body alone, whose parts begin with the ``first_parts``."""
    if len(first_parts) == 1:
        return (state,)
    pairs = zip(separated(state.mesh, first_parts), separated_fields(state.fields, state.mesh), strict=True)
    return tuple(dataclasses.replace(state, mesh=mesh, fields=fields) for mesh, fields in pairs)


def mesh_arrays(mesh: Mesh) -> dict[str, NDArray[np.generic]]:
    """Flat named arrays of the mesh, for a checkpoint."""
    return {
        "mesh/points": mesh.points,
        "mesh/cells": mesh.cells,
        "mesh/ids": mesh.ids,
        "mesh/next_id": np.asarray(mesh.next_id),
        "mesh/boundary/particles": mesh.boundary.particles,
        "mesh/boundary/parts": mesh.boundary.parts,
        "mesh/boundary/starts": mesh.boundary.starts,
        "mesh/first_particles": mesh.first_particles,
        "mesh/first_cells": mesh.first_cells,
    }


def to_arrays(state: State) -> dict[str, NDArray[np.generic]]:
    """Flat named arrays of the whole state, for a checkpoint."""
    arrays: dict[str, NDArray[np.generic]] = {
        **mesh_arrays(state.mesh),
        "initial_mass": np.asarray(state.initial_mass),
        "initial_kinetic_energy": np.asarray(state.initial_kinetic_energy),
        "probes": state.probes,
        "last_tool_force": state.last_tool_force,
        "last_reactions": state.last_reactions,
        "tool_temperature": state.tool_temperature,
    }
    for group, data in (("fields", state.fields), ("clock", state.clock), ("ledger", state.ledger)):
        for each in dataclasses.fields(data):
            arrays[f"{group}/{each.name}"] = np.asarray(getattr(data, each.name))
    return arrays


def from_arrays(arrays: Mapping[str, NDArray[np.generic]]) -> State:
    """The state that :func:`to_arrays` flattened."""

    def group(kind: type, name: str, scalar: bool) -> Any:
        values = {each.name: arrays[f"{name}/{each.name}"] for each in dataclasses.fields(kind)}
        return kind(**{key: value.item() if scalar else value for key, value in values.items()})

    def whole(name: str) -> IntArray:
        return np.asarray(arrays[f"mesh/{name}"], dtype=np.int64)

    mesh = Mesh(
        np.asarray(arrays["mesh/points"], dtype=np.float64),
        whole("cells"),
        Boundary(whole("boundary/particles"), whole("boundary/parts"), whole("boundary/starts")),
        whole("ids"),
        int(whole("next_id")),
        whole("first_particles"),
        whole("first_cells"),
    )
    return State(
        mesh,
        group(Fields, "fields", scalar=False),
        group(Clock, "clock", scalar=True),
        group(Ledger, "ledger", scalar=True),
        float(arrays["initial_mass"]),
        float(arrays["initial_kinetic_energy"]),
        np.asarray(arrays["probes"], dtype=np.int64),
        np.asarray(arrays["last_tool_force"], dtype=np.float64),
        np.asarray(arrays["last_reactions"], dtype=np.float64),
        np.asarray(arrays["tool_temperature"], dtype=np.float64),
    )
