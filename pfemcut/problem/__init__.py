"""What a solver is given: bodies, named boundary parts with conditions, tool, contact and controls.

Solvers take a :class:`Problem` and know nothing of case files; ``pfemcut.case.cutting`` translates an
orthogonal cutting case, other translators serve verification problems. Units: mm, tonne, s, K (so N, MPa, mJ).
"""

from pfemcut.problem.conditions import (
    Axis,
    Convection,
    DistributedForce,
    HeatFlux,
    MovingHeatBand,
    PrescribedMotion,
    PrescribedTemperature,
    Pressure,
    Schedule,
    Traction,
    constant,
    fixed,
)
from pfemcut.problem.controls import (
    Coarsening,
    ElementTransfer,
    ErrorEstimator,
    HeatSource,
    Integrator,
    NewtonControls,
    ParticleControls,
    StabilisationModulus,
    TimeControls,
    VolumetricHistory,
)
from pfemcut.problem.problem import (
    Body,
    Conductor,
    ContactIntegration,
    ContactLaw,
    ContactPair,
    Cut,
    MovingTool,
    Probe,
    Problem,
    SelfContact,
)
from pfemcut.problem.relaxation import Cooling, Release, Withdrawal, relaxed

__all__ = [
    "Axis",
    "Body",
    "Coarsening",
    "Conductor",
    "ContactIntegration",
    "ContactLaw",
    "ContactPair",
    "Convection",
    "Cooling",
    "Cut",
    "DistributedForce",
    "ElementTransfer",
    "ErrorEstimator",
    "HeatFlux",
    "HeatSource",
    "Integrator",
    "MovingHeatBand",
    "MovingTool",
    "NewtonControls",
    "ParticleControls",
    "PrescribedMotion",
    "PrescribedTemperature",
    "Pressure",
    "Probe",
    "Problem",
    "Release",
    "Schedule",
    "SelfContact",
    "StabilisationModulus",
    "TimeControls",
    "Traction",
    "VolumetricHistory",
    "Withdrawal",
    "constant",
    "fixed",
    "relaxed",
]
