"""The problem of any method."""

from __future__ import annotations

from pfemcut.particles.problem import ParticleProblem
from pfemcut.peridynamics.problem import LaminaProblem
from pfemcut.problem import Problem

AnyProblem = Problem | ParticleProblem | LaminaProblem
"""What the driver runs; it uses title, tool, cut and final time."""
