"""Controls of a run: particles, time steps, Newton iteration. Units: mm, tonne, s, K (so N, MPa, mJ)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from meshing.sizes import SizeField


class Integrator(Enum):
    """How the momentum solve sees the plastic multiplier."""

    IMPL_EX = "impl-ex"
    IMPLICIT = "implicit"


class HeatSource(Enum):
    """Which plastic multiplier heats: the implicit one (default) or the extrapolated one (the paper's Box 4)."""

    IMPLICIT = "implicit"
    EXTRAPOLATED = "extrapolated"


class VolumetricHistory(Enum):
    """Where the volume ratio J of an element comes from at the start of a step.

    INCREMENT: recomputed from the particles' pressure, with the stabilisation on the pressure's increment, so that
    nothing is forgotten as long as elements do not change. PRESSURE: the same with the stabilisation on the whole
    pressure, which forgets in every step what it took (the rule of the study in the design). ELEMENT: the element's
    own, transferred from element to element. MIXED: the element's own as long as it joins the same particles, else
    from pressure.
    """

    INCREMENT = "increment"
    PRESSURE = "pressure"
    ELEMENT = "element"
    MIXED = "mixed"


class StabilisationModulus(Enum):
    """Shear modulus that scales the pressure projection.

    ELASTIC: that of the material, as in the paper. SECANT: of stress over total strain in elements that flow.
    """

    ELASTIC = "elastic"
    SECANT = "secant"


class ErrorEstimator(Enum):
    """Element field whose Zienkiewicz-Zhu error decides where particles may go."""

    NONE = "none"
    PLASTIC_STRAIN = "plastic-strain"
    STRESS = "stress"


@dataclass(frozen=True)
class Coarsening:
    """Removal of particles where an error estimator finds nothing to resolve (paper, section 2.1 and Fig. 2).

    Only of material without plastic flow that does not move into a zone of finer spacing.

    Attributes
    ----------
    estimator
        What is estimated.
    tolerance
        Error, relative to the field's largest value, to which the spacing may grow; the temperature's, relative to
        its range, only to a tenth of it.
    largest
        Largest spacing, relative to the wished one.
    """

    estimator: ErrorEstimator
    tolerance: float
    largest: float


class ElementTransfer(Enum):
    """What an element that a remesh changed takes from the old elements in its place.

    SAMPLE: the value at its Gauss point. MEAN: the mean over its area. LINEAR: the mean over its area of values that
    vary linearly in each old element.
    """

    SAMPLE = "sample"
    MEAN = "mean"
    LINEAR = "linear"


@dataclass(frozen=True)
class ParticleControls:
    """Insertion and removal of particles (paper, section 2.1 and Figs. 2 and 3).

    Lengths are relative to the local spacing h of ``sizes``.

    Attributes
    ----------
    sizes
        Wished spacing at time zero.
    sizes_velocity
        Velocity at which the size field moves, as with the tool (mm/s).
    remesh
        Whether particles are re-triangulated, inserted and removed at all.
    insert, remove
        Switches of insertion and removal.
    boundary_split
        A boundary edge longer than this times h is split.
    boundary_removal
        A boundary edge shorter than this times h is collapsed.
    interior_radius, interior_area
        An element is refined if its circumradius exceeds ``interior_radius`` h or its area
        ``interior_area`` h².
    interior_spacing
        A new particle keeps this times h from the others.
    interior_removal
        A particle closer than this times h to another is removed.
    coarsening
        Removal by error estimators.
    volumetric_history, transfer
        See the enumerations.
    power_tolerance
        Plastic power of one element, as a fraction of the body's, above which it is refined (eq. 1).
    power_smallest
        Plastic-power refinement stops at this times h.
    """

    sizes: SizeField
    sizes_velocity: tuple[float, float]
    remesh: bool
    insert: bool
    remove: bool
    boundary_split: float
    boundary_removal: float
    interior_radius: float
    interior_area: float
    interior_spacing: float
    interior_removal: float
    coarsening: Coarsening
    volumetric_history: VolumetricHistory
    transfer: ElementTransfer
    power_tolerance: float
    power_smallest: float


@dataclass(frozen=True)
class TimeControls:
    """Time stepping.

    Attributes
    ----------
    step
        Nominal step (s).
    largest_step
        Where plastic flow changes little, steps grow up to this (s).
    step_tolerance
        Part of the plastic power that such a step may move, see :mod:`pfemcut.pfem.step_size`.
    end
        Final time (s).
    first_step_fraction
        The first step is this times ``step`` and grows from there.
    growth
        Largest ratio of a step to the one before.
    smallest_step_fraction
        A run whose step must fall below this times ``step`` stops with an error.
    integrator, heat_source
        See the enumerations.
    inertia
        Whether the momentum balance has its inertia term (backward Euler).
    """

    step: float
    largest_step: float
    step_tolerance: float
    end: float
    first_step_fraction: float
    growth: float
    smallest_step_fraction: float
    integrator: Integrator
    heat_source: HeatSource
    inertia: bool


@dataclass(frozen=True)
class NewtonControls:
    """Newton iteration of the momentum solve.

    Attributes
    ----------
    tolerance
        Relative tolerance of the residual norm.
    max_iterations
        A solve that needs more is retried with half the step.
    """

    tolerance: float
    max_iterations: int
