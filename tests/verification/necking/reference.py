r"""Independent solution of the necking problem: bilinear F-bar quadrilaterals, from formulas alone.

Shares no code with pfemcut: structured quadrilaterals, the F-bar element of de Souza Neto, Peric, Dutko and Owen
(Int. J. Solids Structures 33, 1996), total Lagrangian gradients, element tangents by differences, Newton, no
remeshing and no nodal heat: each Gauss point is adiabatic by itself.

Constitutive model (Simo and Miehe 1992):

1. :math:`\tau = \kappa \ln J\,I - 3\alpha\kappa (1 - \ln J)/J\,\Delta\theta\,I + \mu\,\mathrm{dev}\,\bar b^e`.
2. Trial: :math:`\bar b^e = \bar f \bar b^e_n \bar f^T`; radial return to :math:`\sqrt{2/3}\,\sigma_y(\varepsilon,
   \theta_n)` with :math:`\bar\mu = \mu\,\mathrm{tr}\,\bar b^e/3`; the spherical part of :math:`\bar b^e` from
   :math:`\det \bar b^e = 1`.
3. :math:`\rho_0 c\,\Delta\theta = \chi\,\sigma_y\,\Delta\varepsilon`.

:func:`considere_force` is the exact maximum force of a long tapered strip by the one-dimensional theory.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

HALF_LENGTH, HALF_WIDTH, TAPER = 26.667, 6.413, 0.018
K, G = 164206.0, 80193.8
YIELD, SATURATION, LINEAR, EXPONENT = 450.0, 715.0, 129.24, 16.93
SOFTENING, EXPANSION, DENSITY, CAPACITY, CHI = 1e-3, 1e-5, 7.8e-9, 0.46e9, 0.9
ROOT_2_3 = np.sqrt(2.0 / 3.0)


def flow_stress(eqps, warming=0.0):
    """Voce's law with its slope (MPa)."""
    decay = (SATURATION - YIELD) * np.exp(-EXPONENT * eqps)
    soft = 1.0 - SOFTENING * warming
    return soft * (SATURATION - decay + LINEAR * eqps), soft * (EXPONENT * decay + LINEAR)


def considere_force() -> float:
    """Largest force (N/mm) of the thinnest section, rigid-plastic, in plane-strain tension without gradients.

    The true stress is 2/sqrt(3) of the flow stress and the eqps 2/sqrt(3) of the logarithmic strain e.
    """
    ratio = 2.0 / np.sqrt(3.0)
    best = minimize_scalar(
        lambda e: -ratio * flow_stress(ratio * e)[0] * np.exp(-e), bounds=(0.0, 0.5), method="bounded"
    )
    return -2.0 * HALF_WIDTH * (1.0 - TAPER) * best.fun


