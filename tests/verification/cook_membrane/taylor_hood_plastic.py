"""Cook's membrane of finite-strain J2 metal with Taylor-Hood elements in numpy: the reference for the plastic case.

Total Lagrangian, quadratic displacement and linear pressure on triangles, six Gauss points, tangent by complex
steps, and so shares neither elements, forms nor return mapping with the solver under test. Constitutive law:
s = mu dev b, b = J^(-2/3) F Cp^-1 F^T (det b = 1), radial return with 2 mu tr(b)/3, Voce hardening, Kirchhoff yield;
p = kappa ln J / J. Run as a script it writes ``reference/plastic.csv``
and, for the neo-Hookean membrane at 100 N/mm, the pressure on a grid, ``reference/pressure.csv``.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
REFERENCE = Path(__file__).parent / "reference"
ROOT_2_3 = np.sqrt(2.0 / 3.0)


@dataclass(frozen=True)
class Metal:
    """Moduli and Voce hardening (MPa); an infinite yield stress makes it neo-Hookean."""

    mu: float = 80.1938e3
    kappa: float = 164.21e3
    yield_stress: float = 450.0
    saturation: float = 715.0
    hardening: float = 129.24
    exponent: float = 16.93

    def flow(self, eqps: Array) -> tuple[Array, Array]:
        """Flow stress and its derivative."""
        decay = (self.saturation - self.yield_stress) * np.exp(-self.exponent * eqps)
        return self.saturation - decay + self.hardening * eqps, self.exponent * decay + self.hardening


def _triangle_rule() -> tuple[Array, Array]:
    """Six points (barycentric) and weights, degree 4 (Dunavant 1985)."""
    a, b = 0.445948490915965, 0.091576213509771
    points = [np.roll([1.0 - 2.0 * x, x, x], k) for x in (a, b) for k in range(3)]
    return np.array(points), np.repeat([0.223381589678011, 0.109951743655322], 3)


class Membrane:
    """A mesh of ``divisions``² quadrilaterals, each cut in two, and the fields on it."""

    def __init__(self, divisions: int, metal: Metal):
        self.metal = metal
        n = 2 * divisions + 1  # nodes a side, those in the middles of edges included
        s, t = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
        self.nodes = np.column_stack([48.0 * s.ravel(), (44.0 * s + t * (44.0 - 28.0 * s)).ravel()])
        i, j = (2 * k.ravel() for k in np.meshgrid(*2 * [np.arange(divisions)], indexing="ij"))

        def node(di: int, dj: int) -> NDArray[np.int64]:
            return (i + di) * n + j + dj

        # Corners, then the middles opposite to them.
        lower = [(0, 0), (2, 0), (2, 2), (2, 1), (1, 1), (1, 0)]
        upper = [(0, 0), (2, 2), (0, 2), (1, 2), (0, 1), (1, 1)]
        self.cells = np.vstack([np.column_stack([node(*at) for at in half]) for half in (lower, upper)])
        count = len(self.nodes)
        corners = np.unique(self.cells[:, :3])
        pressure = np.full(count, -1)
        pressure[corners] = 2 * count + np.arange(len(corners))
        self.size = 2 * count + len(corners)
        displacement = (2 * self.cells[:, :, None] + np.arange(2)).reshape(-1, 12)
        self.dofs = np.hstack([displacement, pressure[self.cells[:, :3]]])
        points, weights = _triangle_rule()
        x = self.nodes[self.cells[:, :3]]
        edge = np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1)
        (ax, ay), (bx, by) = (x[:, 1] - x[:, 0]).T, (x[:, 2] - x[:, 0]).T
        twice_area = ax * by - ay * bx
        slope = np.stack([-edge[..., 1], edge[..., 0]], axis=2) / twice_area[:, None, None]
        self.weight = 0.5 * twice_area[:, None] * weights
        self.linear = points
        l1, l2, l3 = points.T[:, :, None, None, None]
        g1, g2, g3 = (slope[:, k][None, :, None, :] for k in range(3))
        gradients = [(4 * b - 1) * g for b, g in ((l1, g1), (l2, g2), (l3, g3))]
        gradients += [4 * (l2 * g3 + l3 * g2), 4 * (l3 * g1 + l1 * g3), 4 * (l1 * g2 + l2 * g1)]
        self.gradient = np.concatenate(
            [np.broadcast_to(g, (6, len(x), 1, 2)) for g in gradients], axis=2
        ).transpose(1, 0, 2, 3)  # element, point, node, direction
        left = np.flatnonzero(self.nodes[:, 0] < 1e-9)
        self.free = np.setdiff1d(np.arange(self.size), np.concatenate([2 * left, 2 * left + 1]))
        self.right = np.flatnonzero(self.nodes[:, 0] > 48.0 - 1e-9)  # in order, upwards
        self.unknown = np.zeros(self.size)
        self.plastic = np.tile([1.0, 1.0, 1.0, 0.0], (len(x), 6, 1))  # Cp^-1: xx, yy, zz, xy
        self.eqps = np.zeros((len(x), 6))

    def edge_load(self, current: bool) -> Array:
        """Nodal share of a unit load in y, even on the initial or on the current length of the right edge."""
        at = self.nodes[self.right] + current * self.unknown[: 2 * len(self.nodes)].reshape(-1, 2)[self.right]
        share = np.zeros(len(self.right))
        for k in range(0, len(self.right) - 2, 2):
            a, m, b = at[k], at[k + 1], at[k + 2]
            for xi, weight in ((-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9)):
                shape = np.array([0.5 * xi * (xi - 1), 1 - xi**2, 0.5 * xi * (xi + 1)])
                tangent = (xi - 0.5) * a - 2 * xi * m + (xi + 0.5) * b
                share[k : k + 3] += weight * np.hypot(*tangent) * shape
        load = np.zeros(self.size)
        load[2 * self.right + 1] = share / share.sum()
        return load

    def forces(self, local: Array, plastic: Array, eqps: Array) -> tuple[Array, tuple[Array, Array]]:
        """Element residuals for element unknowns (..., 15), complex or not, and the updated history."""
        metal, g = self.metal, self.gradient
        u = local[:, :12].reshape(-1, 6, 2)
        p = local[:, None, 12:] @ self.linear.T
        p = p[:, 0]
        f = np.eye(2) + np.einsum("eai,eqaj->eqij", u, g)
        j = f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]
        c = np.empty(f.shape)
        c[..., 0, 0], c[..., 1, 1] = plastic[..., 0], plastic[..., 1]
        c[..., 0, 1] = c[..., 1, 0] = plastic[..., 3]
        scale = np.exp(-2.0 / 3.0 * np.log(j))
        b = scale[..., None, None] * (f @ c @ np.swapaxes(f, -1, -2))
        bzz = scale * plastic[..., 2]
        mean = (b[..., 0, 0] + b[..., 1, 1] + bzz) / 3.0
        sxx, syy, szz = (metal.mu * (x - mean) for x in (b[..., 0, 0], b[..., 1, 1], bzz))
        sxy = metal.mu * b[..., 0, 1]
        norm = np.sqrt(sxx**2 + syy**2 + szz**2 + 2.0 * sxy**2 + 1e-30)
        flows = (norm.real > ROOT_2_3 * metal.flow(eqps)[0]) & np.isfinite(metal.yield_stress)
        multiplier = np.zeros_like(norm)
        for _ in range(12 if flows.any() else 0):
            flow, slope = metal.flow(eqps + ROOT_2_3 * multiplier)
            excess = norm - 2.0 * metal.mu * mean * multiplier - ROOT_2_3 * flow
            change = excess / (2.0 * metal.mu * mean + 2.0 / 3.0 * slope)
            multiplier = np.where(flows, multiplier + change, 0.0)
        factor = 1.0 - 2.0 * metal.mu * mean * multiplier / norm
        xx, yy, zz, xy = (factor * s for s in (sxx, syy, szz, sxy))
        tau = np.stack([np.stack([xx + j * p, xy], -1), np.stack([xy, yy + j * p], -1)], -2)
        inverse = (
            np.stack(
                [np.stack([f[..., 1, 1], -f[..., 0, 1]], -1), np.stack([-f[..., 1, 0], f[..., 0, 0]], -1)], -2
            )
            / j[..., None, None]
        )
        nominal = tau @ np.swapaxes(inverse, -1, -2) * self.weight[..., None, None]
        force = np.einsum("eqij,eqaj->eai", nominal, g).reshape(len(local), 12)
        dilation = (
            (np.log(j) - j * p / metal.kappa) * self.weight * metal.mu
        )  # scaled to condition the matrix
        residual = np.hstack([force, dilation @ self.linear])
        if np.iscomplexobj(local):
            return residual, (plastic, eqps)
        d = np.stack([xx, yy, zz, xy], -1) / metal.mu
        half = 0.5 * (d[..., 0] ** 2 + d[..., 1] ** 2 + d[..., 2] ** 2 + 2.0 * d[..., 3] ** 2)
        det = d[..., 2] * (d[..., 0] * d[..., 1] - d[..., 3] ** 2)
        m = np.ones_like(half)
        for _ in range(20):
            m = m - (m**3 - m * half + det - 1.0) / (3.0 * m**2 - half)
        be = np.empty(f.shape)
        be[..., 0, 0], be[..., 1, 1] = d[..., 0] + m, d[..., 1] + m
        be[..., 0, 1] = be[..., 1, 0] = d[..., 3]
        back = inverse @ be @ np.swapaxes(inverse, -1, -2) / scale[..., None, None]
        history = np.stack([back[..., 0, 0], back[..., 1, 1], (d[..., 2] + m) / scale, back[..., 0, 1]], -1)
        return residual, (history, eqps + ROOT_2_3 * multiplier)

    def step(self, force: float, current: bool) -> None:
        """Equilibrium under ``force`` (N/mm) by Newton's method, then the history update."""
        load = force * self.edge_load(current)
        rows = np.repeat(self.dofs, 15, axis=1).ravel()
        columns = np.tile(self.dofs, 15).ravel()
        for _ in range(25):
            local = self.unknown[self.dofs]
            element, history = self.forces(local, self.plastic, self.eqps)
            residual = np.bincount(self.dofs.ravel(), element.ravel(), minlength=self.size) - load
            if np.linalg.norm(residual[self.free]) < 1e-8 * abs(force):
                self.plastic, self.eqps = history
                return
            tangent = np.empty((len(local), 15, 15))
            for k in range(15):
                shifted = local.astype(complex)
                shifted[:, k] += 1e-30j
                tangent[:, :, k] = self.forces(shifted, self.plastic, self.eqps)[0].imag / 1e-30
            matrix = coo_matrix((tangent.ravel(), (rows, columns)), shape=2 * (self.size,)).tocsc()
            matrix = matrix[self.free][:, self.free]
            self.unknown[self.free] -= splu(matrix).solve(residual[self.free])
        raise RuntimeError("no convergence")


