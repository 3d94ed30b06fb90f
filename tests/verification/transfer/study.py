r"""Exact advection through hundreds of remeshes: a smooth field on a body that rotates and shears.

Two incompressible flows with known maps, so that every material point's value is known at all times:

* ``swirl``: a disc of radius 1 in which the ring of radius r turns by :math:`a\,(1 - r^2) + b` a unit of time. Its
  boundary rotates rigidly, its inside winds up by a shear of :math:`2 a r^2`.
* ``shear``: a unit block in simple shear :math:`\gamma(t) = g \sin 2\pi t`, turned by an angle :math:`b t`: after a
  whole period it is its turned self, so what is left of the field shows what the transfers cost.

A Gaussian bump is the field. Each step moves the particles by the exact map, remeshes (Delaunay, insertion and
removal by spacing) and transfers the field on elements (as eqps) and on particles (as temperature).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from meshing.initial import outline_mesh
from meshing.locate import locate
from meshing.mesh import Mesh, signed_areas
from meshing.remesh import RemeshMap, SpacingFactors, SpacingRules, remesh
from meshing.sizes import SizeField
from pfemcut.pfem.conservation import changed_patches, conserve
from pfemcut.pfem.kinematics import lumped
from pfemcut.pfem.transfer import transfer_elements, transfer_particles
from pfemcut.problem import ElementTransfer
from tests.problems import RULES

Array = NDArray[np.float64]

WIDTH = 0.22
Rule = Callable[[Array, Mesh, Mesh, RemeshMap], Array]


@dataclass(frozen=True)
class Flow:
    """A motion: the outline at time zero, where points are at a time, and where they came from."""

    outline: Array
    centre: tuple[float, float]
    forward: Callable[[Array, float], Array]
    back: Callable[[Array, float], Array]


def _turned(points: Array, angle: Array | float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]])


def swirl(a: float = 1.5, b: float = 0.5) -> Flow:
    """The disc; the bump winds up."""

    def angle(points: Array) -> Array:
        return a * (1.0 - np.sum(points**2, axis=1)) + b

    corners = 2.0 * np.pi * np.arange(64) / 64
    return Flow(
        np.column_stack([np.cos(corners), np.sin(corners)]),
        (0.45, 0.0),
        lambda x, t: _turned(x, angle(x) * t),
        lambda x, t: _turned(x, -angle(x) * t),
    )


def shear(g: float = 1.0, b: float = 2.0 * np.pi) -> Flow:
    """The block; the bump comes back."""

    def sheared(points: Array, gamma: float) -> Array:
        return points + np.outer(points[:, 1], [gamma, 0.0])

    return Flow(
        np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]),
        (0.2, 0.1),
        lambda x, t: _turned(sheared(x, g * np.sin(2.0 * np.pi * t)), b * t),
        lambda x, t: sheared(_turned(x, -b * t), -g * np.sin(2.0 * np.pi * t)),
    )


FLOWS = {"swirl": swirl, "shear": shear}


def four_samples(values: Array, old: Mesh, new: Mesh, where: RemeshMap) -> Array:
    """The mean of the values at the centroids of a changed element's four congruent parts, as in the study."""
    carried = values[where.cells]
    changed, vanished = np.flatnonzero(~where.unchanged), where.vanished(len(old.cells))
    if not len(changed) or not len(vanished):
        return carried
    corners = new.points[new.cells[changed]]
    weights = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 2, 2]]) / 6.0
    points = np.einsum("sa,eax->esx", weights, corners).reshape(-1, 2)
    found = locate(old.points, old.cells[vanished], points)
    carried[changed] = values[vanished[found.cells]].reshape(len(changed), 4, -1).mean(axis=1)
    return carried


def by(rule: ElementTransfer) -> Rule:
    """A rule of the solver."""
    return lambda values, old, new, where: transfer_elements(values, old, new, where, rule)


RULES_BY_NAME: dict[str, Rule] = {
    "one sample": by(ElementTransfer.SAMPLE),
    "four samples": four_samples,
    "mean": by(ElementTransfer.MEAN),
    "linear": by(ElementTransfer.LINEAR),
}


def bump(points: Array, centre: tuple[float, float]) -> Array:
    """The field at material positions."""
    return np.exp(-np.sum((points - np.asarray(centre)) ** 2, axis=1) / WIDTH**2)


def element_exact(mesh: Mesh, flow: Flow, now: float) -> Array:
    """Mean of the advected bump over each element, by six-point quadrature."""
    a, b, wa, wb = 0.445948490915965, 0.091576213509771, 0.223381589678011, 0.109951743655322
    rows = [[1 - 2 * a, a, a], [a, 1 - 2 * a, a], [a, a, 1 - 2 * a]]
    rows += [[1 - 2 * b, b, b], [b, 1 - 2 * b, b], [b, b, 1 - 2 * b]]
    points = np.einsum("sa,eax->sex", np.array(rows), mesh.points[mesh.cells])
    values = bump(flow.back(points.reshape(-1, 2), now), flow.centre).reshape(6, -1)
    return np.array([wa] * 3 + [wb] * 3) @ values


def remeshed(mesh: Mesh, size: float, rules: SpacingRules = RULES) -> tuple[Mesh, RemeshMap]:
    """A remesh by spacing alone."""
    free = np.zeros(len(mesh.points), dtype=bool)
    free[mesh.boundary.particles] = True
    return remesh(
        mesh,
        SizeField((), size),
        rules,
        refine_score=np.zeros(len(mesh.cells)),
        removal_scale=np.ones(len(mesh.points)),
        coarsening=SpacingFactors.none(len(mesh.points)),
        locked=np.zeros(len(mesh.points), dtype=bool),
        free=free,
        place_boundary=lambda a, b: 0.5 * (a + b),
    )


