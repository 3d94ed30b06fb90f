"""Penalty contact of boundary particles with the analytic rigid tool (paper, section 5.1.2, eqs. 14, 15, 26, 33)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pfemcut.contact.friction import Interface
from pfemcut.contact.surface import Surface
from pfemcut.problem import ContactLaw
from pfemcut.tools.rigid_wedge import RigidWedge

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class ContactForces:
    """What the tool does to the candidate particles; all per mm of width.

    Attributes
    ----------
    gap
        Signed distance to the tool (mm); shape (k,).
    forces
        Force on the body (N/mm); shape (k, 2).
    stiffness
        Minus its derivative by the displacement; shape (k, 2, 2).
    normal_force, shear_force
        Magnitude of the normal force, and the tangential force along the tool's tangent (N/mm); shape (k,).
    slip_speed
        Tangential speed relative to the tool (mm/s); shape (k,).
    friction_power
        Heat of friction (mW/mm); shape (k,).
    energy
        Energy stored in the penalty springs (mJ/mm); shape (k,).
    """

    gap: Array
    forces: Array
    stiffness: Array
    normal_force: Array
    shear_force: Array
    slip_speed: Array
    friction_power: Array
    energy: Array


def contact_forces(
    tool: RigidWedge,
    law: ContactLaw,
    positions: Array,
    slip: Array,
    lengths: Array,
    step: float,
    known_slip_speed: Array,
    temperature: Array,
    flow_stress: Array,
) -> ContactForces:
    """Forces on particles at ``positions`` with the tool where it is at the end of the step.

    Normal force eps L |g| along the tool's normal where the gap g is negative, with the tributary length L, so that
    the traction does not depend on the spacing; shear force by the law of friction, against the slip.

    Parameters
    ----------
    tool
        Tool at the end of the step.
    law
        Penalty and friction.
    positions
        Particle positions at the end of the step (mm); shape (k, 2).
    slip
        Displacement relative to the tool over the step (mm); shape (k, 2).
    lengths
        Tributary boundary length of each particle (mm); shape (k,).
    step
        Time step (s).
    known_slip_speed, temperature, flow_stress
        Of the particles, last known (mm/s, K, MPa); shape (k,).
    """
    closest = tool.closest(positions)
    normal = closest.normal
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    depth = np.maximum(-closest.gap, 0.0)
    touching = depth > 0.0
    stiffness = np.where(touching, law.penalty * lengths, 0.0)
    normal_force = stiffness * depth
    slip_speed = np.sum(slip * tangent, axis=1) / step
    interface = Interface(law.penalty * depth, slip_speed, known_slip_speed, temperature, flow_stress)
    shear = law.friction.shear(interface, law.reference_speed)
    shear_force = np.where(touching, -shear.value * lengths, 0.0)

    nn = _outer(normal, normal)
    tt = _outer(tangent, tangent)
    tn = _outer(tangent, normal)
    nt = _outer(normal, tangent)
    curvature = closest.curvature
    # d(normal force)/dx = -stiffness n, dn/dx = curvature t t, dt/dx = -curvature n t,
    # d(slip speed)/dx = t / step - curvature (slip . n) t / step.
    normal_slip = np.sum(slip * normal, axis=1)
    speed_slope = (1.0 - curvature * normal_slip) / step
    derivative = (
        -stiffness[:, None, None] * nn
        + (normal_force * curvature)[:, None, None] * tt
        + (shear.by_pressure * stiffness)[:, None, None] * tn
        - (lengths * touching * shear.by_speed * speed_slope)[:, None, None] * tt
        - (shear_force * curvature)[:, None, None] * nt
    )
    return ContactForces(
        gap=closest.gap,
        forces=normal_force[:, None] * normal + shear_force[:, None] * tangent,
        stiffness=-derivative,
        normal_force=normal_force,
        shear_force=shear_force,
        slip_speed=slip_speed,
        friction_power=-shear_force * slip_speed,
        energy=0.5 * normal_force * depth,
    )


def facing_lengths(tool: Surface, points: Array, edges: IntArray) -> Array:
    """Tributary boundary length (mm) of each particle that faces the tool; shape (n,).

    Half of each boundary edge at the particle, projected on the tool's tangent there, if the body lies on the far side
    of it. So the edge behind a corner, which the tool does not touch, does not stiffen the contact of the corner.

    Parameters
    ----------
    tool
        The tool, or another surface.
    points
        Particle positions (mm); shape (n, 2).
    edges
        Boundary edges with the body on their left; shape (b, 2).
    """
    along = points[edges[:, 1]] - points[edges[:, 0]]
    outward = np.column_stack([along[:, 1], -along[:, 0]])  # times the edge's length
    lengths = np.zeros(len(points))
    for ends in edges.T:
        normal = tool.closest(points[ends]).normal
        half = 0.5 * np.maximum(-np.sum(outward * normal, axis=1), 0.0)
        lengths += np.bincount(ends, half, minlength=len(points))
    return lengths


def _outer(a: Array, b: Array) -> Array:
    return a[:, :, None] * b[:, None, :]
