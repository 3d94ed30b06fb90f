"""A remesh that loses no heat: temperatures are corrected where it changed elements.

Particles are inserted, removed and joined anew, so a field on particles with lumped masses changes its integral.
Each patch of changed elements gets back what it lost by an equal shift of its particles, within bounds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from meshing.mesh import Mesh, signed_areas
from meshing.remesh import RemeshMap
from pfemcut.materials.enthalpy import specific_enthalpy, temperature_at
from pfemcut.materials.volumetric import free_expansion
from pfemcut.pfem.kinematics import lumped
from pfemcut.pfem.loads import part_particles
from pfemcut.pfem.state import Fields
from pfemcut.pfem.transfer import carry_volume, follows_pressure, grouped
from pfemcut.problem import Problem

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ROUNDS = 3  # of an equal shift, before what is left goes where there is room
_OVERSHOOT = (
    0.02  # beyond the extremes of a patch, of their distance: without it corrections of both signs wear peaks
)


@dataclass(frozen=True)
class Patches:
    """Connected sets of elements that a remesh changed, or whose particles it shifted.

    Attributes
    ----------
    old, new
        Elements of the old and of the new mesh that lie in patches; shapes (j,) and (i,).
    old_patch, new_patch
        Patch of each; same shapes.
    particles, patch
        Particles of the new mesh in patches, and the patch of each; shape (k,).
    count
        Number of patches.
    """

    old: IntArray
    new: IntArray
    old_patch: IntArray
    new_patch: IntArray
    particles: IntArray
    patch: IntArray
    count: int


def changed_patches(old: Mesh, new: Mesh, remesh_map: RemeshMap) -> Patches:
    """The patches of a remesh; elements that share a particle, before or after it, belong to one."""
    kept, unchanged = remesh_map.kept, remesh_map.unchanged
    touched = ~unchanged
    shifted = np.zeros(len(new.points), dtype=bool)
    shifted[: len(kept)] = (new.points[: len(kept)] != old.points[kept]).any(axis=1)
    if shifted.any():
        touched |= shifted[new.cells].any(axis=1)
    in_new = np.flatnonzero(touched)
    in_old = np.concatenate(
        [remesh_map.vanished(len(old.cells)), remesh_map.cells[np.flatnonzero(touched & unchanged)]]
    )
    # Old particles take their new numbers; removed ones follow.
    number = len(new.points) + np.arange(len(old.points))
    number[kept] = np.arange(len(kept))
    corners = np.vstack([number[old.cells[in_old]], new.cells[in_new]])
    particles, local = np.unique(corners, return_inverse=True)
    local = local.reshape(-1, 3)
    links = local[:, [0, 1, 1, 2]].reshape(-1, 2)
    joins = coo_matrix((np.ones(len(links)), links.T), shape=(len(particles), len(particles)))
    count, label = connected_components(joins, directed=False)
    label = label.astype(np.int64)
    alive = particles < len(new.points)
    return Patches(
        in_old,
        in_new,
        label[local[: len(in_old), 0]],
        label[local[len(in_old) :, 0]],
        particles[alive],
        label[alive],
        int(count),
    )


def conserve(
    patches: Patches,
    old_mass: Array,
    old_corners: Array,
    new_mass: Array,
    new_corners: Array,
    values: Array,
    weight: Array,
    limits: tuple[float, float],
) -> Array:
    """``values`` on the particles of the ``patches`` with the integral that the old ones had, as far as bounds allow.

    1. Each patch gets back its mean: what the new triangles and particles changed. If they also changed its mass, as
       where the boundary was edited, the mean is kept and the integral follows the mass.
    2. What all patches then lack or have too much, because mass moved between places of different values, is shared
       among those whose mass changed; what they have no room for, among all.

    A patch shifts its particles by the same amount, which changes them least. No value passes the extremes of its
    patch, before and after the remesh, by more than 2 % of their distance, nor the ``limits``; what can't be placed so
    stays missing.

    Parameters
    ----------
    patches
        Of the remesh.
    old_mass, old_corners
        Masses of the patches' old elements and values at their corners; shapes (j,) and (j, 3).
    new_mass, new_corners
        Likewise of their new elements; shapes (i,) and (i, 3).
    values
        On the patches' particles in the new mesh; shape (k,).
    weight
        What one more of the value adds to the integral at each of these: the mass that is lumped there, or zero where
        the value is prescribed; shape (k,).
    limits
        Least and largest value of the body before the remesh.

    Returns
    -------
    values
        Shape (k,).
    """
    if not patches.count:
        return values

    def per_patch(which: IntArray, amounts: Array) -> Array:
        total = np.bincount(which, amounts, minlength=patches.count)
        return total.astype(np.float64, copy=False)

    mass_before, mass_after = per_patch(patches.old_patch, old_mass), per_patch(patches.new_patch, new_mass)
    before = per_patch(patches.old_patch, old_mass * old_corners.mean(axis=1))
    after = per_patch(patches.new_patch, new_mass * new_corners.mean(axis=1))

    growth = np.divide(mass_after, mass_before, out=np.zeros(patches.count), where=mass_before > 0.0)
    low, high = _extremes(patches, values, old_corners)
    bounds = np.maximum(low, limits[0]), np.minimum(high, limits[1])
    values, left = _shifted(values, weight, patches.patch, before * growth - after, bounds)
    # What went with the mass.
    moved = float(np.sum(before - before * growth) + left.sum())
    exchange = np.abs(mass_after - mass_before)
    left = np.array([moved])
    if exchange.any():
        values, left = _shifted(values, weight, patches.patch, moved * exchange / exchange.sum(), bounds)
    everywhere = np.zeros_like(patches.patch)
    values, _ = _shifted(values, weight, everywhere, left.sum(keepdims=True), bounds)
    return values


def _extremes(patches: Patches, values: Array, old_corners: Array) -> tuple[Array, Array]:
    """Least and largest value allowed to each particle of the patches, from ``values`` (k,) and old ones; both (k,)."""
    found = []
    for operation, nothing in ((np.minimum, np.inf), (np.maximum, -np.inf)):
        extreme = np.full((patches.count, 1), nothing)
        extreme = grouped(operation, extreme, patches.patch, values[:, None])
        extreme = grouped(operation, extreme, np.repeat(patches.old_patch, 3), old_corners.reshape(-1, 1))
        found.append(extreme[patches.patch, 0])
    low, high = found
    margin = _OVERSHOOT * (high - low)
    return low - margin, high + margin


def _shifted(
    values: Array, gain: Array, patch: IntArray, amount: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """``values`` (k,) shifted within ``bounds`` to add ``amount`` to each patch, and the amounts left.

    The same shift for all particles of a patch changes them least. Those that reach a bound stay there, so the others
    take more; what is left after some rounds is shared in proportion to the distance from the bound.
    """
    low, high = bounds
    for last in (*(False,) * _ROUNDS, True):
        if not amount.any():
            break
        wanted = amount[patch]
        room = np.where(wanted > 0.0, np.maximum(high - values, 0.0), np.minimum(low - values, 0.0))
        room[gain <= 0.0] = 0.0
        reach = room if last else (room != 0.0)
        capacity = np.bincount(patch, gain * reach, minlength=len(amount))
        share = np.divide(amount, capacity, out=np.zeros(len(amount)), where=capacity != 0.0)[patch]
        step = share * reach
        step = np.where(np.abs(step) < np.abs(room), step, room)
        values = values + step
        amount = amount - np.bincount(patch, gain * step, minlength=len(amount))
    return values, amount


def restore_heat(
    problem: Problem, old: Mesh, before: Fields, new: Mesh, after: Fields, remesh_map: RemeshMap
) -> Fields:
    """``after`` with the temperature corrected so that the remesh leaves the heat content of its patches.

    The content is int rho_0 / J (int c dtheta) dV with lumped masses. The temperature of the last momentum solve is
    shifted by as much, and J follows it where J comes from pressure: else the next step would expand a particle by a
    correction that is no heating.

    Parameters
    ----------
    problem
        Material, and particles with prescribed temperature, which keep theirs.
    old, before
        The old mesh and its fields.
    new, after
        The new mesh and the fields transferred to it, J included.
    remesh_map
        Of the remesh.
    """
    material, start = problem.body.material, problem.body.temperature
    patches = changed_patches(old, new, remesh_map)
    particles, cells = patches.particles, new.cells
    inside = np.zeros(len(new.points), dtype=bool)
    inside[particles] = True
    # Everything is local: the patches and the elements around them, among which are the new ones.
    around = np.flatnonzero(inside[cells].any(axis=1))
    new_among = np.searchsorted(around, patches.new)

    def enthalpy(temperature: Array) -> Array:
        return specific_enthalpy(material.capacity, temperature, start)

    old_volume = signed_areas(old.points, old.cells[patches.old]) / before.volume_ratio[patches.old]
    volume = signed_areas(new.points, cells[around]) / after.volume_ratio[around]
    corners = enthalpy(after.temperature[cells[around]])
    # A kelvin more expands elements whose J follows it, which takes mass and its heat away.
    strain = material.thermal_strain(after.momentum_temperature[cells[around]]).mean(axis=1)
    expanding = free_expansion(after.volume_ratio[around], strain) * volume * corners.mean(axis=1)
    expanding *= follows_pressure(problem, remesh_map.unchanged)[around]
    momentum = after.momentum_temperature[particles]
    strain_rate = material.thermal_strain(momentum + 1.0) - material.thermal_strain(momentum)
    mass, expansion = (lumped(each, cells[around], len(inside))[particles] for each in (volume, expanding))
    weight = np.zeros(len(inside))
    weight[particles] = mass - expansion * strain_rate / material.capacity(after.temperature[particles])
    for condition in problem.temperatures:
        weight[part_particles(problem, new, condition.part)] = 0.0

    least, most = enthalpy(np.array([before.temperature.min(), before.temperature.max()]))
    found = enthalpy(after.temperature[particles])
    wanted = conserve(
        patches,
        old_volume,
        enthalpy(before.temperature[old.cells[patches.old]]),
        volume[new_among],
        corners[new_among],
        found,
        weight[particles],
        (float(least), float(most)),
    )
    guess = after.temperature[particles]
    change = np.zeros(len(inside))
    moved = wanted != found
    change[particles[moved]] = (
        temperature_at(material.capacity, wanted[moved], start, guess[moved]) - guess[moved]
    )
    corrected = replace(
        after,
        temperature=after.temperature + change,
        momentum_temperature=after.momentum_temperature + change,
    )
    return carry_volume(problem, new, corrected, remesh_map.unchanged, around)