def read_curve(path: Path) -> dict[str, np.ndarray]:
    """The columns of a curve that ``verify.py`` stored."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    return {name: table[name] for name in table.dtype.names}


@dataclass(frozen=True)
class Points:
    """Gauss points: b (..., 4: xx, yy, zz, xy), eqps, warming and the last F-bar (..., 2, 2)."""

    b: np.ndarray
    eqps: np.ndarray
    warming: np.ndarray
    gradient: np.ndarray


def update(points: Points, gradient: np.ndarray) -> tuple[np.ndarray, Points, np.ndarray]:
    """Kirchhoff stress (..., 2, 2), new points, and flow stress times eqps increment, for F-bar ``gradient``."""
    g0 = points.gradient
    det0 = g0[..., 0, 0] * g0[..., 1, 1] - g0[..., 0, 1] * g0[..., 1, 0]
    inverse = np.stack([g0[..., 1, 1], -g0[..., 0, 1], -g0[..., 1, 0], g0[..., 0, 0]], -1).reshape(g0.shape)
    f = gradient @ (inverse / det0[..., None, None])
    j = gradient[..., 0, 0] * gradient[..., 1, 1] - gradient[..., 0, 1] * gradient[..., 1, 0]
    scale = (j / det0) ** (-2.0 / 3.0)
    xx, yy, zz, xy = np.moveaxis(points.b, -1, 0)
    a, b, c, d = f[..., 0, 0], f[..., 0, 1], f[..., 1, 0], f[..., 1, 1]
    trial = scale * np.stack(
        [
            a * a * xx + 2 * a * b * xy + b * b * yy,
            c * c * xx + 2 * c * d * xy + d * d * yy,
            zz * np.ones_like(a),
            a * c * xx + (a * d + b * c) * xy + b * d * yy,
        ]
    )
    third = trial[:3].sum(axis=0) / 3.0
    dev = G * trial
    dev[:3] -= G * third
    norm = np.sqrt((dev[:3] ** 2).sum(axis=0) + 2.0 * dev[3] ** 2)
    mu = G * third
    gamma = np.zeros_like(norm)
    plastic = norm > ROOT_2_3 * flow_stress(points.eqps, points.warming)[0]
    for _ in range(25):
        stress, slope = flow_stress(points.eqps + ROOT_2_3 * gamma, points.warming)
        residual = np.where(plastic, norm - 2.0 * mu * gamma - ROOT_2_3 * stress, 0.0)
        gamma = gamma + residual / (2.0 * mu + slope / 1.5)
        if np.abs(residual).max() < 1e-9:
            break
    dev *= 1.0 - 2.0 * mu * gamma / np.maximum(norm, 1e-30)
    # det(dev / G + t I) = 1: Newton from the trial's spherical part.
    x = dev / G
    t = third.copy()
    for _ in range(6):
        plane = (x[0] + t) * (x[1] + t) - x[3] ** 2
        value = plane * (x[2] + t) - 1.0
        t = t - value / (plane + (x[2] + t) * (x[0] + x[1] + 2.0 * t))
    new_b = x.copy()
    new_b[:3] += t
    volumetric = K * np.log(j) - 3.0 * EXPANSION * K * (1.0 - np.log(j)) / j * points.warming
    tau = np.stack([dev[0] + volumetric, dev[3], dev[3], dev[1] + volumetric], -1).reshape(gradient.shape)
    eqps = points.eqps + ROOT_2_3 * gamma
    work = flow_stress(eqps, points.warming)[0] * ROOT_2_3 * gamma
    return tau, Points(np.moveaxis(new_b, 0, -1), eqps, points.warming, gradient), work


def grid(nx: int, ny: int) -> tuple[np.ndarray, np.ndarray]:
    """Quadrilaterals, ``nx`` along (finer at the neck) and ``ny`` across."""
    s = np.linspace(0.0, 1.0, nx + 1)
    x = HALF_LENGTH * (0.45 * s + 0.55 * s**2.2)
    top = HALF_WIDTH * (1.0 - TAPER * (1.0 - x / HALF_LENGTH))
    nodes = np.stack(
        [np.broadcast_to(x[:, None], (nx + 1, ny + 1)), top[:, None] * np.linspace(0, 1, ny + 1)], -1
    )
    number = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1)
    return nodes.reshape(-1, 2), cells.reshape(-1, 4)


def _derivatives(xi: float, eta: float) -> np.ndarray:
    return 0.25 * np.array(
        [[-(1 - eta), -(1 - xi)], [1 - eta, -(1 + xi)], [1 + eta, 1 + xi], [-(1 + eta), 1 - xi]]
    )


def solve(nx: int, ny: int, elongation: float, steps: int, adiabatic: bool) -> dict[str, np.ndarray]:
    """Force (N/mm, full width), neck half-width (mm) and largest warming (K) against elongation (mm, whole strip)."""
    nodes, cells = grid(nx, ny)
    at = nodes[cells]
    q = 1.0 / np.sqrt(3.0)
    local = [_derivatives(*p) for p in ((-q, -q), (q, -q), (q, q), (-q, q), (0.0, 0.0))]
    jacobians = np.stack([np.einsum("eni,nj->eij", at, d) for d in local], 1)
    gradients = np.einsum("gnj,egji->egni", np.stack(local), np.linalg.inv(jacobians))
    volume = np.linalg.det(jacobians)[:, :4]

    def element(u: np.ndarray, points: Points) -> tuple[np.ndarray, Points, np.ndarray]:
        """Internal forces (..., e, 8) for element displacements ``u`` (..., e, 4, 2)."""
        f = np.einsum("...eni,egnj->...egij", u, gradients) + np.eye(2)
        det = f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]
        centre = det[..., 4:5]
        f, det = f[..., :4, :, :], det[..., :4]
        tau, new, work = update(points, np.sqrt(centre / det)[..., None, None] * f)
        inverse = np.stack([f[..., 1, 1], -f[..., 0, 1], -f[..., 1, 0], f[..., 0, 0]], -1).reshape(f.shape)
        # Cauchy stress tau / centre on the current volume det dV, with current gradients F^-T grad N.
        nominal = np.einsum("...ij,...kj->...ik", tau, inverse) / centre[..., None, None]
        forces = np.einsum("...egij,egnj,eg->...eni", nominal, gradients[:, :4], volume)
        return forces.reshape(*forces.shape[:-2], 8), new, work

    count = len(nodes)
    dofs = (2 * cells[:, :, None] + np.arange(2)).reshape(-1, 8)
    rows, columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, 8).ravel()
    left, right = nodes[:, 0] == 0.0, nodes[:, 0] == nodes[:, 0].max()
    fixed = np.zeros((count, 2), dtype=bool)
    fixed[left | right, 0] = True
    fixed[nodes[:, 1] == 0.0, 1] = True
    free = np.flatnonzero(~fixed.ravel())
    shape = (len(cells), 4)
    b0 = np.broadcast_to([1.0, 1.0, 1.0, 0.0], (*shape, 4))
    points = Points(b0, np.zeros(shape), np.zeros(shape), np.broadcast_to(np.eye(2), (*shape, 2, 2)))
    u, last = np.zeros((count, 2)), np.zeros((count, 2))
    h = 1e-6
    unit = h * np.eye(8).reshape(8, 1, 4, 2)
    out = []
    for step in range(1, steps + 1):
        end = 0.5 * elongation * step / steps
        u_try = u + (last if step > 1 else nodes * [end / HALF_LENGTH, -end / HALF_LENGTH])
        u_try[right, 0] = end
        forces, new, work = element(u_try[cells], points)
        for _ in range(40):
            ue = u_try[cells]
            total = np.bincount(dofs.ravel(), forces.ravel(), minlength=2 * count)
            reaction = total.reshape(-1, 2)[right, 0].sum()
            size = np.abs(total[free]).max()
            if size < 1e-7 * abs(reaction):
                break
            columns_of = (element(ue + unit, points)[0] - element(ue - unit, points)[0]) / (2.0 * h)
            blocks = np.moveaxis(columns_of, 0, -1)
            matrix = coo_matrix((blocks.ravel(), (rows, columns)), shape=(2 * count, 2 * count)).tocsc()
            change = np.zeros((count, 2))
            change.reshape(-1)[free] = splu(matrix[free][:, free]).solve(-total[free])
            for _ in range(5):
                with np.errstate(invalid="ignore"):
                    forces, new, work = element((u_try + change)[cells], points)
                norm = np.abs(np.bincount(dofs.ravel(), forces.ravel(), minlength=2 * count)[free]).max()
                if norm < size:
                    break
                change *= 0.5
            u_try = u_try + change
        else:
            raise RuntimeError(f"no convergence in step {step}")
        last, u = u_try - u, u_try
        if adiabatic:
            new = replace(new, warming=new.warming + CHI * work / (DENSITY * CAPACITY))
        points = new
        neck = nodes[ny, 1] + u[ny, 1]
        out.append((2.0 * end, 2.0 * reaction, neck, points.warming.max()))
    return dict(zip(("elongation", "force", "neck", "warming"), np.array(out).T, strict=True))
