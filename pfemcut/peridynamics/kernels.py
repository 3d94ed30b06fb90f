"""Compiled loops: many time steps of the lattice, with failing bonds.

Each parallel loop gathers into its own site's entries, in their order, and sums over sites are taken in one thread, so
results do not depend on the number of threads. Of the six families of bonds, at 60 degrees times their number from the
fibre, 0 and 3 are along it. One compiled function holds all parallel loops: numba 0.56 can't load one from its cache
that calls another.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

STRETCH, MIXED_MODE = 0, 1
"""Numbers of the failure criteria."""


@njit(parallel=True, cache=True)
def run_steps(  # type: ignore[no-untyped-def]
    steps, dt, time, bonds, material, motion, weak, u, v, force, alive, broken_at, doomed, energy
):
    """Advance ``steps`` steps of ``dt`` (s) from ``time`` (s); arrays are changed in place.

    The leapfrog in its velocity form (Verlet 1967): half a kick, a drift, forces and breaking at the new places, half a
    kick. The two half kicks between two drifts are one.

    Parameters
    ----------
    steps, dt, time
        See above.
    bonds
        Offsets (n + 1,), indices, reverse and family (k,) of the entries, vectors xi of the families (mm; (6, 2)).
    material
        Stiffness of the families (N/mm; (6,)), spacing R (mm), limits of failure (see :func:`_site_force`), mass of a
        site (tonne), and the dashpots' time constant (s).
    motion
        1 for free components (n, 2), sites of the left and of the right grip, and the grips' velocities (mm/s; (2, 2)).
    weak
        Whether bonds may fail as seen from a site; shape (n,).
    u, v, force
        Displacements (mm), velocities (mm/s) and forces (N); shape (n, 2).
    alive, broken_at
        Whether entries are whole, and the time at which they broke (s), infinite while whole; shape (k,).
    doomed
        Entries that have failed; shape (k,).
    energy
        Energy (mJ) that each site's bonds took when they broke, and that its dashpots took; shape (n, 2).

    Returns
    -------
    Mean force of the bonds on the sites of each grip (N), shape (2, 2); work of the grips (mJ).
    """
    offsets, indices, reverse, family, vector = bonds
    stiffness, spacing, limits, mass, damping = material
    free, left, right, grip_velocity = motion
    before, felt, mean = np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((2, 2))
    work = 0.0
    _reactions(left, right, force, before)
    for step in range(steps):
        kick = (0.5 if step == 0 else 1.0) * dt / mass
        for i in prange(len(u)):
            v[i, 0] += kick * free[i, 0] * force[i, 0]
            v[i, 1] += kick * free[i, 1] * force[i, 1]
            u[i, 0] += dt * v[i, 0]
            u[i, 1] += dt * v[i, 1]
        time += dt
        hits = 0
        for i in prange(len(u)):
            hits += _site_force(
                i, offsets, indices, family, vector, stiffness, spacing, limits, damping, dt,
                weak, u, v, alive, force, doomed, energy,
            )  # fmt: skip
        if hits > 0:
            for i in prange(len(u)):
                _break_site(
                    i, offsets, indices, reverse, family, vector, stiffness, spacing, damping, dt, time,
                    u, v, alive, broken_at, force, doomed, energy,
                )  # fmt: skip
        _reactions(left, right, force, felt)
        for side in range(2):
            for axis in range(2):
                average = 0.5 * (before[side, axis] + felt[side, axis])
                mean[side, axis] += average / steps
                work -= average * grip_velocity[side, axis] * dt
                before[side, axis] = felt[side, axis]
    kick = 0.5 * dt / mass
    for i in prange(len(u)):
        v[i, 0] += kick * free[i, 0] * force[i, 0]
        v[i, 1] += kick * free[i, 1] * force[i, 1]
    return mean, work


@njit(cache=True)
def _site_force(  # type: ignore[no-untyped-def]
    i, offsets, indices, family, vector, stiffness, spacing, limits, damping, dt,
    weak, u, v, alive, force, doomed, energy,
):  # fmt: skip
    """Force on site ``i``, and whether (1 or 0) one of its bonds fails.

    The force in a bond is k R (s + tau ds/dt) along its present direction, with s = (|xi + eta| - |xi|) / |xi|.

    Failure, ``limits`` = (criterion, 1 / s_I², 1 / s_II², the two at a crack's tip, s_f):

    - ``STRETCH``: a matrix bond fails at s >= s_I.
    - ``MIXED_MODE``: the two bonds of a site that cross the plane along the fibre on one of its sides carry that
      plane's traction, with s_I = (s_1 + s_2) / 2 the normal and s_II = (s_1 - s_2) / 2 the shear part. Both fail at
      (s_I / s_Ic)² + (s_II / s_IIc)² >= 1, without s_I if it is negative. With k_m R² (s_I² + s_II²) their energy, this
      is G_I / G_Ic + G_II / G_IIc >= 1. Where the plane is cracked next to them the lower limits of a tip hold. A bond
      alone carries half a plane's energy: s_I = s_II = s / 2, and 1/2 for 1.
    - A fibre bond fails at s >= s_f, which may be infinite.

    The limits of a tip are what keeps a crack in its plane. A row of sites along the fibre is a string, without the
    bending stiffness of the strip that it stands for, so both its sides carry the same normal traction, also at a tip:
    by their own energy alone the pair in the plane and the pair across the row fail together.
    """
    criterion, opening, shear, growth_opening, growth_shear, fibre = limits
    fx = fy = 0.0
    hit = 0
    per_spacing = 1.0 / spacing
    # Entries and stretches of the two bonds to each side of the fibre; -1 where there is none.
    right_up = left_up = left_down = right_down = -1
    s_right_up = s_left_up = s_left_down = s_right_down = 0.0
    for e in range(offsets[i], offsets[i + 1]):
        if not alive[e]:
            continue
        f, j = family[e], indices[e]
        dx, dy, length, pull, lost = _bond(i, j, f, vector, stiffness, spacing, damping, u, v)
        energy[i, 1] += lost * dt
        fx += pull * dx
        fy += pull * dy
        s = (length - spacing) * per_spacing
        if f == 1:
            right_up, s_right_up = e, s
        elif f == 2:
            left_up, s_left_up = e, s
        elif f == 4:
            left_down, s_left_down = e, s
        elif f == 5:
            right_down, s_right_down = e, s
        elif s >= fibre and weak[i]:
            doomed[e] = 1
            hit = 1
    force[i, 0], force[i, 1] = fx, fy
    if not weak[i]:
        return hit
    if criterion == MIXED_MODE:
        for up, one, s_one, other, s_other in (
            (True, right_up, s_right_up, left_up, s_left_up),
            (False, left_down, s_left_down, right_down, s_right_down),
        ):
            if _pair_fails(one, s_one, other, s_other, growth_opening, growth_shear) and (
                _pair_fails(one, s_one, other, s_other, opening, shear)
                or _at_crack(i, up, offsets, indices, family, alive)
            ):
                hit = 1
                _doom(doomed, one, other)
    else:
        for e, s in (
            (right_up, s_right_up),
            (left_up, s_left_up),
            (left_down, s_left_down),
            (right_down, s_right_down),
        ):
            if s > 0.0 and s * s * opening >= 1.0:
                hit = 1
                _doom(doomed, e, e)
    return hit


@njit(cache=True)
def _pair_fails(one, s_one, other, s_other, opening, shear):  # type: ignore[no-untyped-def]
    """Whether the bonds with entries ``one`` and ``other`` to one side of a site fail; -1 where there is none."""
    normal, slip = max(0.5 * (s_one + s_other), 0.0), 0.5 * (s_one - s_other)
    there = 0.5 * ((one >= 0) + (other >= 0))
    return there > 0.0 and normal * normal * opening + slip * slip * shear >= there


@njit(cache=True)
def _at_crack(i, up, offsets, indices, family, alive):  # type: ignore[no-untyped-def]
    """Whether a bond of site ``i`` or of its neighbours along the fibre is broken on a side, ``up`` or down."""
    for e in range(offsets[i], offsets[i + 1]):
        if family[e] % 3 == 0:
            j = indices[e]
            for q in range(offsets[j], offsets[j + 1]):
                if not alive[q] and family[q] % 3 != 0 and (family[q] < 3) == up:
                    return True
        elif not alive[e] and (family[e] < 3) == up:
            return True
    return False


@njit(cache=True)
def _doom(doomed, one, other):  # type: ignore[no-untyped-def]
    if one >= 0:
        doomed[one] = 1
    if other >= 0:
        doomed[other] = 1


@njit(inline="always")
def _bond(i, j, f, vector, stiffness, spacing, damping, u, v):  # type: ignore[no-untyped-def]
    """From ``i`` to ``j`` now, the length, the force over it, and half the power of the damping."""
    dx = vector[f, 0] + (u[j, 0] - u[i, 0])
    dy = vector[f, 1] + (u[j, 1] - u[i, 1])
    length = np.sqrt(dx * dx + dy * dy)
    pull = stiffness[f] * (length - spacing) / length
    lost = 0.0
    if damping > 0.0:
        rate = ((v[j, 0] - v[i, 0]) * dx + (v[j, 1] - v[i, 1]) * dy) / length
        pull += stiffness[f] * damping * rate / length
        lost = 0.5 * stiffness[f] * damping * rate * rate
    return dx, dy, length, pull, lost


@njit(cache=True)
def _break_site(  # type: ignore[no-untyped-def]
    i, offsets, indices, reverse, family, vector, stiffness, spacing, damping, dt, time,
    u, v, alive, broken_at, force, doomed, energy,
):  # fmt: skip
    """Break the bonds of site ``i`` that failed as seen from either end; their forces go, and half their energy."""
    for e in range(offsets[i], offsets[i + 1]):
        if alive[e] and (doomed[e] or doomed[reverse[e]]):
            alive[e] = 0
            broken_at[e] = time
            f, j = family[e], indices[e]
            dx, dy, length, pull, lost = _bond(i, j, f, vector, stiffness, spacing, damping, u, v)
            energy[i, 1] -= lost * dt
            force[i, 0] -= pull * dx
            force[i, 1] -= pull * dy
            energy[i, 0] += 0.25 * stiffness[f] * (length - spacing) ** 2


@njit(cache=True)
def _reactions(left, right, force, out):  # type: ignore[no-untyped-def]
    """Sums of ``force`` over the sites of the left and the right grip, into ``out`` (2, 2)."""
    out[:] = 0.0
    for i in left:
        out[0, 0] += force[i, 0]
        out[0, 1] += force[i, 1]
    for i in right:
        out[1, 0] += force[i, 0]
        out[1, 1] += force[i, 1]


@njit(parallel=True, cache=True)
def stored_energy(bonds, stiffness, spacing, u, alive):  # type: ignore[no-untyped-def]
    """Half the energy of each of a site's whole bonds (mJ); shape (n,). Parameters as of :func:`run_steps`."""
    offsets, indices, _, family, vector = bonds
    energy = np.zeros(len(u))
    for i in prange(len(u)):
        total = 0.0
        for e in range(offsets[i], offsets[i + 1]):
            if alive[e]:
                f, j = family[e], indices[e]
                dx = vector[f, 0] + (u[j, 0] - u[i, 0])
                dy = vector[f, 1] + (u[j, 1] - u[i, 1])
                total += 0.25 * stiffness[f] * (np.sqrt(dx * dx + dy * dy) - spacing) ** 2
        energy[i] = total
    return energy
