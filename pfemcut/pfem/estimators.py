"""Zienkiewicz-Zhu error estimators that tell where the solution needs few particles (paper, section 2.1).

The recovered field of an element quantity is its area-weighted average round each particle; the estimated error of
an element is what separates its own value from the recovered one, relative to a scale of the whole field. The error
of a piecewise constant field is of first order in the spacing, so the spacing that a tolerance allows is the present
one times tolerance / error.

A small error says that nothing is to be resolved now. That nothing will be is seen from two more signs: the material
is at rest, without plastic flow, and it does not move into a zone of finer spacing. Both hold for the formed chip and
below the machined surface, which the paper coarsens, and not for what is still to be cut, where the error is as small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshing.mesh import Mesh, signed_areas
from meshing.remesh import SpacingFactors
from meshing.sizes import SpacingField
from pfemcut.materials.return_mapping import tensor_norm
from pfemcut.pfem.kinematics import element_mean, nodal_average, shape_gradients
from pfemcut.pfem.state import Fields
from pfemcut.problem import Coarsening, ErrorEstimator, Problem

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

_HYSTERESIS = 3.0  # ratio of the tolerance that asks for insertion to that which allows removal
_HEAT = 0.1  # tolerance of the temperature relative to that of the estimator
_REST = 1e-2  # plastic power per volume below which an element is at rest, relative to where the body flows
_APPROACH = -1e-2  # change of the wished spacing per way below which material moves into a finer zone
_EQUILATERAL = 4.0 / np.sqrt(3.0)  # of side² over area


def coarsening_factors(
    problem: Problem, mesh: Mesh, fields: Fields, sizes: SpacingField, sizes_shift: Array
) -> SpacingFactors:
    """How many times the wished spacing the error estimator allows at each particle.

    Parameters
    ----------
    mesh, fields
        Body at the end of the last step.
    sizes
        Wished spacing.
    sizes_shift
        How far the size field moved in the last step (mm); shape (2,).
    """
    count = len(mesh.points)
    rule = problem.particles.coarsening
    if rule.estimator is ErrorEstimator.NONE:
        return SpacingFactors.none(count)
    areas = signed_areas(mesh.points, mesh.cells)
    wished = sizes(mesh.points)
    present = nodal_average(np.sqrt(_EQUILATERAL * areas), areas, mesh.cells, count)
    error = relative_error(mesh, _estimated_quantity(problem, fields, rule))
    growth = rule.tolerance / _patch_error(mesh, areas, error)
    # Heat flows on where the body is at rest. The error of a linear field is of second order in the spacing.
    heat_error = temperature_error(mesh, fields.temperature)
    growth = np.minimum(growth, np.sqrt(_HEAT * rule.tolerance / _patch_error(mesh, areas, heat_error)))
    allowed = growth * present / wished
    passed = ~_approaching(mesh.points, wished, sizes, fields.last_displacement - sizes_shift)
    flows = np.zeros(count, dtype=bool)
    flows[mesh.cells[_flowing(fields.plastic_power, areas)]] = True
    insertion = np.where(passed & ~flows, np.clip(_HYSTERESIS * allowed, 1.0, rule.largest), 1.0)
    # A removal widens the spacing around: no more than what the neighbours may have without an insertion.
    removal = np.minimum(np.clip(allowed, 1.0, rule.largest), _smallest_around(insertion, mesh))
    return SpacingFactors(removal, insertion)


def relative_error(mesh: Mesh, values: Array) -> Array:
    """Estimated error of the element ``values`` (m,) relative to their largest; (m,)."""
    scale = float(np.max(np.abs(values), initial=0.0))
    if scale == 0.0:
        return np.zeros(len(values))
    areas = signed_areas(mesh.points, mesh.cells)
    recovered = nodal_average(values, areas, mesh.cells, len(mesh.points))
    return np.abs(element_mean(recovered, mesh.cells) - values) / scale


def _approaching(points: Array, wished: Array, sizes: SpacingField, way: Array) -> BoolArray:
    """Particles that moved into finer zones on their last ``way`` (n, 2) through the size field; (n,)."""
    return wished - sizes(points - way) < _APPROACH * np.hypot(*way.T)


def temperature_error(mesh: Mesh, temperature: Array) -> Array:
    """Estimated error of the ``temperature`` (n,) in each element relative to its range; (m,).

    What separates the element's gradient from the recovered one, over the side of the element.
    """
    extent = float(np.ptp(temperature))
    if extent == 0.0:
        return np.zeros(len(mesh.cells))
    areas = signed_areas(mesh.points, mesh.cells)
    gradient = np.einsum("mai,ma->mi", shape_gradients(mesh.points, mesh.cells), temperature[mesh.cells])
    recovered = np.column_stack(
        [nodal_average(each, areas, mesh.cells, len(mesh.points)) for each in gradient.T]
    )
    jump = np.hypot(*(element_mean(recovered, mesh.cells) - gradient).T)
    return jump * np.sqrt(_EQUILATERAL * areas) / extent


def _patch_error(mesh: Mesh, areas: Array, error: Array) -> Array:
    """Root mean square of an element ``error`` (m,) over the elements round each particle; (n,)."""
    mean_square = nodal_average(error**2, areas, mesh.cells, len(mesh.points))
    return np.maximum(np.sqrt(mean_square), 1e-12)


def _flowing(power: Array, areas: Array) -> BoolArray:
    """Elements whose plastic ``power`` per volume is not small beside its mean over the dissipation; (m,)."""
    dissipation = float(power @ areas)
    if dissipation <= 0.0:
        return np.zeros(len(power), dtype=bool)
    return power > _REST * float(power**2 @ areas) / dissipation


def _smallest_around(values: Array, mesh: Mesh) -> Array:
    """Smallest of ``values`` (n,) over each particle and those it shares an element with; (n,)."""
    smallest = values.copy()
    np.minimum.at(smallest, mesh.cells.ravel(), np.repeat(values[mesh.cells].min(axis=1), 3))
    return smallest


def _estimated_quantity(problem: Problem, fields: Fields, rule: Coarsening) -> Array:
    if rule.estimator is ErrorEstimator.PLASTIC_STRAIN:
        return fields.eqps
    deviator = fields.b_elastic.copy()
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    return problem.body.material.shear_modulus * tensor_norm(deviator)
