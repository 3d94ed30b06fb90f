"""Penalty contact between the surfaces of two meshed bodies (paper, section 5.2, eqs. 16-28), with its exact tangent.

A contact point q = S_1 x_1 + S_2 x_2 of the slave surface (a particle, or a quadrature point of a boundary edge) is
held off the master surface x(t) = N_1 x_3 + N_2 x_4 + N_3 x_5 at its foot, r . x'(t) = 0 with r = q - x(t). With the
shape functions c = (S, -N) of the five particles and d = dc/dt,

    g = r . n,    dg = n . c_i dx_i,    dt = (c_i x' - d_i g n) . dx_i / (|x'|² - g n . x''),

    forces on the five particles:  P_N c_i n  (eqs. 22, 23)  and  P_T m_i,  m_i = c_i a - d_i (g / |x'|) n

with the unit tangent a = x'/|x'|, P_N = eps L max(D - g, 0), and P_T by the friction law for the slip speed
v = m_i . u_i / dt (u_i is what the particles move in the step). Bodies touch at the distance D: zero between bodies,
the contact thickness where a body touches itself. The second term of m_i, which eqs. 27 and 28 lack, is the turn of
the normal: without it a rigid rotation of both surfaces would slip, and the shear forces, at the distance g from each
other, would have a moment. So forces and moments balance, and the power of P_T is exactly P_T v.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.contact.surface import Arcs, Foot, feet

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

Friction = Callable[[Array, Array, IntArray], tuple[Array, Array, Array]]
"""From pressure (MPa), slip speed (mm/s) and which points touch to the shear traction (MPa) against the slip and its
derivatives by pressure and slip speed."""


@dataclass(frozen=True)
class ContactPoints:
    """Points of the slave surface that may touch, and where they look for their feet.

    Attributes
    ----------
    particles
        Slave particles of each point; shape (k, 2).
    shares
        Their shape functions there; shape (k, 2).
    lengths
        Length of surface that each point stands for (mm); shape (k,).
    candidates
        Arcs of the master surface among which the foot is; shape (k, w).
    thickness
        Distance D at which each touches (mm); shape (k,).
    """

    particles: IntArray
    shares: Array
    lengths: Array
    candidates: IntArray
    thickness: Array

    @staticmethod
    def at_no_distance(
        particles: IntArray, shares: Array, lengths: Array, candidates: IntArray
    ) -> ContactPoints:
        """Points that touch where the surfaces meet."""
        return ContactPoints(particles, shares, lengths, candidates, np.zeros(len(lengths)))


@dataclass(frozen=True)
class SurfaceContact:
    """Contact at one iterate, of the points that touch; all per mm of width.

    Attributes
    ----------
    points
        Which of the contact points these are; shape (k,).
    foot
        Their feet.
    particles, shape
        The five particles and their shape functions c; shape (k, 5).
    forces
        On them (N/mm); shape (k, 5, 2).
    stiffness
        Minus the derivative of the forces by the displacements; shape (k, 5, 2, 5, 2).
    normal_force, shear_force
        P_N, and P_T along the master's tangent (N/mm); shape (k,).
    lengths
        Length of surface that each point stands for (mm); shape (k,).
    slip_speed
        mm/s; shape (k,).
    friction_power
        Heat of friction (mW/mm); shape (k,).
    energy
        Stored in the penalty springs (mJ/mm); shape (k,).
    """

    points: IntArray
    foot: Foot
    particles: IntArray
    shape: Array
    forces: Array
    stiffness: Array
    normal_force: Array
    shear_force: Array
    lengths: Array
    slip_speed: Array
    friction_power: Array
    energy: Array


def surface_contact(
    arcs: Arcs,
    points: ContactPoints,
    positions: Array,
    displacement: Array,
    step: float,
    penalty: float,
    friction: Friction,
) -> SurfaceContact:
    """Contact of ``points`` with the particles at ``positions`` (n, 2), reached by ``displacement`` in ``step`` (s).

    ``penalty`` is eps (MPa/mm).
    """
    at = np.einsum("kb,kbi->ki", points.shares, positions[points.particles])
    foot = feet(arcs, positions, at, points.candidates)
    near = (foot.gap < points.thickness) & ~foot.beyond
    touching = np.flatnonzero(near & (points.lengths > 0.0))
    foot = Foot(foot.arc[touching], foot.t[touching], foot.gap[touching], foot.beyond[touching])
    count = len(touching)
    master = arcs.nodes[foot.arc]
    n_a, slope, bend = arcs.at(foot.arc, foot.t)
    corners = positions[master]
    tangent = np.einsum("ka,kai->ki", slope, corners)
    second = np.einsum("ka,kai->ki", bend, corners)
    speed = np.hypot(*tangent.T)
    along = tangent / speed[:, None]
    normal = np.column_stack([along[:, 1], -along[:, 0]])
    particles = np.column_stack([points.particles[touching], master])
    c = np.column_stack([points.shares[touching], -n_a])
    d = np.column_stack([np.zeros((count, 2)), -slope])
    lengths = points.lengths[touching]
    u = displacement[particles]

    gap = foot.gap
    closure = points.thickness[touching] - gap
    pressure = penalty * closure
    normal_force = lengths * pressure
    slip = np.einsum("ka,kai->ki", c, u)
    spin = np.einsum("ka,kai->ki", d, u)
    lever = gap / speed
    slip_speed = (np.sum(slip * along, axis=1) - lever * np.sum(spin * normal, axis=1)) / step
    shear, by_pressure, by_speed = friction(pressure, slip_speed, touching)
    shear_force = -lengths * shear

    # Gradients by the positions of the five particles, (k, 10).
    def by_x(factor: Array, direction: Array) -> Array:
        return (factor[:, :, None] * direction[:, None, :]).reshape(count, 10)

    def per_point(values: Array, gradient: Array) -> Array:
        return values[:, None] * gradient

    gap_x = by_x(c, normal)
    bent = np.sum(normal * second, axis=1)
    t_x = per_point(1.0 / (speed**2 - gap * bent), by_x(c, tangent) - by_x(d * gap[:, None], normal))
    # The change of x' is -d_i dx_i + x'' dt: along a it stretches, along n it turns a towards n and n back.
    turn_x = per_point(1.0 / speed, per_point(bent, t_x) - by_x(d, normal))
    speed_x = per_point(np.sum(along * second, axis=1), t_x) - by_x(d, along)
    lever_x = per_point(1.0 / speed, gap_x - per_point(lever, speed_x))
    e = np.column_stack([np.zeros((count, 2)), -bend])
    spin_n, spin_a = np.sum(spin * normal, axis=1), np.sum(spin * along, axis=1)
    curl_n = np.einsum("ka,kai,ki->k", e, u, normal)
    slip_x = by_x(c, along) - by_x(d * lever[:, None], normal) - per_point(spin_n, lever_x)
    slip_x += per_point(spin_a - lever * curl_n, t_x)
    slip_x += per_point(np.sum(slip * normal, axis=1) + lever * spin_a, turn_x)
    normal_x = per_point(-penalty * lengths, gap_x)
    shear_x = per_point(by_pressure, per_point(-penalty * lengths, gap_x))
    shear_x = -shear_x - per_point(lengths * by_speed / step, slip_x)

    # F_i = c_i (P_N n + P_T a) - d_i lever P_T n:  dn = -turn a,  da = turn n,  dc_i = d_i dt,  dd_i = e_i dt.
    total = normal_force[:, None] * normal + shear_force[:, None] * along
    turned = -normal_force[:, None] * along + shear_force[:, None] * normal
    couple = (lever * shear_force)[:, None]
    change = _outer(normal, normal_x) + _outer(along, shear_x) + _outer(turned, turn_x)
    couple_x = per_point(shear_force, lever_x) + per_point(lever, shear_x)
    change_d = _outer(total, t_x) - _outer(normal, couple_x) + _outer(couple * along, turn_x)
    derivative = (
        c[:, :, None, None] * change[:, None]
        + d[:, :, None, None] * change_d[:, None]
        - e[:, :, None, None] * _outer(couple * normal, t_x)[:, None]
    )
    return SurfaceContact(
        points=touching,
        foot=foot,
        particles=particles,
        shape=c,
        forces=c[:, :, None] * total[:, None, :] - d[:, :, None] * (couple * normal)[:, None, :],
        stiffness=-derivative.reshape(count, 5, 2, 5, 2),
        normal_force=normal_force,
        shear_force=shear_force,
        lengths=lengths,
        slip_speed=slip_speed,
        friction_power=-shear_force * slip_speed,
        energy=0.5 * normal_force * closure,
    )


def _outer(a: Array, b: Array) -> Array:
    return a[:, :, None] * b[:, None, :]