def tip_displacement(
    divisions: int, force: float, steps: int, metal: Metal | None = None, current: bool = False
) -> tuple[float, float, float]:
    """Displacement (mm) of the corner (48, 60) under ``force`` (N/mm), and the largest plastic strain."""
    membrane = Membrane(divisions, metal or Metal())
    for step in range(1, steps + 1):
        membrane.step(force * step / steps, current)
    ux, uy = membrane.unknown[2 * membrane.right[-1] :][:2]
    return float(ux), float(uy), float(membrane.eqps.max())


def neo_hookean_pressure(divisions: int) -> Array:
    """Pressure (MPa) of the neo-Hookean membrane under 100 N/mm at the corners of the quadrilaterals, (s, t)."""
    rubber = Metal(240.565 / (2.0 * 1.4999), 240.565 / (3.0 * (1.0 - 2.0 * 0.4999)), np.inf)
    membrane = Membrane(divisions, rubber)
    for step in range(1, 11):
        membrane.step(10.0 * step, current=False)
    return membrane.unknown[2 * len(membrane.nodes) :].reshape(divisions + 1, divisions + 1)


def main() -> None:
    REFERENCE.mkdir(exist_ok=True)
    np.savetxt(REFERENCE / "pressure.csv", neo_hookean_pressure(40), fmt="%.5g", delimiter=",")
    with (REFERENCE / "plastic.csv").open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["force", "divisions", "steps", "load_spread_over", "ux", "uy", "largest_eqps"])
        for divisions, steps, current in (
            (4, 50, False),
            (8, 50, False),
            (16, 25, False),
            (16, 50, False),
            (16, 50, True),
            (16, 100, False),
            (32, 50, False),
        ):
            found = tip_displacement(divisions, 5000.0, steps, current=current)
            spread = "current length" if current else "initial length"
            writer.writerow([5000, divisions, steps, spread, *(f"{x:.6g}" for x in found)])
            stream.flush()
            print(divisions, steps, spread, *found, flush=True)


if __name__ == "__main__":
    main()
