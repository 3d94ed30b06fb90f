"""The versions of dolfinx that pfemcut runs on: every call whose name or arguments changed lives here.

Written for dolfinx 0.5.2 (Debian 12). Forms are compiled once a run by dolfinx's form compiler; what it made is called
for every element of every mesh (:mod:`pfemcut.fem.element_kernels`).
"""

from __future__ import annotations

import logging
from typing import Any

import ufl
from dolfinx import jit
from mpi4py import MPI

CELL = ufl.triangle


def coordinate_domain() -> ufl.Mesh:
    """A symbolic mesh of straight triangles; forms are written on it before any real mesh exists."""
    return ufl.Mesh(ufl.VectorElement("Lagrange", CELL, 1))


def nodal_element(components: int) -> Any:
    """Linear continuous element with ``components`` values a node."""
    if components == 1:
        return ufl.FiniteElement("Lagrange", CELL, 1)
    return ufl.VectorElement("Lagrange", CELL, 1, dim=components)


def cell_element(components: int) -> Any:
    """Element-wise constant element with ``components`` values a cell."""
    if components == 1:
        return ufl.FiniteElement("DG", CELL, 0)
    return ufl.VectorElement("DG", CELL, 0, dim=components)


def _compiled(comm: MPI.Comm, what: Any) -> tuple[Any, Any]:
    """Compiled form and its module, from the cache on disk if it was compiled before."""
    # The C compiler's command lines would otherwise appear among a user's progress lines.
    disabled = logging.root.manager.disable
    logging.disable(logging.INFO)
    try:
        compiled, module, _ = jit.ffcx_jit(comm, what, form_compiler_params={"scalar_type": "double"})
    finally:
        logging.disable(disabled)
    return compiled, module


class CompiledForm:
    """A form with one integral over the cells, compiled once.

    Attributes
    ----------
    coefficients, constants
        Symbols of the form in the order in which the compiled function takes their values.
    address
        Of the compiled function.
    """

    def __init__(self, comm: MPI.Comm, form: ufl.Form):
        self._compiled, self._module = _compiled(comm, form)
        original = form.coefficients()
        count = self._compiled.num_coefficients
        self.coefficients = [original[self._compiled.original_coefficient_position[i]] for i in range(count)]
        self.constants = list(form.constants())
        cell = self._module.lib.cell
        if self._compiled.num_integrals(cell) != 1:
            raise ValueError("the form must have one integral over the cells")
        function = self._compiled.integrals(cell)[0].tabulate_tensor_float64
        self.address = int(self._module.ffi.cast("intptr_t", function))
