"""Zienkiewicz-Zhu error estimators that tell where the solution needs few particles (paper, section 2.1).

The recovered field of an element quantity is its area-weighted average round each particle; the estimated error of
an element is what separates its own value from the recovered one, relative to a scale of the whole field. Where it
is below the tolerance, particles may be farther apart: the error of a piecewise constant field is of first order in
the spacing, so the allowed spacing grows with tolerance / error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from pfemcut.materials.return_mapping import tensor_norm
from pfemcut.pfem.kinematics import element_mean, nodal_average
from pfemcut.pfem.state import Fields
from pfemcut.problem import Coarsening, ErrorEstimator, Problem

Array = NDArray[np.float64]


def coarsening_factors(problem: Problem, mesh: Mesh, fields: Fields) -> Array:
    """How many times the wished spacing the error estimator allows at each particle, 1 at least; (n,)."""
    rule = problem.particles.coarsening
    if rule.estimator is ErrorEstimator.NONE:
        return np.ones(len(mesh.points))
    error = relative_error(mesh, _estimated_quantity(problem, fields, rule))
    worst = np.zeros(len(mesh.points))
    np.maximum.at(worst, mesh.cells.ravel(), np.repeat(error, 3))
    return np.clip(rule.tolerance / np.maximum(worst, 1e-12), 1.0, rule.largest)


def relative_error(mesh: Mesh, values: Array) -> Array:
    """Estimated error of the element ``values`` (m,) relative to their largest; (m,)."""
    scale = float(np.max(np.abs(values), initial=0.0))
    if scale == 0.0:
        return np.zeros(len(values))
    areas = signed_areas(mesh.points, mesh.cells)
    recovered = nodal_average(values, areas, mesh.cells, len(mesh.points))
    return np.abs(element_mean(recovered, mesh.cells) - values) / scale


def _estimated_quantity(problem: Problem, fields: Fields, rule: Coarsening) -> Array:
    if rule.estimator is ErrorEstimator.PLASTIC_STRAIN:
        return fields.eqps
    deviator = fields.b_elastic.copy()
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    return problem.body.material.shear_modulus * tensor_norm(deviator)
