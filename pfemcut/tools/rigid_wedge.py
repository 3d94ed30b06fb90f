"""The analytic rigid tool: a wedge of two planes rounded by a tip circle (paper, section 5.1.1, Fig. 4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ToolContact:
    """Closest point on the tool for a set of points.

    Attributes
    ----------
    gap
        Signed distance to the tool surface (mm), negative inside the tool; shape (n,).
    normal
        Outward unit normal of the tool at the closest point; shape (n, 2).
    curvature
        Curvature of the level set of the distance through the point (1/mm), zero on the planes; shape (n,).
    """

    gap: Array
    normal: Array
    curvature: Array


@dataclass(frozen=True)
class RigidWedge:
    """Rigid cutting tool whose rake and flank planes are tangent to a tip circle.

    The tool advances towards -x. Rake angle is positive when the rake face leans away from the uncut
    material, clearance is the angle between the flank face and the machined surface.

    Attributes
    ----------
    centre
        Centre of the tip circle (mm).
    rake, clearance
        Angles (degrees).
    tip_radius
        Radius of the tip circle (mm).
    """

    centre: tuple[float, float]
    rake: float
    clearance: float
    tip_radius: float

    @property
    def rake_direction(self) -> Array:
        """Unit vector up the rake face, away from the tip; shape (2,)."""
        gamma = math.radians(self.rake)
        return np.array([math.sin(gamma), math.cos(gamma)])

    @property
    def rake_normal(self) -> Array:
        """Outward unit normal of the rake face, towards the chip; shape (2,)."""
        gamma = math.radians(self.rake)
        return np.array([-math.cos(gamma), math.sin(gamma)])

    @property
    def flank_direction(self) -> Array:
        """Unit vector along the flank face, away from the tip; shape (2,)."""
        alpha = math.radians(self.clearance)
        return np.array([math.cos(alpha), math.sin(alpha)])

    @property
    def flank_normal(self) -> Array:
        """Outward unit normal of the flank face, towards the machined surface; shape (2,)."""
        alpha = math.radians(self.clearance)
        return np.array([math.sin(alpha), -math.cos(alpha)])

    @property
    def rake_tangent_point(self) -> Array:
        """Point where the tip circle meets the rake face (mm); shape (2,)."""
        return np.asarray(self.centre) + self.tip_radius * self.rake_normal

    @property
    def flank_tangent_point(self) -> Array:
        """Point where the tip circle meets the flank face (mm); shape (2,)."""
        return np.asarray(self.centre) + self.tip_radius * self.flank_normal

    @property
    def arc_angle(self) -> float:
        """Angle (rad) of the tip circle's arc between the rake and the flank tangent points."""
        return math.pi / 2.0 + math.radians(self.rake + self.clearance)

    def moved(self, shift: Array) -> RigidWedge:
        """The same tool, translated by ``shift`` (2,)."""
        x, y = self.centre
        return RigidWedge(
            (x + float(shift[0]), y + float(shift[1])), self.rake, self.clearance, self.tip_radius
        )

    def closest(self, points: Array) -> ToolContact:
        """Signed distance, normal and curvature at ``points`` (n, 2).

        The tool is the Minkowski sum of a sharp wedge with its apex in ``centre`` and a disc, so outside the
        sector of the two face normals the nearest feature is a face, inside it the tip circle.
        """
        offset = points - np.asarray(self.centre)
        along_rake = offset @ self.rake_direction
        along_flank = offset @ self.flank_direction
        above_rake = offset @ self.rake_normal
        above_flank = offset @ self.flank_normal
        radius = np.hypot(offset[:, 0], offset[:, 1])
        # Deep inside the wedge both faces claim the point: the nearer one (larger signed distance) wins.
        on_rake = (along_rake > 0.0) & ((along_flank <= 0.0) | (above_rake >= above_flank))
        on_flank = (along_flank > 0.0) & ~on_rake
        on_tip = ~(on_rake | on_flank)

        normal = np.empty_like(offset)
        normal[on_rake] = self.rake_normal
        normal[on_flank] = self.flank_normal
        safe = np.maximum(radius, 1e-300)
        normal[on_tip] = offset[on_tip] / safe[on_tip, None]
        gap = np.where(on_rake, above_rake, np.where(on_flank, above_flank, radius)) - self.tip_radius
        curvature = np.where(on_tip, 1.0 / safe, 0.0)
        return ToolContact(gap, normal, curvature)

    def arc_length(self, points: Array) -> Array:
        """Signed arc length (mm) along the tool surface of the points' closest points; shape (n,).

        Zero at ``rake_tangent_point``, positive up the rake face, negative round the tip and along the flank.
        """
        offset = points - np.asarray(self.centre)
        along_rake = offset @ self.rake_direction
        along_flank = offset @ self.flank_direction
        on_rake = (along_rake > 0.0) & (
            (along_flank <= 0.0) | (offset @ self.rake_normal >= offset @ self.flank_normal)
        )
        on_flank = (along_flank > 0.0) & ~on_rake
        n = self.rake_normal
        angle = np.arctan2(n[0] * offset[:, 1] - n[1] * offset[:, 0], offset @ n)
        arc = -self.tip_radius * angle
        flank = -self.tip_radius * self.arc_angle - along_flank
        return np.where(on_rake, along_rake, np.where(on_flank, flank, arc))

    def outline(self, length: float, segments: int = 32) -> Array:
        """Polyline of the tool surface (mm): down the rake face, round the tip, out along the flank; shape (k, 2)."""
        angles = np.linspace(0.0, self.arc_angle, segments)
        n, t = self.rake_normal, -self.rake_direction
        arc = np.asarray(self.centre) + self.tip_radius * (
            np.cos(angles)[:, None] * n + np.sin(angles)[:, None] * t
        )
        top = self.rake_tangent_point + length * self.rake_direction
        back = self.flank_tangent_point + length * self.flank_direction
        return np.vstack([top, arc, back])
