"""Slip-line fields of a curled chip on a frictionless tool at rake 0; their limit is Lee and Shaffer's straight chip.

Rigid, perfectly plastic (shear yield stress k), plane strain. The tool rests, its rake face is x = 0, y > 0, its sharp
tip A the origin; the workpiece moves in +x with V and the chip turns as a rigid body with the angular velocity w. The
slip lines of one family (t) run from the tip to the free surface, those of the other (n) from the chip to the rake:

    A-D-C  the primary line, a t-line along which the velocity jumps by the constant J; D-C separates workpiece and
           chip and is therefore an arc of radius J / w;
    D-E-B  an n-line from D to the end B of contact, on which the chip is carried;
    A-E-B  next to the rake, which slip lines meet at 45 degrees;
    A-D-E  a fan of the angle psi about the tip.

This is the class of Kudo (Int. J. Mech. Sci. 7, 1965, 43) and Dewhurst (Proc. R. Soc. A 360, 1978, 587), derived anew
from Hencky's and Geiringer's equations. Angles chi of the field are measured from the directions at the rake (t at 135,
n at 45 degrees). With delta the turn of the slip lines from the rake to D: chi_D = psi - delta; p - 2 k chi is constant
along t-lines, p + 2 k chi along n-lines. Chords of slip lines have the mean direction of their ends (second order).
Positions are linear in the lengths s_j of the chords of D-E-B, velocities likewise (the chip's rotation makes the
increment of velocity w s_j there); the s_j follow from A being one point and from the jump J along D-A being constant.
The pressure at D, the arc's angle theta and delta follow from the chip having no resultant force nor moment: for each
fan psi there is one solution, and psi = 0 is Lee and Shaffer's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]
Direction = Callable[[float], Array]

ARC_CHORDS = 200


def t_direction(chi: float) -> Array:
    """Unit vector along a t-line, from the tip to the free surface; (2,)."""
    return np.array([math.cos(0.75 * math.pi + chi), math.sin(0.75 * math.pi + chi)])


def n_direction(chi: float) -> Array:
    """Unit vector along an n-line, from the chip to the rake; (2,)."""
    return np.array([math.cos(0.25 * math.pi + chi), math.sin(0.25 * math.pi + chi)])


def _turned(direction: Direction) -> Direction:
    """``direction`` turned by 90 degrees: velocity changes along a slip line are normal to it (Geiringer)."""
    return lambda chi: np.array([[0.0, -1.0], [1.0, 0.0]]) @ direction(chi)


@dataclass(frozen=True)
class Field:
    """A field with w = 1 and J = 1, so that the arc D-C has the radius 1.

    Points (i, j) are i chords from D towards the tip and j chords from D towards the rake, (rows, columns); those of
    i + j > columns - 1 lie beyond the rake and are nan.

    Attributes
    ----------
    chi
        Angle of the slip lines (rad); (N + 1, M + N + 1).
    points, velocity
        (N + 1, M + N + 1, 2).
    chords
        Lengths s_j along D-E-B; (M + N,).
    speed
        V.
    """

    chi: Array
    points: Array
    velocity: Array
    chords: Array
    speed: float


def field(delta: float, psi: float, turns: int = 20, fan: int = 12) -> Field:
    """The field of the angles ``delta`` and ``psi`` > 0 (rad) with ``turns`` and ``fan`` chords for them."""
    rows, last = turns + 1, fan + turns
    along_i = delta * np.arange(rows) / turns
    along_j = np.concatenate([-psi * np.arange(fan + 1) / fan, -psi + delta * np.arange(1, rows) / turns])
    chi = psi - delta + along_i[:, None] + along_j
    columns = last + 1  # unknown chords, then the constant J = 1

    def march(n: Direction, t: Direction) -> Array:
        """Grid (rows, last + 1, 2, columns) with chord j of D-E-B of unit length, and the rake at x = 0."""
        grid = np.full((rows, last + 1, 2, columns), np.nan)
        grid[0, 0] = 0.0
        for j in range(last):
            grid[0, j + 1] = grid[0, j]
            grid[0, j + 1, :, j] += n(0.5 * (chi[0, j] + chi[0, j + 1]))
        grid[0, :, 0] -= grid[0, last, 0].copy()
        for i in range(1, rows):
            end = last - i
            direction = t(0.5 * (chi[i - 1, end] + chi[i, end]))
            before = grid[i - 1, end]
            grid[i, end] = before - np.outer(direction, before[0] / direction[0])
            for j in range(end - 1, -1, -1):
                grid[i, j] = _meet(
                    grid[i - 1, j],
                    t(0.5 * (chi[i - 1, j] + chi[i, j])),
                    grid[i, j + 1],
                    n(0.5 * (chi[i, j] + chi[i, j + 1])),
                )
        return grid

    points = march(n_direction, t_direction)
    velocity = march(_turned(n_direction), _turned(t_direction))
    conditions = []
    for j in range(fan):
        direction = n_direction(0.5 * (chi[-1, j] + chi[-1, j + 1]))
        conditions.append(direction @ (points[-1, j + 1] - points[-1, j]))
    for i in range(turns):
        direction = _turned(t_direction)(0.5 * (chi[i, 0] + chi[i + 1, 0]))
        row = direction @ (velocity[i + 1, 0] - velocity[i, 0])
        row[-1] -= 2.0 * math.sin(0.5 * (chi[i + 1, 0] - chi[i, 0]))
        conditions.append(row)
    system = np.array(conditions)
    chords = np.linalg.solve(system[:, :-1], -system[:, -1])
    found = np.append(chords, 1.0)
    x, v = points @ found, velocity @ found
    x[..., 1] -= x[-1, fan, 1]
    jump = t_direction(float(chi[0, 0]))
    v[..., 1] += jump[1] - v[0, 0, 1]
    return Field(chi, x, v, chords, float(v[0, 0, 0] - jump[0]))


def _meet(a: Array, along_a: Array, b: Array, along_b: Array) -> Array:
    """Where the lines through ``a`` and ``b`` (2, columns) cross, column by column."""
    cross = along_a[0] * along_b[1] - along_a[1] * along_b[0]
    distance = ((b - a)[0] * along_b[1] - (b - a)[1] * along_b[0]) / cross
    return a + np.outer(along_a, distance)


def chip_forces(of: Field) -> tuple[Array, Array]:
    """Force on the chip across D-E-B and its moment about D for k = 1: (fx, fy, moment) as p_D times the first
    plus the second; both (3,)."""
    middle, chi_d = 0.5 * (of.chi[0, 1:] + of.chi[0, :-1]), of.chi[0, 0]
    by_pressure, rest = np.zeros(3), np.zeros(3)
    for chi, length, a, b in zip(middle, of.chords, of.points[0], of.points[0, 1:], strict=False):
        arm = 0.5 * (a + b) - of.points[0, 0]
        for total, force in (
            (by_pressure, t_direction(chi)),
            (rest, -2.0 * (chi - chi_d) * t_direction(chi) - n_direction(chi)),
        ):
            total += length * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
    return by_pressure, rest


def arc_forces(chi_d: float, theta: float) -> tuple[Array, Array]:
    """The same across the arc D-C of the angle ``theta`` (rad)."""
    by_pressure, rest = np.zeros(3), np.zeros(3)
    for chi in chi_d + theta * (np.arange(ARC_CHORDS) + 0.5) / ARC_CHORDS:
        arm = n_direction(chi) - n_direction(chi_d)
        for total, force in (
            (by_pressure, n_direction(chi)),
            (rest, 2.0 * (chi - chi_d) * n_direction(chi) - t_direction(chi)),
        ):
            total += theta / ARC_CHORDS * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
    return by_pressure, rest


def free_chip(of: Field) -> tuple[float, float, float]:
    """Arc angle theta and p_D / k for which no force acts on the chip, and the moment that is left."""

    def unbalanced(theta: float) -> tuple[float, float, float]:
        parts = zip(chip_forces(of), arc_forces(float(of.chi[0, 0]), theta), strict=True)
        by_pressure, rest = (a + b for a, b in parts)
        pressure = -float(by_pressure[:2] @ rest[:2] / (by_pressure[:2] @ by_pressure[:2]))
        cross = float(by_pressure[0] * rest[1] - by_pressure[1] * rest[0])
        return cross, pressure, float(by_pressure[2] * pressure + rest[2])

    size = float(of.chords.sum())
    theta = brentq(lambda angle: unbalanced(angle)[0], 0.2 * size, 3.0 * size, xtol=1e-14)
    return float(theta), *unbalanced(theta)[1:]


@dataclass(frozen=True)
class CurledChip:
    """Figures of one solution, lengths relative to the depth of cut t, velocities to V, pressures to k.

    Attributes
    ----------
    psi, delta, theta
        Angles of the field (rad).
    thickness, contact_length, curvature
        Of the chip, along the rake, and of the chip's mid-line, times 1/t, 1/t and t.
    cutting_force
        Over 2 k t (Lee and Shaffer: 1).
    tip_pressure, end_pressure
        On the rake at A and B over 2 k.
    primary_angle
        Of the chord A-C with the cutting direction (degrees).
    surface_pressure, surface_limit
        p at C on the primary line, and the most that the rigid corner of the workpiece there bears, 1 - 2 chi_C (a
        fan from the unloaded surface to the line; after Hill, J. Mech. Phys. Solids 3, 1954, 47).
    flux_error, power_error
        Of chip speed x thickness against V t, and of plastic power against F V.
    """

    psi: float
    delta: float
    theta: float
    thickness: float
    contact_length: float
    curvature: float
    cutting_force: float
    tip_pressure: float
    end_pressure: float
    primary_angle: float
    surface_pressure: float
    surface_limit: float
    flux_error: float
    power_error: float


def curled_chip(psi: float, turns: int = 20, fan: int = 12) -> CurledChip:
    """The solution with the fan ``psi`` (rad), from about 2.5 to 20 degrees."""

    def moment(delta: float) -> float:
        of = field(delta, psi, turns, fan)
        return free_chip(of)[2] / float(of.chords.sum()) ** 2

    delta = float(brentq(moment, math.radians(0.1), math.radians(12.0), xtol=1e-10))
    of = field(delta, psi, turns, fan)
    theta, pressure, _ = free_chip(of)
    chi_d = float(of.chi[0, 0])
    end = of.points[0, 0] - n_direction(chi_d) + n_direction(chi_d + theta)
    depth = float(end[1])
    # The chip turns about the point at rest, x - O = -(e_z x v) / w.
    v = of.velocity[0, 0]
    centre = of.points[0, 0] - np.array([v[1], -v[0]])
    inner, outer = (float(np.hypot(*(point - centre))) for point in (end, of.points[0, -1]))
    rows = np.arange(len(of.chi))
    on_rake = (rows, of.chi.shape[1] - 1 - rows)
    # Normal stress on the rake, p + k, with p from D along the n-line and then along the t-line.
    along_n = pressure - 2.0 * (of.chi[0, on_rake[1]] - chi_d)
    normal = along_n + 2.0 * (of.chi[on_rake] - of.chi[0, on_rake[1]]) + 1.0
    height = of.points[on_rake][:, 1]
    force = -float(np.sum(0.5 * (normal[1:] + normal[:-1]) * np.diff(height)))
    return CurledChip(
        psi,
        delta,
        theta,
        thickness=(outer - inner) / depth,
        contact_length=float(height[0]) / depth,
        curvature=2.0 * depth / (outer + inner),
        cutting_force=force / (2.0 * depth),
        tip_pressure=float(normal[-1]) / 2.0,
        end_pressure=float(normal[0]) / 2.0,
        primary_angle=math.degrees(math.atan2(end[1], -end[0])),
        surface_pressure=pressure + 2.0 * theta,
        surface_limit=1.0 - 2.0 * (chi_d + theta),
        flux_error=0.5 * (outer**2 - inner**2) / (of.speed * depth) - 1.0,
        power_error=plastic_power(of, theta) / (force * of.speed) - 1.0,
    )


def plastic_power(of: Field, theta: float) -> float:
    """Power dissipated on the primary line and in the field, for k = J = w = 1."""
    primary = float(np.hypot(*np.diff(of.points[:, 0], axis=0).T).sum()) + theta
    total = primary
    rows, columns = of.chi.shape
    for i in range(rows - 1):
        for j in range(columns - 1 - i):
            corner = of.points[i, j], of.velocity[i, j]
            to_tip, to_rake = of.points[i + 1, j] - corner[0], of.points[i, j + 1] - corner[0]
            by_tip, by_rake = of.velocity[i + 1, j] - corner[1], of.velocity[i, j + 1] - corner[1]
            # Shear rate times area: slip lines do not stretch, so the change along each is across it.
            t, n = t_direction(of.chi[i, j]), n_direction(of.chi[i, j])
            sheared = (by_rake @ t) * abs(to_tip @ t) - (by_tip @ n) * abs(to_rake @ n)
            whole = i + j < columns - 2
            total += sheared if whole else 0.5 * sheared
    return total
