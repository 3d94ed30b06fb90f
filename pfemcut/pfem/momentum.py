"""Weak form of the stabilised mixed displacement-pressure momentum equation (paper, eqs. 4 and 40, Box 3).

Updated Lagrangian on the configuration x_n, plane strain, linear displacement increment u and Cauchy pressure p,
one Gauss point a triangle. With f = 1 + grad u, f_33 = 1, j = det f and J = j J_n:

    R_u = int  (j p 1 + s / J_n) : grad(v) f^-1  dV_n
    R_p = int  q [ln J / J - e (1 - ln J) / J^2 - p / kappa] j  dV_n - int alpha_s / mu_s (q - q~)(P - P~) dV_n

where e = 3 alpha (theta - theta_0), tildes are element means, and the pressure equation corrects eq. 4 of the
paper: its stabilisation has the sign of -p/kappa and no stray factor. Its modulus mu_s is element data
(:mod:`pfemcut.pfem.stabilisation`). The stabilised P is the pressure (as in the paper) where J is carried by elements,
and its increment p - p_n where J_n is recomputed from p_n: there the whole pressure would be stabilised anew in every
step, and the volume that this takes forgotten, so that pressure gradients would creep away step by step. The Kirchhoff
stress deviator is the radial return s = s_trial (1 - 2 mu_bar dl / |s_trial|) with

    dl(u) = dl_k + H (|s_trial(u)| - |s_trial|_k) + G (mu_bar(u) - mu_bar_k)

and element data dl_k, H, G: H = G = 0 is the extrapolated multiplier of IMPL-EX; the derivatives of the return
mapping at the iterate k give the fully implicit residual and its consistent tangent; those of the clamp give
the clamped extrapolation.
"""

from __future__ import annotations

from dataclasses import dataclass

import ufl

from pfemcut.fem import runtime

# Components of the element data, in the order of ``MomentumSymbols.element``.
BE_XX, BE_YY, BE_ZZ, BE_XY, VOLUME_RATIO, MULTIPLIER, BY_NORM, BY_MU_BAR, NORM_K, MU_BAR_K, SOFTENING = range(
    11
)
ELEMENT_COMPONENTS = 11
_TINY = 1e-20  # keeps the norm of a vanishing stress deviator differentiable


@dataclass(frozen=True)
class MomentumSymbols:
    """Symbols of the form: unknown (u_x, u_y, p), thermal strain e, p - P, element data, and moduli."""

    unknown: ufl.Coefficient
    thermal_strain: ufl.Coefficient
    settled_pressure: ufl.Coefficient
    element: ufl.Coefficient
    moduli: ufl.Coefficient
    stabilisation: ufl.Constant

    @staticmethod
    def on(domain: ufl.Mesh) -> MomentumSymbols:
        """New symbols on the symbolic mesh ``domain``.

        They are numbered here: ffcx 0.5 takes names from the numbers and can't compile those of two digits, which
        ufl's own count reaches when symbols are made again.
        """
        mixed, scalar, element, pair = (
            ufl.FunctionSpace(domain, kind)
            for kind in (
                runtime.nodal_element(3),
                runtime.nodal_element(1),
                runtime.cell_element(ELEMENT_COMPONENTS),
                runtime.cell_element(2),
            )
        )
        return MomentumSymbols(
            ufl.Coefficient(mixed, count=0),
            ufl.Coefficient(scalar, count=1),
            ufl.Coefficient(scalar, count=2),
            ufl.Coefficient(element, count=3),
            ufl.Coefficient(pair, count=4),
            ufl.Constant(domain, count=0),
        )


Forms = tuple[ufl.Form, ...]


def momentum_forms(domain: ufl.Mesh, symbols: MomentumSymbols) -> tuple[Forms, Forms]:
    """Residual and its exact derivative with respect to the unknown, each as parts to be added.

    A part has one quadrature rule only: ffcx 0.5 mixes up the values of a coefficient under two rules.
    """
    space = symbols.unknown.ufl_function_space()
    test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
    v, q = ufl.as_vector((test[0], test[1])), test[2]
    u, p = ufl.as_vector((symbols.unknown[0], symbols.unknown[1])), symbols.unknown[2]
    mu, kappa = symbols.moduli[0], symbols.moduli[1]
    data, e = symbols.element, symbols.thermal_strain

    f = ufl.Identity(2) + ufl.grad(u)
    j = ufl.det(f)
    volume_ratio = j * data[VOLUME_RATIO]
    s = _stress_deviator(f, j, mu, data)
    stress = j * p * ufl.Identity(2) + s / data[VOLUME_RATIO]
    log = ufl.ln(volume_ratio)
    dilation = log / volume_ratio - e * (1 - log) / volume_ratio**2

    one_point = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 1})
    exact = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 2})
    # Exact minus one-point mass is the projection onto what the element mean leaves out.
    projection = symbols.stabilisation / (mu * data[SOFTENING]) * q * (p - symbols.settled_pressure)
    balance = ufl.inner(stress, ufl.grad(v) * ufl.inv(f)) * one_point
    balance += (q * (dilation - p / kappa) * j + projection) * one_point
    residuals = (balance, -projection * exact)
    return residuals, tuple(ufl.derivative(each, symbols.unknown, trial) for each in residuals)


def _stress_deviator(
    f: ufl.core.expr.Expr, j: ufl.core.expr.Expr, mu: ufl.core.expr.Expr, data: ufl.Coefficient
) -> ufl.core.expr.Expr:
    """In-plane part of the deviatoric Kirchhoff stress after radial return (Box 3, steps 2 and 3)."""
    b_n = ufl.as_matrix(((data[BE_XX], data[BE_XY]), (data[BE_XY], data[BE_YY])))
    scale = j ** (-2.0 / 3.0)
    b = scale * f * b_n * f.T
    b_zz = scale * data[BE_ZZ]
    third = (ufl.tr(b) + b_zz) / 3
    s_trial = mu * (b - third * ufl.Identity(2))
    s_zz = mu * (b_zz - third)
    norm = ufl.sqrt(ufl.inner(s_trial, s_trial) + s_zz**2 + _TINY)
    mu_bar = mu * third
    multiplier = (
        data[MULTIPLIER] + data[BY_NORM] * (norm - data[NORM_K]) + data[BY_MU_BAR] * (mu_bar - data[MU_BAR_K])
    )
    return (1 - 2 * mu_bar * multiplier / norm) * s_trial