def irregular_mesh(outline: Array, size: float, rules: SpacingRules = RULES) -> Mesh:
    """A mesh whose particles are shaken: those of a lattice would change their triangles all at once, or never."""
    mesh = outline_mesh(outline, SizeField((), size), np.zeros(len(outline), dtype=np.int64))
    shift = 0.2 * size * np.random.default_rng(1).uniform(-1.0, 1.0, mesh.points.shape)
    shift[mesh.boundary.particles] = 0.0
    return remeshed(replace(mesh, points=mesh.points + shift), size, rules)[0]


def heat(mesh: Mesh, temperature: Array) -> float:
    """Integral of a particle field with lumped weights."""
    return float(np.sum(signed_areas(mesh.points, mesh.cells) * temperature[mesh.cells].mean(axis=1)))


def advected(
    flow: Flow, names: tuple[str, ...], size: float, steps: int, end: float = 1.0, rules: SpacingRules = RULES
) -> dict[str, dict[str, float]]:
    """Errors of each rule after ``steps`` remeshes up to ``end``; all rules see the same meshes.

    Returns by rule: ``integral_jump`` (mean size of the change of the integral in one remesh, relative),
    ``integral_error`` (accumulated), ``l2_jump`` and ``l2_error`` (against exact element means, of their norm),
    ``peak`` (largest value; ``exact_peak`` beside it), ``ms`` (of processor time) a transfer. Particles, and conserved
    (their field corrected after each remesh): ``heat_jump``, ``heat_error``, ``l2_error``, ``least``, ``peak``, ``ms``.
    """
    mesh = irregular_mesh(flow.outline, size, rules)
    exact = element_exact(mesh, flow, 0.0)
    fields = {name: exact[:, None] for name in names}
    particle_fields = dict.fromkeys(("particles", "conserved"), bump(mesh.points, flow.centre))
    area = signed_areas(mesh.points, mesh.cells)
    total, heat_start = float(area @ exact), heat(mesh, particle_fields["particles"])
    jumps: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    heat_jumps: dict[str, list[float]] = {name: [] for name in particle_fields}
    changed = []
    cost = dict.fromkeys((*names, *particle_fields), 0.0)
    for step in range(1, steps + 1):
        before, now = end * (step - 1) / steps, end * step / steps
        moved = replace(mesh, points=flow.forward(flow.back(mesh.points, before), now))
        old_area = signed_areas(moved.points, moved.cells)
        old_exact = element_exact(moved, flow, now)
        new, where = remeshed(moved, size, rules)
        new_area = signed_areas(new.points, new.cells)
        exact = element_exact(new, flow, now)
        norm = np.sqrt(new_area @ exact**2)
        for name in names:
            started = time.process_time()
            after = RULES_BY_NAME[name](fields[name], moved, new, where)
            cost[name] += time.process_time() - started
            jump = abs(new_area @ after[:, 0] - old_area @ fields[name][:, 0]) / total
            # What one transfer adds to a field that is exact before it.
            fresh = RULES_BY_NAME[name](old_exact[:, None], moved, new, where)[:, 0]
            jumps[name].append((jump, float(np.sqrt(new_area @ (fresh - exact) ** 2) / norm)))
            fields[name] = after
        for name, values in particle_fields.items():
            started = time.process_time()
            carried = transfer_particles(values, moved, where)
            if name == "conserved":
                patches = changed_patches(moved, new, where)
                carried[patches.particles] = conserve(
                    patches,
                    old_area[patches.old],
                    values[moved.cells[patches.old]],
                    new_area[patches.new],
                    carried[new.cells[patches.new]],
                    carried[patches.particles],
                    lumped(new_area, new.cells, len(carried))[patches.particles],
                    (values.min(), values.max()),
                )
            cost[name] += time.process_time() - started
            heat_jumps[name].append(abs(heat(new, carried) - heat(moved, values)) / heat_start)
            particle_fields[name] = carried
        mesh, area = new, new_area
        changed.append(float((~where.unchanged).mean()))
    particle_exact = bump(flow.back(mesh.points, end), flow.centre)
    result = {
        name: {
            "integral_jump": float(np.mean([jump for jump, _ in jumps[name]])),
            "integral_error": abs(float(area @ fields[name][:, 0]) / total - 1.0),
            "l2_jump": float(np.mean([jump for _, jump in jumps[name]])),
            "l2_error": float(np.sqrt(area @ (fields[name][:, 0] - exact) ** 2) / norm),
            "peak": float(fields[name].max()),
            "exact_peak": float(exact.max()),
            "least": float(fields[name].min()),
            "ms": 1e3 * cost[name] / steps,
        }
        for name in names
    }
    for name, values in particle_fields.items():
        result[name] = {
            "heat_jump": float(np.mean(heat_jumps[name])),
            "heat_error": abs(heat(mesh, values) / heat_start - 1.0),
            "l2_error": float(np.linalg.norm(values - particle_exact) / np.linalg.norm(particle_exact)),
            "least": float(values.min()),
            "peak": float(values.max()),
            "ms": 1e3 * cost[name] / steps,
            "changed": float(np.mean(changed)),
            "elements": len(mesh.cells),
        }
    return result
