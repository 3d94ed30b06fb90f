"""Sources that move over the surface of a half space: exact, quasi-steady, and backward Euler in time.

The half space is y <= 0 with an adiabatic surface outside the source; the source starts at time zero. All follow from
the instantaneous line source (Carslaw and Jaeger, Conduction of Heat in Solids, 2nd ed. 1959, section 10.3), doubled by
its image. Quasi-steady: Rosenthal (Trans. ASME 68, 1946, 849), Jaeger (Proc. R. Soc. NSW 76, 1942, 203); in
Carslaw and Jaeger section 10.7, eqs. (2) and (11).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad_vec
from scipy.special import erf, gammaln, k0e

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """A band source; a line source if its half-width is zero.

    Attributes
    ----------
    power
        Heat input per mm of width (mW/mm).
    half_width
        mm.
    velocity
        In x (mm/s); the centre is at x = 0 at time zero.
    conductivity, diffusivity
        N/(s K) and mm²/s.
    """

    power: float
    half_width: float
    velocity: float
    conductivity: float
    diffusivity: float

    def _kernel(self, x: Array, y: Array, age: float, centre: Array | float) -> Array:
        """Rise (K) from a unit of time's heat, given off ``age`` (s) ago at ``centre`` (mm)."""
        spread = np.sqrt(4.0 * self.diffusivity * age)
        if self.half_width:
            a, b = (x - centre + self.half_width) / spread, (x - centre - self.half_width) / spread
            along = (erf(a) - erf(b)) / (4.0 * self.half_width)
        else:
            along = np.exp(-(((x - centre) / spread) ** 2)) / (np.sqrt(np.pi) * spread)
        across = 2.0 / (np.sqrt(np.pi) * spread) * np.exp(-((y / spread) ** 2))
        return self.power * self.diffusivity / self.conductivity * along * across

    def _ages(self, end: float) -> tuple[Array, Array]:
        """Quadrature points and weights for ages, graded towards zero as their squares."""
        nodes, weights = np.polynomial.legendre.leggauss(20)
        edges = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 30)]) * np.sqrt(end)
        half = 0.5 * np.diff(edges)[:, None]
        root = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * nodes).ravel()
        return root**2, (2.0 * root * (half * weights).ravel())

    def transient(self, x: Array, y: Array, time: float) -> Array:
        """Rise (K) at ``time`` (s)."""
        total = np.zeros_like(x)
        for age, weight in zip(*self._ages(time), strict=True):
            total += weight * self._kernel(x, y, age, self.velocity * (time - age))
        return total

    def quasi_steady(self, xi: Array, y: Array) -> Array:
        """Rise (K) at the distance ``xi`` (mm) from the centre of a source that has moved for ever."""
        scale = abs(self.velocity) / (2.0 * self.diffusivity)
        ahead = xi * np.sign(self.velocity)

        def line(shift: float) -> Array:
            radius = np.maximum(np.hypot(ahead - shift, y), 1e-12)
            # exp(-u) K0(r) = exp(-u - r) k0e(r), which does not overflow
            return np.exp(-scale * (ahead - shift + radius)) * k0e(scale * radius)

        if not self.half_width:
            return self.power / (np.pi * self.conductivity) * line(0.0)
        # The logarithm's singularities lie at the points themselves: enough points for a figure, not for round-off.
        integral, _ = quad_vec(line, -self.half_width, self.half_width, epsrel=1e-5, limit=400)
        return self.power / (2.0 * self.half_width * np.pi * self.conductivity) * integral

    def backward_euler(self, x: Array, y: Array, steps: int, step: float) -> Array:
        """Rise (K) after ``steps`` backward-Euler steps (s), exact in space.

        A step's heat has spread, k steps later, like the kernel averaged over ages with a gamma density of shape k and
        scale ``step``.
        """
        total = np.zeros_like(x)
        k = np.arange(1, steps + 1)
        centres = self.velocity * step * (steps - k + 1)
        last = steps * step * (1.0 + 8.0 / np.sqrt(steps))
        for age, weight in zip(*self._ages(last), strict=True):
            ratio = age / step
            density = np.exp((k - 1) * np.log(ratio) - ratio - gammaln(k))  # times the step
            used = density > 1e-9 * density.max()
            for share, centre in zip(density[used], centres[used], strict=True):
                total += weight * share * self._kernel(x, y, age, centre)
        return total
