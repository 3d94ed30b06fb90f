"""Weak form of the heat equation on the updated configuration (paper, eqs. 2 and 38; box 4, step 3).

Backward Euler with lumped capacity: the Fourier number of a cutting step is far below 1/6, where a consistent
capacity matrix oscillates.

    int  (rho_0 / J) c (theta - theta_n) / dt w  dV (at the nodes)  +  int k grad(theta) . grad(w) dV  =  sources

The lumped capacity is a diagonal that the solver adds, with the specific heat of each particle; the form is the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import ufl

from pfemcut.fem import runtime


@dataclass(frozen=True)
class HeatSymbols:
    """Element data: conductivity."""

    conductivity: ufl.Coefficient

    @staticmethod
    def on(domain: ufl.Mesh) -> HeatSymbols:
        """New symbols on the symbolic mesh ``domain``."""
        return HeatSymbols(ufl.Coefficient(ufl.FunctionSpace(domain, runtime.cell_element(1)), count=0))


def heat_forms(domain: ufl.Mesh, symbols: HeatSymbols) -> ufl.Form:
    """Matrix of conduction."""
    space = ufl.FunctionSpace(domain, runtime.nodal_element(1))
    test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
    inside = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 0})
    return symbols.conductivity * ufl.inner(ufl.grad(trial), ufl.grad(test)) * inside
